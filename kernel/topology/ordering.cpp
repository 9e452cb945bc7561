// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/ordering.hpp"

#include <algorithm>
#include <limits>

#include "kernel/base/box.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/base/saturate.hpp"

namespace suture {
namespace {

/// Spreads the low 16 bits of x to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFu;
  x = (x | x << 16) & 0x001F0000FF0000FFu;
  x = (x | x << 8) & 0x100F00F00F00F00Fu;
  x = (x | x << 4) & 0x10C30C30C30C30C3u;
  x = (x | x << 2) & 0x1249249249249249u;
  return x;
}

Box bounds(std::span<const Vec3> points, const std::vector<bool>& used) {
  Box box = no_box;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (used[p]) include(box, points[p]);
  return box;
}

}  // namespace

bool is_local(std::span<const Hexahedron> hexahedra, Index point_count) {
  constexpr Index first_level = 512, second_level = 16384;
  std::vector<Index> last(point_count, none);
  std::size_t late = 0, very_late = 0;
  for (Index e = 0; e < hexahedra.size(); ++e) {
    for (const Index v : hexahedra[e]) {
      const Index before = last[v];
      last[v] = e;
      if (before == none) continue;
      late += e - before > first_level;
      very_late += e - before > second_level;
    }
    if (late > 2 * std::size_t{point_count} || 3 * very_late > point_count) return false;
  }
  return true;
}

std::vector<Index> curve_order(std::span<const Hexahedron> hexahedra, std::span<const Vec3> points,
                               const std::vector<bool>& used) {
  struct Keyed {
    std::uint64_t key;
    Index element;
  };
  const Box box = bounds(points, used);
  double extent = std::numeric_limits<double>::min();
  for (std::size_t c = 0; c < 3; ++c) extent = std::max(extent, box.length(c));
  const double scale = 262143.0 / extent;  // cubic cells: the curve is local along all axes

  // Three coordinates of 18 bits in one word, 21 bits apart: the sum over an element's
  // corners, its centroid, is then seven additions, and eight random reads of 8 bytes.
  std::vector<std::uint64_t> packed(points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
    for (int c = 0; c < 3 && used[p]; ++c)
      packed[p] |= std::uint64_t{saturate<std::uint32_t>((points[p][c] - box.low[c]) * scale)}
                   << 21 * c;
  std::vector<Keyed> places(hexahedra.size()), spare;
  for (Index e = 0; e < hexahedra.size(); ++e) {
    std::uint64_t sum = 0, key = 0;
    for (const Index v : hexahedra[e]) sum += packed[v];
    for (int c = 0; c < 3; ++c) key |= spread(sum >> (21 * c + 5) & 0xFFFF) << c;
    places[e] = {key, e};
  }
  packed = std::vector<std::uint64_t>();
  radix_sort(places, spare, [](const Keyed& p) { return p.key; });
  std::vector<Index> order(places.size());
  std::ranges::transform(places, order.begin(), &Keyed::element);
  return order;
}

std::vector<Index> local_order(std::span<const Hexahedron> hexahedra, std::span<const Vec3> points,
                               const std::vector<bool>& used) {
  if (is_local(hexahedra, static_cast<Index>(points.size()))) return {};
  return curve_order(hexahedra, points, used);
}

}  // namespace suture
