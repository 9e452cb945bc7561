// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/live/device.hpp"
#include "kernel/plugin_host/library_loading.hpp"
#include "kernel/plugin_host/plugin_search.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw PluginError("device " + file.string() + ": " + why);
}

/// Why a table cannot be used; "" if it can.
std::string table_problem(const suture_device* device) {
  if (device == nullptr) return SUTURE_DEVICE_SYMBOL " returned NULL";
  if (device->version != SUTURE_DEVICE_VERSION)
    return "it was built for version " + std::to_string(device->version) +
           " of suture/device.h, and this program needs version " +
           std::to_string(SUTURE_DEVICE_VERSION) + "; rebuild it";
  if (device->size < sizeof(suture_device))
    return "its table has " + std::to_string(device->size) + " bytes, not " +
           std::to_string(sizeof(suture_device)) + "; set its size to sizeof(suture_device)";
  const bool is_complete =
      device->name && *device->name && device->open && device->read && device->close;
  return is_complete ? "" : "its table lacks a name, or one of open, read and close";
}

}  // namespace

fs::path device_file(const std::string& name) {
  if (name.ends_with(".so")) return name;
  std::string tried;
  std::vector<std::string> names;
  for (const PluginFolder& folder : plugin_folders()) {
    const fs::path devices = folder.path / "devices";
    std::error_code failed;
    if (fs::path file = devices / (name + ".so"); fs::exists(file, failed)) return file;
    tried += "\n  " + devices.string();
    for (fs::directory_iterator at(devices, failed), end; !failed && at != end;
         at.increment(failed))
      if (at->path().extension() == ".so") names.push_back(at->path().stem().string());
  }
  std::ranges::sort(names);
  throw PluginError("there is no device '" + name + "'" + did_you_mean(name, names) +
                    "; searched for " + name + ".so in:" + tried);
}

const suture_device& load_device(const fs::path& file) {
  std::error_code code;
  if (!fs::exists(file, code)) refuse(file, "no such file");
  boost::dll::shared_library library;
  PluginCall call{.function = "loading", .file = file.c_str()};
  if (const std::string why = load_for_good(library, file, call); !why.empty())
    refuse(file, "it cannot be loaded: " + why);
  if (!library.has(SUTURE_DEVICE_SYMBOL))
    refuse(file,
           "it is not a device: it exports no function " SUTURE_DEVICE_SYMBOL " (suture/device.h)");
  call.function = SUTURE_DEVICE_SYMBOL;
  const suture_device* device =
      call_plugin(call, library.get<const suture_device*()>(SUTURE_DEVICE_SYMBOL));
  if (const std::string problem = table_problem(device); !problem.empty()) refuse(file, problem);
  return *device;
}

}  // namespace suture
