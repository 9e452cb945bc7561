// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// The cubes of a mesh that fills a surface (fill_surface()), whose elements are numbered along x,
/// then y, then z.
class FilledCubes {
 public:
  explicit FilledCubes(const Mesh& mesh);

  double edge() const { return edge_; }  ///< m
  Box box_of(std::size_t e) const {
    const Hexahedron& nodes = mesh_.hexahedra[e];
    return {mesh_.points[nodes[0]], mesh_.points[nodes[7]]};
  }

  /// Calls visit(element) for those whose cubes meet a box. 0.1 us per row of cubes.
  template <class Visit>
  void for_each_in(const Box& box, Visit&& visit) const {
    const Numbers low = clamped(box.low), high = clamped(box.high);
    Numbers at = low;
    for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
      for (at[1] = low[1]; at[1] <= high[1]; ++at[1]) {
        const std::uint64_t last = key({high[0], at[1], at[2]});
        auto found = std::lower_bound(keys_.begin(), keys_.end(), key({low[0], at[1], at[2]}));
        for (; found != keys_.end() && *found <= last; ++found)
          visit(static_cast<Index>(found - keys_.begin()));
      }
  }

 private:
  using Numbers = std::array<std::uint64_t, 3>;

  Numbers number_of(const Vec3& low_corner) const;
  /// The cube around a place, or the nearest one.
  Numbers clamped(const Vec3& place) const;
  static std::uint64_t key(const Numbers& n) { return n[0] | n[1] << 21 | n[2] << 42; }

  const Mesh& mesh_;
  double edge_ = 0;
  Box around_ = no_box;  ///< of the low corners
  std::vector<std::uint64_t> keys_;
};

}  // namespace suture
