// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "kernel/plugin_host/note_reader.hpp"
#include "suture/plugin.h"

namespace suture {

/// Loads a plugin whose note was accepted and returns its checked tables.
/// The library stays loaded until the program ends (NODELETE): thread pools,
/// exceptions and static data of a plugin can crash when it is unloaded. Throws
/// PluginError with the file, the loader's own text and a hint, or with every
/// problem of the tables. Loading the same file again returns the same tables.
const suture_plugin& load_plugin(const std::filesystem::path& file, const PluginNote& note);

}  // namespace suture
