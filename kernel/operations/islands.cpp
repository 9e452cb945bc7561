// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/islands.hpp"

namespace suture {
namespace {

bool is_inside(const Selection::InBox& box, const double* p) {
  for (std::size_t c = 0; c < 3; ++c)
    if (p[c] < box.min[c] || p[c] > box.max[c]) return false;
  return true;
}

/// By island: whether one of its vertices is inside.
std::vector<char> islands_inside(const CellComplex& complex, const Islands& islands,
                                 const Selection::InBox& box, const double* rows,
                                 std::size_t stride) {
  std::vector<char> inside(islands.count());
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e) || inside[islands.of(e)]) continue;
    for (const Index v : complex.vertices_of(e))
      if (is_inside(box, rows + stride * v)) inside[islands.of(e)] = 1;
  }
  return inside;
}

}  // namespace

std::vector<Index> elements_of_islands(const CellComplex& complex, const Islands& islands,
                                       const double* rows, const RemoveIslands& which,
                                       std::size_t stride) {
  std::vector<char> inside;
  if (which.outside) inside = islands_inside(complex, islands, *which.outside, rows, stride);
  std::vector<Index> elements;
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Index island = islands.of(e);
    if (islands.size(island) < which.below || (which.outside && !inside[island]))
      elements.push_back(e);
  }
  return elements;
}

}  // namespace suture
