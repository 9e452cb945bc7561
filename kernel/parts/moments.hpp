// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "kernel/mesh/parts.hpp"

namespace suture {

/// Sums the moments of tetrahedra in the reference cube [-1, 1]^3, exactly. Those that are oriented
/// negatively are taken away.
class MomentSum {
 public:
  static MomentSum of_whole_cube() {
    MomentSum sum;
    sum.volume_ = 8;
    return sum;
  }
  void add(const std::array<Vec3, 4>& corners);
  PartMoments moments() const;

 private:
  double volume_ = 0;
  Vec3 first_{}, second_{};  ///< integrals of x, y, z and of y z, x z, x y
};

/// Six times the volume, positive if oriented positively.
double six_volumes(const std::array<Vec3, 4>& corners);

}  // namespace suture
