// SPDX-License-Identifier: GPL-3.0-or-later
// How the forces of contact change with positions, for Newton's method and preconditioners.
#include <algorithm>
#include <numeric>

#include "kernel/contact/multiplier_forces.hpp"
#include "kernel/solvers/links.hpp"

namespace suture {

/// With p' = -k n and, where it slides, q' = mu p' t + holding (-k) (1 - n n^T - t t^T), t the
/// direction of friction, and p n' where an obstacle is round: a soft body that a sphere presses
/// feels that as much as its own stiffness. Without what n' does to friction, and without the
/// derivative of friction by the pressure, which is not symmetric.
Vec3 MultiplierForces::Push::tangent(const Vec3& d) const {
  const Vec3 along = along_surface(d, normal), &straight = curvature.straight;
  const Vec3 normal_part = plus(
      scaled(-stiffness * pressing * dot(normal, d), normal),
      scaled(pressure * curvature.per_metre, minus(along, scaled(dot(straight, along), straight))));
  if (coefficient == 0) return normal_part;
  const Vec3 turning = minus(along, scaled(dot(direction, along), direction));
  return plus(normal_part, scaled(-stiffness * holding, turning));
}

Vec3 MultiplierForces::Push::skew_tangent(const Vec3& d) const {
  return scaled(-stiffness * coefficient * dot(normal, d), direction);
}

bool MultiplierForces::is_conservative(double) {
  if (bounds_stay_) return true;
  return !(contact_.friction_of_pieces() > 0) &&
         std::ranges::all_of(contact_.obstacles(),
                             [](const Obstacle& obstacle) { return obstacle.friction == 0; });
}

void MultiplierForces::add_tangent(const double* d, double dx, double, const TangentTime& at,
                                   double* out) {
  for_each_push(at.time, [&](const Push& push) {
    push.add(scaled(dx, push.tangent(push.sum(d, 3))), out, 3);
  });
}

void MultiplierForces::add_skew_tangent(const double* d, double dx, const TangentTime& at,
                                        double* out) {
  if (bounds_stay_) return;
  for_each_push(at.time, [&](const Push& push) {
    push.add(scaled(dx, push.skew_tangent(push.sum(d, 3))), out, 3);
  });
}

bool MultiplierForces::add_tangent_in_single(const float* d, double dx, double,
                                             const TangentTime& at, float* out) {
  for_each_push(at.time, [&](const Push& push) {
    push.add(scaled(dx, push.tangent(push.sum(d, 4))), out, 4);
  });
  return true;
}

/// Between pieces as links: cells of 8 nodes. The last ones do not count if there are fewer; if
/// there are more, those with the largest weights do, as the matrix only preconditions.
void MultiplierForces::for_each_tangent(double dx, double, const TangentTime& at,
                                        const VisitTangents& visit) {
  std::vector<Index> vertices;
  std::vector<std::size_t> order;  // of the vertices of a push
  std::vector<double> values;
  for_each_push(at.time, [&](const Push& push) {
    const bool is_link = push.obstacle == Contact::between_pieces;
    order.resize(push.vertices.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (order.size() > 8)
      std::ranges::stable_sort(order, std::ranges::greater{},
                               [&](std::size_t i) { return std::abs(push.weights[i]); });
    const std::size_t used = std::min<std::size_t>(order.size(), 8), nodes = is_link ? 8 : used;
    vertices.assign(nodes, push.vertices[order[used - 1]]);
    for (std::size_t i = 0; i < used; ++i) vertices[i] = push.vertices[order[i]];
    values.assign(9 * nodes * nodes * 8, 0);  // one of 8 cells
    for (std::size_t column = 0; column < 3 * used; ++column) {
      Vec3 d{};
      d[column % 3] = dx * push.weights[order[column / 3]];
      const Vec3 f = push.tangent(d);
      for (std::size_t r = 0; r < 3 * used; ++r)
        values[(column * 3 * nodes + r) * 8] = push.weights[order[r / 3]] * f[r % 3];
    }
    visit(
        {1, static_cast<Index>(nodes), vertices.data(), values.data(), is_link ? link_functor : 0});
  });
}

void MultiplierForces::add_gap_tangent(const double* d, double time, double* out) {
  for_each_push(time, [&](const Push& push) {
    if (push.pressure > 0)
      push.add(scaled(-push.stiffness * dot(push.normal, push.sum(d, 3)), push.normal), out, 3);
  });
}

}  // namespace suture
