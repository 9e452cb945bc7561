// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/library_loading.hpp"

#include <dlfcn.h>

namespace suture {

/// Boost's enumeration has no NODELETE; its value goes through to dlopen unchanged. Boost's own
/// message would be a misleading "Bad file descriptor".
std::string load_for_good(boost::dll::shared_library& library, const std::filesystem::path& file,
                          const PluginCall& call) {
  const auto mode = static_cast<boost::dll::load_mode::type>(RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  std::error_code code;
  call_plugin(call, [&] { library.load(std::filesystem::absolute(file), mode, code); });
  if (!code && library.is_loaded()) return "";
  const char* text = dlerror();
  return text != nullptr ? text : code.message();
}

}  // namespace suture
