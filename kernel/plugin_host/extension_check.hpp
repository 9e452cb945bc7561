// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/plugin_host/table_copy.hpp"

namespace suture {

/// Everything that is wrong with the extensions of the functors in tables that have no
/// table_problems(): sizes, functions that are NULL, fields. This calls the plugin's code and
/// throws PluginError if a call fails.
std::vector<std::string> extension_problems(const suture_plugin& plugin,
                                            const TableSizes& least = {});

}  // namespace suture
