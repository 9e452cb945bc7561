// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/element_colours.hpp"

#include <algorithm>

namespace suture {

std::vector<std::vector<Index>> colour_elements(const CellComplex& complex,
                                                const CellSet& elements) {
  std::vector<std::vector<Index>> groups;
  std::vector<std::vector<bool>> taken;  // by group and vertex
  for (Index row = 0; row < elements.size(); ++row) {
    if (!elements.is_live(row)) continue;
    const auto& vertices = complex.vertices_of(elements.cell(row));
    const auto is_free = [&](const std::vector<bool>& used) {
      return std::ranges::none_of(vertices, [&](Index v) { return used[v]; });
    };
    const auto group =
        static_cast<std::size_t>(std::ranges::find_if(taken, is_free) - taken.begin());
    if (group == taken.size()) {
      taken.emplace_back(complex.count(0));
      groups.emplace_back();
    }
    groups[group].push_back(row);
    for (const Index v : vertices) taken[group][v] = true;
  }
  return groups;
}

}  // namespace suture
