// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/contact/contact_in_progress.hpp"
#include "kernel/contact/point_pairs.hpp"
#include "kernel/contact/surface_points.hpp"

namespace suture {

/// Pushes the points of an embedded surface out of obstacles and each other. Points share vertices:
/// they are pushed one after the other, in sweeps, until none moves.
class PointPushes {
 public:
  /// `edge`: the shortest of the elements, m; `mean_edge`: a typical one. All outlive this.
  PointPushes(Attributes& attributes, ContactInProgress& step, double edge, double mean_edge)
      : attributes_(attributes), step_(step), edge_(edge), mean_edge_(mean_edge) {}
  void touch(PointPairs& pairs) { pairs_ = &pairs; }

  void clear();
  /// Call before it is added to those pushed.
  void add(const ContactPoint& point);
  /// Adds the pairs of points and triangles, after the points near obstacles.
  void find_pairs();
  void push(double dt);

  /// By place in pushed.
  const PointMass& mass(std::size_t i) const { return masses_[i]; }
  /// The place in pushed of pair i, and what friction has changed in its velocity, m/s.
  std::size_t place_of_pair(std::size_t i) const { return first_pair_ + i; }
  std::span<const Vec3> friction_of_pairs() const { return pair_tangential_; }

 private:
  /// A place in pushed, and the first place in near of what shares vertices with it.
  struct Grouped {
    std::size_t group, place;
  };
  void group_points();
  void push_group(std::span<const Grouped> group, double dt);
  void sweep_group(std::span<const Grouped> group, bool has_pairs, double dt);
  std::array<double, 2> sweep_points(std::span<const Grouped> group, double dt);
  Vec3 push_point(std::size_t i, double dt);
  void change_point(std::size_t i, const Vec3& by, double dt);
  double way_of_point(std::size_t i) const;
  std::span<const Index> near_of_point(std::size_t i) const {
    return std::span(near_of_points_).subspan(first_near_[i], first_near_[i + 1] - first_near_[i]);
  }
  Vec3 change_of(std::size_t i, const Vec3& end, const Vec3& velocity, double dt);

  Attributes& attributes_;
  ContactInProgress& step_;
  double edge_, mean_edge_;
  PointPairs* pairs_ = nullptr;
  std::size_t first_pair_ = 0;                ///< in pushed: pairs follow what obstacles may push
  std::vector<Vec3> pair_tangential_;         ///< of the changes of pairs, m/s
  std::vector<PointMass> masses_;             ///< of pushed, as those below
  std::vector<Index> near_of_points_;         ///< places in near of the vertices of each
  std::vector<std::size_t> first_near_;       ///< of each, in these, and their number
  std::vector<Vec3> directions_, residuals_;  ///< of the changes, m/s
  std::vector<double> seen_;      ///< what the ways of its vertices were when it was pushed, m
  std::vector<Grouped> grouped_;  ///< all of them
  std::vector<double> ways_;      ///< by place in near: how far pushes have taken a vertex, m
};

}  // namespace suture
