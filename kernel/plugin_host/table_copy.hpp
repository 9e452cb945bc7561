// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "suture/plugin.h"

namespace suture {

/// Sizes of the structs as published in ABI 1.0, bytes; those of a plugin are never smaller.
struct TableSizes {
  std::uint32_t plugin = 80, model = 104, functor = 104, parameter = 72, attribute = 64,
                contribution = 16, extension = 16, output = 24, field = 32;
};

/// A plugin's tables in this host's own structs. Members that do not exist in the plugin's
/// ABI minor version are 0, which by the rules of plugin.h has no effect. Texts, functions
/// and lists of numbers remain those of the plugin.
struct PluginTables {
  suture_plugin plugin{};
  std::vector<suture_model> models;
  // Lists of each model, and of each attribute.
  std::deque<std::vector<suture_parameter>> parameters;
  std::deque<std::vector<suture_attribute>> attributes;
  std::deque<std::vector<suture_functor>> functors;
  std::deque<std::vector<suture_contribution>> contributions;
};

/// Copies the tables. What makes them unreadable is added to `problems`, in one sentence each that
/// names the entry; the copy then holds what could be read and must not be used. Arrays must be
/// readable: invalid pointers cannot be detected.
std::unique_ptr<PluginTables> copy_tables(const suture_plugin& plugin,
                                          std::vector<std::string>& problems,
                                          const TableSizes& least = {});

}  // namespace suture
