// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/dead_loads.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "tests/forces/load_sums.hpp"

namespace {

using namespace suture;
using namespace spring_model;

/// A block of 4 x 2 x 2 cubes of 0.1 m.
class Loaded : public testing::Test {
 protected:
  std::vector<Vec3> forces(double time = 0) { return forces_of_term(body, loads, time); }
  /// A state further on, and its evaluation in a step.
  void move(double x, double time) {
    for (Index v = 0; v < body.attributes().vertex_count(); ++v)
      body.attributes().position().set(v, 0, body.attributes().rest().get(v, 0) + x);
    std::vector<double> rows(4 * std::size_t{body.attributes().vertex_count()});
    loads.add_forces_in_step({time, 0.1, 0.1}, {}, rows.data());
  }
  Compiled body{box(4, 2, 2)};
  DeadLoads& loads{body.add(std::make_unique<DeadLoads>(body.attributes()))};
};

TEST_F(Loaded, NothingCannotBeLoaded) {
  EXPECT_TRUE(loads.adds_no_rows());
  EXPECT_THROW(loads.add_force(body.complex(), {}, {1, 0, 0}, {}), InputError);
  EXPECT_THROW(loads.add_traction(body.complex(), {}, {1, 0, 0}, {}), InputError);
}

// Faces of 0.01 m2 around a corner, an edge and the middle of the end: 1, 2 and 4 quarters.
TEST_F(Loaded, AForceIsSharedByTheAreaAround) {
  const auto end = vertices_at(body, 0, 0.4);
  loads.add_force(body.complex(), end, {16, 0, -32}, {});
  const auto f = forces();
  for (const Index v : end) {
    const auto at_rim = [&](int c) {
      const double x = body.attributes().rest().get(v, c);
      return x < 1e-9 || x > 0.2 - 1e-9;
    };
    const double share = (at_rim(1) ? 0.5 : 1.0) * (at_rim(2) ? 0.5 : 1.0) / 4;
    EXPECT_NEAR(f[v][0], 16 * share, 1e-13);
    EXPECT_NEAR(f[v][2], -32 * share, 1e-13);
  }
  EXPECT_NEAR(sum(f)[0], 16, 1e-13);
  expect_the_same_at(body, loads, 0);
}

TEST_F(Loaded, AForceOnNodesWithoutAFaceIsSharedEqually) {
  std::vector<Index> line;
  for (const Index v : vertices_at(body, 1, 0.1))
    if (std::abs(body.attributes().rest().get(v, 2) - 0.1) < 1e-9) line.push_back(v);
  ASSERT_EQ(line.size(), 5u);
  loads.add_force(body.complex(), line, {0, 5, 0}, {});
  const auto f = forces();
  for (const Index v : line) EXPECT_NEAR(f[v][1], 1, 1e-14);
}

TEST_F(Loaded, RampsAreAppliedAndReported) {
  loads.add_force(body.complex(), vertices_at(body, 0, 0.4), {16, 0, 0}, {1, 3, false});
  EXPECT_EQ(sum(forces(1))[0], 0);
  EXPECT_NEAR(sum(forces(1.5))[0], 4, 1e-13);
  EXPECT_NEAR(sum(forces(9))[0], 16, 1e-13);
  EXPECT_EQ(loads.last_change(), 3);
}

// The parts of a vertex share its load by their volumes.
TEST_F(Loaded, ASplitSharesByVolumeAndASeamAddsUp) {
  std::vector<Index> middle = vertices_at(body, 0, 0.1);
  loads.add_force(body.complex(), middle, {0, 0, 8}, {});
  const auto whole = forces();
  const auto seams = section(body, 0.1);
  ASSERT_EQ(seams.size(), 4u);
  const TopologyChange change = body.cut(left_sides(seams));
  ASSERT_EQ(change.splits[0].size(), 9u);
  auto open = forces();
  for (const Split& s : change.splits[0]) {
    EXPECT_NEAR(open[s.old_cell][2], whole[s.old_cell][2] / 2, 1e-14);
    EXPECT_NEAR(open[s.new_cell][2], whole[s.old_cell][2] / 2, 1e-14);
  }
  EXPECT_NEAR(sum(open)[2], 8, 1e-13);
  expect_the_same_at(body, loads, 0);
  body.sew(seams);
  const auto sewn = forces();
  EXPECT_NEAR(sum(sewn)[2], 8, 1e-13);
  for (const Index v : middle) EXPECT_NEAR(sewn[v][2], whole[v][2], 1e-14);
}

TEST(DeadLoads, UnequalPartsShareByTheirVolumes) {
  Compiled body({.size = {0.15, 0.2, 0.2}, .cells = {4, 2, 2}, .grading = {8, 1, 1}});
  DeadLoads& loads = body.add(std::make_unique<DeadLoads>(body.attributes()));
  const auto seams = section(body, 0.01);  // between widths of 0.01 and 0.02 m
  ASSERT_EQ(seams.size(), 4u);
  loads.add_force(body.complex(), vertices_at(body, 0, 0.01), {0, 0, 9}, {});
  const TopologyChange change = body.cut(left_sides(seams));
  const auto f = forces_of_term(body, loads, 0);
  for (const Split& s : change.splits[0]) {
    const bool left = std::ranges::any_of(seams, [&](const Seam& seam) {
      const auto& nodes = body.complex().vertices_of(seam.one / 24);
      return std::ranges::find(nodes, s.old_cell) != nodes.end();
    });
    const double all = f[s.old_cell][2] + f[s.new_cell][2];
    EXPECT_NEAR(f[s.old_cell][2], all * (left ? 1 : 2) / 3, 1e-14);
  }
  EXPECT_NEAR(sum(f)[2], 9, 1e-13);
}

TEST_F(Loaded, OfAnElementThatGoesItsShareGoes) {
  loads.add_force(body.complex(), vertices_at(body, 0, 0.2), {24, 0, 0}, {});
  // On the cross-section no face lies in the set: 9 vertices get 24 / 9 each, by 2, 4 or 8
  // elements.
  const Index inner = [&] {
    for (const Index v : vertices_at(body, 0, 0.2))
      if (body.attributes().rest().get(v, 1) > 0.05 && body.attributes().rest().get(v, 1) < 0.15 &&
          body.attributes().rest().get(v, 2) > 0.05 && body.attributes().rest().get(v, 2) < 0.15)
        return v;
    return none;
  }();
  std::vector<Dart> star;
  body.complex().star(0, inner, star);
  ASSERT_EQ(star.size(), 8u);
  const double each = 24.0 / 9;
  body.pierce({star[0] / 24});
  // Its four corners there carried 1/8, 1/4, 1/4 and 1/2 of theirs.
  EXPECT_NEAR(sum(forces())[0], 24 - each * (1.0 / 8 + 0.25 + 0.25 + 0.5), 1e-13);
  EXPECT_NEAR(forces()[inner][0], each * 7 / 8, 1e-14);
}

TEST_F(Loaded, ATractionEndsWhereItsFaceIsSewn) {
  const auto seams = section(body, 0.2);
  body.cut(left_sides(seams));
  loads.add_traction(body.complex(), left_sides(seams), {100, 0, 50}, {});
  EXPECT_NEAR(sum(forces())[0], 4.0, 1e-13) << "Pa on 0.04 m2";
  body.sew({seams[0]});
  EXPECT_NEAR(sum(forces())[0], 3.0, 1e-13);
  EXPECT_NEAR(sum(forces())[2], 1.5, 1e-13);
  body.cut({seams[0].one});
  EXPECT_NEAR(sum(forces())[0], 3.0, 1e-13) << "for good";
  body.pierce({seams[1].one / 24});
  EXPECT_NEAR(sum(forces())[0], 2.0, 1e-13);
}

TEST_F(Loaded, WorkIsByTheTrapezoid) {
  loads.add_force(body.complex(), vertices_at(body, 0, 0.4), {16, 0, 0}, {0, 1, false});
  move(0, 0);
  move(0.01, 0.25);
  EXPECT_NEAR(loads.work(), 16 * (0 + 0.25) / 2 * 0.01, 1e-15);
  move(0.03, 1);
  EXPECT_NEAR(loads.work(), 16 * (0.25 / 2 * 0.01 + (0.25 + 1) / 2 * 0.02), 1e-15);
  EXPECT_NEAR(loads.potential(1), -16 * 0.03, 1e-14);
  const double before = loads.work();
  loads.forget_last();
  move(0.5, 1.1);
  EXPECT_EQ(loads.work(), before) << "a jump is nobody's work";
  move(0.6, 1.2);
  EXPECT_NEAR(loads.work(), before + 16 * 0.1, 1e-14);
  loads.restart();
  EXPECT_EQ(loads.work(), 0);
}

TEST_F(Loaded, ACutTakesNoWork) {
  loads.add_force(body.complex(), vertices_at(body, 0, 0.2), {16, 0, 0}, {});
  move(0, 0);
  move(0.01, 0.1);
  const double potential = loads.potential(0.1);
  body.cut(left_sides(section(body, 0.2)));
  EXPECT_NEAR(loads.potential(0.1), potential, 1e-15);
  move(0.02, 0.2);
  EXPECT_NEAR(loads.work(), 16 * 0.02, 1e-14);
}

TEST_F(Loaded, GoesBackWithItsWork) {
  loads.add_force(body.complex(), vertices_at(body, 0, 0.4), {16, 0, 0}, {});
  move(0, 0);
  move(0.01, 0.1);
  StateBuffer kept;
  kept.save(loads);
  move(0.5, 0.2);
  kept.load(loads);
  move(0.02, 0.2);
  EXPECT_NEAR(loads.work(), 16 * 0.02, 1e-14);
}

}  // namespace
