// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"

/// Parts of messages about a mesh.
namespace suture::mesh_texts {

inline std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// "3, 7, 12 and 40 more": all of them up to 20.
template <class Items, class Name>
std::string listed(const Items& items, Name name, std::size_t at_most = 20) {
  std::string text;
  std::size_t shown = 0;
  for (const auto& item : items) {
    if (shown == at_most) break;
    text += (shown++ ? ", " : "") + name(item);
  }
  if (items.size() > shown) text += " and " + std::to_string(items.size() - shown) + " more";
  return text;
}

/// The user's numbers for positions in a Mesh.
struct UserNames {
  std::vector<std::uint64_t> points, elements;
  std::string point(Index i) const { return std::to_string(points.empty() ? i : points[i]); }
  std::string element(Index i) const { return std::to_string(elements.empty() ? i : elements[i]); }
};

inline std::string prefix(const std::string& source) {
  return "mesh " + (source.empty() ? std::string() : "'" + source + "' ");
}

}  // namespace suture::mesh_texts
