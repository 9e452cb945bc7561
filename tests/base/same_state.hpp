// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"

/// Whether two objects hold the same state, byte by byte.
namespace suture {

template <class Holder>
StateTree state_of(Holder& holder) {
  StateTree tree;
  save_state(tree, holder);
  return tree;
}

/// The path of the first array that differs and how, or "".
inline std::string difference(const StateTree& a, const StateTree& b,
                              const std::string& path = "") {
  for (const auto& [name, array] : a.arrays) {
    const std::string here = path + '/' + name;
    const auto found = b.arrays.find(name);
    if (found == b.arrays.end()) return here + " is missing";
    const StateTree::Array& other = found->second;
    if (array.type != other.type || array.columns != other.columns || array.rows != other.rows)
      return here + " has " + std::to_string(array.rows) + " and " + std::to_string(other.rows) +
             " rows, or other numbers";
    for (std::size_t i = 0; i < array.size(); ++i)
      if (array.bytes[i] != other.bytes[i]) return here + " differs at byte " + std::to_string(i);
  }
  for (const auto& [name, group] : a.groups) {
    const auto found = b.groups.find(name);
    if (found == b.groups.end()) return path + '/' + name + " is missing";
    if (std::string inside = difference(group, found->second, path + '/' + name); !inside.empty())
      return inside;
  }
  if (a.arrays.size() != b.arrays.size() || a.groups.size() != b.groups.size())
    return path + " has more in one of them";
  return {};
}

template <class Holder>
std::string difference_of_states(Holder& a, Holder& b) {
  return difference(state_of(a), state_of(b));
}

/// Damages number `i` of an array.
template <class Number>
void overwrite(StateTree& tree, const std::string& name, std::size_t i, Number value) {
  std::memcpy(tree.arrays.at(name).bytes.get() + i * sizeof value, &value, sizeof value);
}

/// What loading says that it refuses, or "".
template <class Holder>
std::string refusal_of(const StateTree& tree, Holder& holder) {
  try {
    load_state(tree, holder);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace suture
