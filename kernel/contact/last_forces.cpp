// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/last_forces.hpp"

#include <algorithm>

namespace suture {

const Vec3& LastForces::of_pair(Index point, Index triangle) const {
  static constexpr Vec3 nothing{};
  const Key key{point, triangle};
  const auto found = std::ranges::lower_bound(pairs_, key, {}, &OfPair::key);
  return found != pairs_.end() && found->key == key ? found->force : nothing;
}

void LastForces::clear() {
  for (const Index point : pushed_) of_points_[point] = {};
  pushed_.clear();
  pairs_.clear();
}

void LastForces::add_point(Index point, const Vec3& force) {
  if (point >= of_points_.size()) of_points_.resize(std::size_t{point} + 1);
  of_points_[point] = force;
  pushed_.push_back(point);
}

void LastForces::sort_pairs() {
  if (!std::ranges::is_sorted(pairs_, {}, &OfPair::key))
    std::ranges::sort(pairs_, {}, &OfPair::key);
}

void LastForces::state(Archive& archive) {
  std::vector<Index> points = pushed_;
  std::vector<Vec3> forces;
  for (const Index point : points) forces.push_back(of_points_[point]);
  archive.rows<Index>("points", points);
  archive.rows<double>("forces on points", forces);
  archive.member("pairs", pairs_, &OfPair::key);
  archive.member("forces of pairs", pairs_, &OfPair::force);
  if (!archive.loads()) return;
  for (const Index point : pushed_) of_points_[point] = {};
  pushed_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) add_point(points[i], forces[i]);
}

}  // namespace suture
