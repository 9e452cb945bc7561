// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/plugin_host/table_copy.hpp"

namespace suture {

/// Everything wrong with the extensions that functors offer, in tables without table_problems():
/// sizes, functions that are NULL, fields. Asks the functors, so code of the plugin runs; throws
/// PluginError if that fails.
std::vector<std::string> extension_problems(const suture_plugin& plugin,
                                            const TableSizes& least = {});

}  // namespace suture
