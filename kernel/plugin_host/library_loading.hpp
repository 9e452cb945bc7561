// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#define BOOST_DLL_USE_STD_FS
#include <boost/dll/shared_library.hpp>
#include <filesystem>
#include <string>

#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {

/// Loads a library that a user has written: all symbols are found now, none is visible to other
/// libraries, and it is never unloaded. Constructors of its static data run within `call`. Returns
/// the message of the loader, or "" if it is loaded.
std::string load_for_good(boost::dll::shared_library& library, const std::filesystem::path& file,
                          const PluginCall& call);

}  // namespace suture
