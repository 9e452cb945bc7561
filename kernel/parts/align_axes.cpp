// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/align_axes.hpp"

#include <algorithm>
#include <vector>

#include "kernel/parts/cube_sides.hpp"

namespace suture {
namespace {

struct Side {
  std::array<Index, 4> points;  ///< ascending
  Index element;
  auto operator<=>(const Side&) const = default;
};

std::array<Index, 4> points_of(const Hexahedron& element, CubeSide side) {
  std::array<Index, 4> points;
  std::ranges::transform(corners_of(side), points.begin(),
                         [&](unsigned corner) { return element[corner]; });
  std::ranges::sort(points);
  return points;
}

/// Two entries with the same points for each face between two elements.
std::vector<Side> sides_of(std::span<const Hexahedron> elements) {
  std::vector<Side> sides;
  sides.reserve(6 * elements.size());
  for (Index e = 0; e < elements.size(); ++e)
    for (const CubeSide side : cube_sides) sides.push_back({points_of(elements[e], side), e});
  std::ranges::sort(sides);
  return sides;
}

/// The corners of `other` in the order that continues the axes of `element` behind its side.
Hexahedron continued(const Hexahedron& element, CubeSide side, const Hexahedron& other) {
  const unsigned across = 1u << side.axis;
  unsigned on_side = 0;  // corners of the other element, a bit each
  std::array<unsigned, 8> from{};
  for (const unsigned i : corners_of(side)) {
    const auto at = std::ranges::find(other, element[i]) - other.begin();
    from[i ^ across] = static_cast<unsigned>(at);
    on_side |= 1u << at;
  }
  Hexahedron result = other;
  for (const unsigned i : corners_of(side)) {
    const unsigned near = from[i ^ across];
    result[i ^ across] = other[near];
    for (const unsigned step : {1u, 2u, 4u})
      if ((on_side >> (near ^ step) & 1) == 0) result[i] = other[near ^ step];
  }
  return result;
}

}  // namespace

void align_axes(std::span<Hexahedron> elements) {
  const std::vector<Side> sides = sides_of(elements);
  std::vector<std::uint8_t> is_reached(elements.size());
  std::vector<Index> reached;
  for (Index first = 0; first < elements.size(); ++first) {
    if (is_reached[first] != 0) continue;
    is_reached[first] = 1;
    reached.assign(1, first);
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const Hexahedron element = elements[reached[next]];
      for (const CubeSide side : cube_sides) {
        const std::array<Index, 4> points = points_of(element, side);
        for (auto at = std::ranges::lower_bound(sides, points, {}, &Side::points);
             at != sides.end() && at->points == points; ++at) {
          if (is_reached[at->element] != 0) continue;
          is_reached[at->element] = 1;
          elements[at->element] = continued(element, side, elements[at->element]);
          reached.push_back(at->element);
        }
      }
    }
  }
}

}  // namespace suture
