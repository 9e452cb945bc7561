// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "kernel/geometry/surface.hpp"

namespace suture {

/// One bit per cube of a lattice around some triangles: whether one of them may intersect it. At
/// most 256 cubes along an axis (2 MB). Rules out most links of a mesh in 10 ns each.
class NearGrid {
 public:
  NearGrid() = default;
  /// Marks cubes by bisecting boxes that intersect a triangle's bounding box and plane: about 0.1
  /// us per marked cube.
  NearGrid(const TriangleSurface& surface, const Box& box);

  /// False only if no triangle meets the bounding box of the segment.
  bool may_meet(const Vec3& a, const Vec3& b) const;
  std::size_t marked() const;

 private:
  struct Cubes;
  void mark(const Cubes& cubes, const std::array<Vec3, 3>& corners, const Vec3& normal,
            const Box& box);

  Vec3 low_{};
  double edge_ = 1;
  std::array<int, 3> count_{};
  std::vector<std::uint64_t> bits_;
};

}  // namespace suture
