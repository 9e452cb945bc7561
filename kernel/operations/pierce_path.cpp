// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/pierce_path.hpp"

#include <algorithm>

#include "kernel/geometry/centroid.hpp"

namespace suture {
namespace {

/// Square of the distance from p to the segment a b.
double distance2(const Vec3& p, const Vec3& a, const Vec3& b) {
  double along = 0, length2 = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    along += (p[c] - a[c]) * (b[c] - a[c]);
    length2 += (b[c] - a[c]) * (b[c] - a[c]);
  }
  const double t = length2 > 0 ? std::clamp(along / length2, 0.0, 1.0) : 0;
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double d = p[c] - a[c] - t * (b[c] - a[c]);
    sum += d * d;
  }
  return sum;
}

}  // namespace

std::vector<Index> elements_along_path(const CellComplex& complex, const double* rows,
                                       std::span<const Vec3> path, double radius,
                                       std::size_t stride, const ElementBlocks* blocks) {
  Box box = no_box;
  for (const Vec3& p : path) include(box, p);
  for (std::size_t c = 0; c < 3; ++c) {
    box.low[c] -= radius;
    box.high[c] += radius;
  }
  const auto is_near = [&](const Vec3& p) {
    if (!contains(box, p)) return false;
    if (path.size() == 1) return distance2(p, path[0], path[0]) <= radius * radius;
    for (std::size_t i = 1; i < path.size(); ++i)
      if (distance2(p, path[i - 1], path[i]) <= radius * radius) return true;
    return false;
  };
  std::vector<Index> elements;
  SearchedElements(blocks, complex.element_count(), [&](const Box& block) {
    return overlap(block, box);
  }).for_each([&](Index e) {
    if (complex.exists(3, e) && is_near(centroid(complex.vertices_of(e), rows, stride)))
      elements.push_back(e);
  });
  return elements;
}

}  // namespace suture
