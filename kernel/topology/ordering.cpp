// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/ordering.hpp"

#include <algorithm>
#include <limits>

#include "kernel/base/radix_sort.hpp"

namespace suture {
namespace {

/// Eight times the centroid.
Vec3 corner_sum(const Hexahedron& h, std::span<const Vec3> points) {
  Vec3 sum{};
  for (const Index v : h)
    for (int c = 0; c < 3; ++c) sum[c] += points[v][c];
  return sum;
}

/// Spreads the low 16 bits of x to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFu;
  x = (x | x << 16) & 0x001F0000FF0000FFu;
  x = (x | x << 8) & 0x100F00F00F00F00Fu;
  x = (x | x << 4) & 0x10C30C30C30C30C3u;
  x = (x | x << 2) & 0x1249249249249249u;
  return x;
}

}  // namespace

bool is_local(std::span<const Hexahedron> hexahedra, Index point_count) {
  constexpr Index reach = 16384;
  std::vector<Index> last(point_count, none);
  std::size_t vertices = 0, far = 0;
  for (Index e = 0; e < hexahedra.size(); ++e)
    for (const Index v : hexahedra[e]) {
      const Index before = last[v];
      last[v] = e;
      if (before == none)
        ++vertices;
      else if (e - before > reach)
        ++far;
    }
  return 3 * far <= vertices;
}

std::vector<Index> curve_order(std::span<const Hexahedron> hexahedra,
                               std::span<const Vec3> points) {
  struct Place {
    std::uint64_t key;
    Index element;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  std::vector<Vec3> sums(hexahedra.size());
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    sums[e] = corner_sum(hexahedra[e], points);
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], sums[e][c]);
      high[c] = std::max(high[c], sums[e][c]);
    }
  }
  double extent = std::numeric_limits<double>::min();
  for (int c = 0; c < 3; ++c) extent = std::max(extent, high[c] - low[c]);
  const double scale = 65535.0 / extent;  // cubic cells, so that the curve is local in all axes
  std::vector<Place> places(hexahedra.size()), spare;
  for (Index e = 0; e < hexahedra.size(); ++e) {
    std::uint64_t key = 0;
    for (int c = 0; c < 3; ++c)
      key |= spread(static_cast<std::uint64_t>((sums[e][c] - low[c]) * scale)) << c;
    places[e] = {key, e};
  }
  sums = {};
  radix_sort(places, spare, [](const Place& p) { return p.key; });
  std::vector<Index> order(places.size());
  std::ranges::transform(places, order.begin(), &Place::element);
  return order;
}

}  // namespace suture
