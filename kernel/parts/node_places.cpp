// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/node_places.hpp"

#include "kernel/parts/cube_sides.hpp"

namespace suture {

NodePlaces node_places(const Parts& parts, const CellComplex& complex) {
  NodePlaces places;
  places.is_inside.assign(complex.count(0), 0);
  std::size_t next = 0;
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (next < parts.elements.size() && parts.elements[next] == e)
      ++next;
    else if (complex.exists(3, e))
      for (const Index v : complex.vertices_of(e)) places.is_inside[v] = 1;
  }
  const auto node = [&](const EmbeddedPoint& point, unsigned corner) {
    return complex.vertices_of(point.element)[corner];
  };
  for (const EmbeddedPoint& point : parts.points)
    if (const EdgeEnds ends(point.at); ends.is_corner() && complex.exists(3, point.element))
      places.is_inside[node(point, ends.low)] = 1;
  for (const EmbeddedPoint& point : parts.points) {
    const EdgeEnds ends(point.at);
    if (ends.is_corner() || !complex.exists(3, point.element)) continue;
    for (const unsigned end : {ends.low, ends.high})
      if (const Index v = node(point, end); places.is_inside[v] == 0)
        places.crossings.push_back({v, point});
  }
  return places;
}

}  // namespace suture
