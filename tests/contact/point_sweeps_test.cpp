// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/point_sweeps.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

/// A plane pushes a point that lies between a held vertex and one that is free, and lacks 1 m/s.
/// Returns the changes of the velocities of the free vertex and of the point.
std::array<double, 2> pushed(double weight, double mass) {
  const std::array<Index, 2> vertices{0, 1};
  const std::array<double, 2> weights{1 - weight, weight};
  const double masses[] = {mass, 1};
  PointSweeps sweeps;
  sweeps.clear(2);
  sweeps.add_vertex(0, masses[0], 7);
  sweeps.add_vertex(1, masses[1], 0);
  sweeps.add({0, vertices, weights}, masses);
  PointSweeps::Contact& contact = sweeps.contacts[0];
  contact.normal = {0, 0, 1, 0};
  contact.lacking = 1;
  if (contact.fixed != 0) return {0, 0};  // the general law pushes nothing along what is held
  const std::uint32_t order[] = {0};
  PointSweeps::Changes changes;
  sweeps.sweep(order, changes);
  return {sweeps.vertices[1].change[2], weight * sweeps.vertices[1].change[2]};
}

TEST(PointSweeps, PointsThatAlmostOnlyHeldVerticesCarryThrowNoFreeVertex) {
  for (const double mass : {1e-6, 1.0, 1e6})
    for (double weight = 1e-12; weight < 1; weight *= 3) EXPECT_LT(pushed(weight, mass)[0], 33);
}

TEST(PointSweeps, PointsThatFreeVerticesCarryGetWhatTheyLack) {
  for (const double mass : {1e-6, 1.0, 1e6})
    for (const double weight : {0.05, 0.2, 0.5, 0.9, 1.0})
      EXPECT_NEAR(pushed(weight, mass)[1], 1, 1e-12);
}

}  // namespace
}  // namespace suture
