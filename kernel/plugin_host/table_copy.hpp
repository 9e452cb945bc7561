// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "suture/plugin.h"

namespace suture {

/// Sizes of the structs as ABI 1.0 published them, bytes: a plugin has none smaller.
struct TableSizes {
  std::uint32_t plugin = 80, model = 104, functor = 104, parameter = 72, attribute = 64,
                contribution = 16, extension = 16, output = 24, field = 32;
};

/// A plugin's tables in this host's own structs. Members that the plugin's ABI minor does
/// not have are 0, which by the rules of plugin.h means what the plugin means. Texts,
/// functions and lists of numbers are the plugin's.
struct PluginTables {
  suture_plugin plugin{};
  std::vector<suture_model> models;
  // Of each model, and of each attribute.
  std::deque<std::vector<suture_parameter>> parameters;
  std::deque<std::vector<suture_attribute>> attributes;
  std::deque<std::vector<suture_functor>> functors;
  std::deque<std::vector<suture_contribution>> contributions;
};

/// Copies them. What makes them unreadable is added to `problems`, one sentence each, naming the
/// entry; the copy then holds what could be read and is not to be used. Arrays must be readable:
/// garbage pointers cannot be told apart.
std::unique_ptr<PluginTables> copy_tables(const suture_plugin& plugin,
                                          std::vector<std::string>& problems,
                                          const TableSizes& least = {});

}  // namespace suture
