// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/base/types.hpp"

namespace suture {

/// The forces on the points of an embedded surface in the last step, N, with which the sweeps of
/// the next one begin: by obstacles, by point, and of pairs, by point and triangle.
class LastForces {
 public:
  /// 0 if there was none.
  const Vec3& on_point(Index point) const {
    static constexpr Vec3 nothing{};
    return point < of_points_.size() ? of_points_[point] : nothing;
  }
  const Vec3& of_pair(Index point, Index triangle) const;

  /// Forgets all; then those of the step are added, in any order.
  void clear();
  void add_point(Index point, const Vec3& force);
  void add_pair(Index point, Index triangle, const Vec3& force) {
    pairs_.push_back({{point, triangle}, force});
  }
  /// Call after the last one has been added.
  void sort_pairs();

  void state(Archive& archive);

 private:
  using Key = std::array<Index, 2>;
  struct OfPair {
    Key key;
    Vec3 force;
  };

  std::vector<Vec3> of_points_;  ///< by point
  std::vector<Index> pushed_;    ///< where it is not 0
  std::vector<OfPair> pairs_;    ///< ascending
};

}  // namespace suture
