// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/commands.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture {

int models(const ModelsCommand&, Console& console) {
  const PluginHost host(&console.diagnostics());
  const auto files = host.list();
  for (const PluginHost::Listing& file : files) {
    std::string ids;
    for (const std::string& id : file.models) ids += (ids.empty() ? "" : ", ") + id;
    console.print((ids.empty() ? "(none)" : ids) + "  [" + (file.isa.empty() ? "?" : file.isa) +
                  "]  " + file.file.string());
    if (!file.problem.empty()) console.print("    not used: " + file.problem);
  }
  if (files.empty()) {
    console.print("no plugins found; add their folders to SUTURE_PLUGIN_PATH");
  }
  return 0;
}

}  // namespace suture
