// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/attributes/live_mask.hpp"
#include "kernel/contact/placed_obstacle.hpp"

namespace suture {

/// A push by less is rounding, and no reason for another sweep; in elements.
inline constexpr double least_push = 1e-9;
/// How far a point is pushed out of an obstacle in a step if it began inside;
/// in elements.
inline constexpr double max_push = 0.01;

/// What is known of contact in the step in progress, and of no other: what the step may push, and
/// what obstacles have done to it.
struct ContactInProgress {
  // These three are no aggregates: g++ 12 would clear each by `rep stos`, which takes longer than
  // all else in add_near.
  /// A vertex that the step may push: near an obstacle, or where pieces touch.
  struct Near {
    Near(Index of, const Vec3& end, const Vec3& velocity)
        : vertex(of), free_end(end), free_velocity(velocity) {}
    Index vertex;
    Vec3 free_end, free_velocity;  ///< after the step without contact
    bool is_booked = false;
    Vec3 mean{};  ///< of the velocities before and after the step, if booked, m/s
  };
  /// What obstacles have changed in the velocity of a vertex or point, and what it was then, m/s.
  struct Pushed {
    Pushed(Index of, std::size_t first_push) : vertex(of), first(first_push) {}
    Index vertex;
    std::size_t first, count = 0;  ///< in pushes, of the obstacles near it
    Vec3 change{}, settled{};
  };
  /// An obstacle that may push a vertex or point, and what it did, if it did.
  struct PushBy {
    PushBy(Index of, Index by) : vertex(of), obstacle(by) {}
    Index vertex, obstacle;
    Push push{};
  };

  void clear() {
    near.clear();
    pushed.clear();
    pushes.clear();
  }
  void add_near(Attributes& attributes, Index vertex) {
    near.emplace_back(vertex, row(attributes.position().rows(), vertex),
                      row(attributes.velocity().rows(), vertex));
  }
  /// By place in near or pushed: none of vertices that only other pieces push.
  std::span<PushBy> pushes_on(std::size_t i) {
    if (i >= pushed.size()) return {};
    return std::span(pushes).subspan(pushed[i].first, pushed[i].count);
  }
  /// Out of one obstacle after the other, until the path ends in none. Clears the pushes before.
  /// `edge`: the shortest of the elements, m.
  void push_path(VertexPath& path, std::span<PushBy> by, double edge) const;

  double eased = 1;  ///< dt over that of the longest step so far
  std::vector<PlacedObstacle> placed;
  std::vector<Index> near_obstacles;  ///< in placed, near some vertices
  const LiveMask* moving = nullptr;   ///< vertices
  std::vector<double> forces;         ///< without contact and acceleration, of boundary vertices, N
  std::vector<Near> near;             ///< first those of pushed; of points, their vertices
  std::vector<Index> near_of_vertex;  ///< in near, with points or edges; none outside a step
  std::vector<Pushed> pushed;         ///< of near, those near obstacles; of points, then pairs
  std::vector<PushBy> pushes;         ///< of pushed
  std::vector<Vec3> before_edges;     ///< velocities at edges of blades before a sweep
};

}  // namespace suture
