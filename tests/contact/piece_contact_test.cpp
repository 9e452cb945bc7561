// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contact between pieces that meet.
#include <gtest/gtest.h>

#include "kernel/contact/contact.hpp"
#include "kernel/contact/piece_overlap.hpp"
#include "tests/dynamics/model_block.hpp"
#include "tests/topology/operations.hpp"

namespace suture {
namespace {

// ------------------------------------------------------------------ pieces that meet --

/// A column of blocks, stiff enough not to buckle, each of 3 x 3 x 2 elements of 0.1 m, one on the
/// other.
struct Column : rig::Block {
  explicit Column(Index blocks, double friction, std::vector<Obstacle> obstacles = {},
                  const Vec3& weight = {})
      : Block("tm-faure", {{"E", 1e6}, {"nu", 0.3}, {"rho", 1000}}, {3, 3, 2 * blocks}, 0.1,
              {rig::euler, 2, weight, {0, 0.5}}),
        contact(body.add_contact(std::move(obstacles), 0)) {
    contact.touch_pieces({friction});
    const CellComplex& complex = body.complex();
    std::vector<Dart> faces;
    const auto block_of = [](Dart d) { return d / 24 / 18; };
    for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
      if (complex.can_cut(d) && block_of(d) != block_of(complex.beta3(d))) faces.push_back(d);
    body.cut(faces);
    start();
    dt = 0.7 * stable_step();
  }
  Index block(Index v) const { return body.complex().dart_of(0, v) / 24 / 18; }
  Vec3 momentum() {
    Vec3 sum{};
    for (Index v = 0; v < body.attributes().vertex_count(); ++v)
      sum = plus(sum, scaled(body.attributes().mass().get(v, 0),
                             row(body.attributes().velocity().rows(), v)));
    return sum;
  }
  void move(Index which, const Vec3& by, const Vec3& velocity) {
    for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
      if (block(v) != which) continue;
      add_to_row(body.attributes().position().rows(), v, by);
      add_to_row(body.attributes().velocity().rows(), v, velocity);
    }
  }
  /// How far the top of a block is above the bottom of the next; the least over their nodes. m
  double gap(Index lower) {
    double top = -1e9, bottom = 1e9;
    for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
      const double height = rest(v)[2];
      if (block(v) == lower && height > 0.2 * (lower + 1) - 1e-9) top = std::max(top, x(v, 2));
      if (block(v) == lower + 1 && height < 0.2 * (lower + 1) + 1e-9)
        bottom = std::min(bottom, x(v, 2));
    }
    return bottom - top;
  }
  /// How deep a node is behind the nearest face of the next block that faces it; the largest. m
  double penetration() {
    double deepest = 0;
    const double* positions = body.attributes().position().rows();
    for (const Index v : contact.surface().vertices()) {
      Patch::Foot nearest{};
      double least = 0.05;
      for (std::size_t i = 0; i < contact.surface().faces().size(); ++i) {
        const auto& c = contact.surface().corners()[i];
        const bool is_level = contact.surface().faces()[i] % 6 >= 4;  // across z
        if (block(c[0]) == block(v) || !is_level) continue;
        const Patch patch{{row(positions, c[0]), row(positions, c[1]), row(positions, c[2]),
                           row(positions, c[3])}};
        const Patch::Foot foot = patch.foot(row(positions, v));
        if (norm(foot.offset) >= least) continue;
        least = norm(foot.offset);
        nearest = foot;
      }
      const double gap = dot(nearest.offset, nearest.normal);
      const bool is_beside = norm(minus(nearest.offset, scaled(gap, nearest.normal))) > 1e-4;
      if (!is_beside) deepest = std::max(deepest, -gap);
    }
    return deepest;
  }
  Contact& contact;
  double dt = 0;
};

Obstacle floor_with(double friction) {
  return {"floor", "", HalfSpace{{0, 0, 0}, {0, 0, 1}}, {}, friction};
}

/// The edge pushes nodes that touch the lower block, after the sweeps over the pieces.
TEST(Pieces, DoNotPenetrateWhereACuttingEdgePushesThem) {
  Obstacle handle{"handle", "", Sphere{{0.15, 0.15, 3}, 0.1}};
  handle.motion.stations = {{0, {}, 0}, {1, {0, 0, -1}, 0}};
  Column pair(2, 0, {handle});
  const std::vector<double> toughness(pair.body.complex().element_count(), 1e9);
  pair.contact.add_edge({0, {{0.15, -0.05, 0.25}, {0.15, 0.35, 0.25}}, toughness});
  for (int i = 0; i < 5; ++i) {
    pair.run(pair.dt, 1);
    EXPECT_LT(pair.penetration(), 0.1 * pair.dt) << "step " << i;
  }
}

TEST(Pieces, ThatCollideKeepTheirMomentumAndDoNotPenetrate) {
  Column pair(2, 0.3);
  const double wave = std::sqrt(1.35e6 / 1000);
  pair.move(1, {0.013, 0.021, 0.02}, {0.05 * wave, 0, -0.1 * wave});
  pair.dynamics.start();
  const Vec3 before = pair.momentum();
  double deepest = 0;
  bool met = false;
  pair.dynamics.motion().set_damping(0);
  for (int i = 0; i < 300; ++i) {
    pair.run(pair.dt, 1);
    deepest = std::max(deepest, pair.penetration());
    met |= !pair.contact.touches().empty();
  }
  EXPECT_TRUE(met);
  EXPECT_LT(deepest, 0.1 * 0.1) << "10 % of an element";
  EXPECT_LT(norm(minus(pair.momentum(), before)), 1e-12 * norm(before));
  EXPECT_GT(pair.gap(0), 0) << "they part again";
}

TEST(Pieces, OfAStackComeToRestOnEachOther) {
  Column stack(5, 0.5, {floor_with(0.5)}, {0, 0, -9.81});
  stack.run(stack.dt, static_cast<int>(6 / stack.dt));
  std::vector<double> settled;
  for (Index i = 0; i < 4; ++i) settled.push_back(stack.gap(i));
  const double drift = stack.shift(0, 0);
  stack.run(stack.dt, static_cast<int>(4 / stack.dt));
  for (Index i = 0; i < 4; ++i) {
    EXPECT_GT(stack.gap(i), -1e-3 * 0.1) << "0.1 % of an element, block " << i;
    EXPECT_LT(stack.gap(i), 1e-3);
    EXPECT_NEAR(stack.gap(i), settled[i], 1e-6);
  }
  EXPECT_NEAR(stack.shift(0, 0), drift, 1e-6);
  EXPECT_NEAR(stack.contact.loads()[0].force[2], -9.81 * stack.mass(), 1e-3 * 9.81 * stack.mass());
}

TEST(Pieces, SlideOrHoldByTheirFriction) {
  double slid[2];
  for (const double friction : {0.1, 0.6}) {
    Column pair(2, friction, {floor_with(10)}, {3, 0, -9.81});  // the slope is 0.3
    pair.run(pair.dt, static_cast<int>(1.5 / pair.dt));
    double upper = 0, count = 0;
    for (Index v = 0; v < pair.body.attributes().vertex_count(); ++v)
      if (pair.block(v) == 1) {
        upper += pair.shift(v, 0);
        ++count;
      }
    slid[friction > 0.3] = upper / count;
  }
  EXPECT_GT(slid[0], 0.1);
  EXPECT_LT(slid[1], 0.03);
}

TEST(Pieces, TheLedgerClosesWhenTheyRubAndCollide) {
  Column pair(2, 0.3, {floor_with(0.5)}, {0, 0, -9.81});
  pair.move(1, {0.01, 0, 0.05}, {0.5, 0, 0});
  pair.start();
  pair.run(pair.dt, 600);
  const EnergyBalance books = pair.dynamics.balance();
  EXPECT_LT(books.work("friction"), -0.001 * books.exchanged);
  EXPECT_LT(std::abs(books.balance - books.recoverable), 0.02 * books.exchanged);
}

TEST(Pieces, MayMeetWhereTheyAreHeld) {
  Column pair(2, 0.3, {}, {2, 0, -9.81});
  pair.hold(pair.vertices([](const Vec3& x) { return x[0] < 1e-9; }), 7);
  pair.start();
  pair.run(pair.dt, 1000);
  double farthest = 0;
  for (Index v = 0; v < pair.body.attributes().vertex_count(); ++v)
    farthest = std::max(farthest, norm({pair.shift(v, 0), pair.shift(v, 1), pair.shift(v, 2)}));
  EXPECT_LT(farthest, 0.02);
  EXPECT_GT(farthest, 1e-4);
}

std::vector<PieceOverlap> overlaps_of(Column& column) {
  return find_piece_overlaps(column.contact, column.body.complex(), column.body.attributes());
}

TEST(PieceOverlaps, AreFoundWithTheirDepth) {
  Column stack(3, 0);
  EXPECT_TRUE(overlaps_of(stack).empty()) << "they touch";
  stack.move(2, {0.11, 0.07, -0.05}, {});
  const auto slight = overlaps_of(stack);
  ASSERT_EQ(slight.size(), 1u);
  EXPECT_EQ(slight[0].elements, (std::array<Index, 2>{18, 36}));
  EXPECT_NEAR(slight[0].depth, 0.05, 1e-12);
  EXPECT_NEAR(slight[0].place[2], 0.375, 0.026);
  stack.move(2, {0, 0, -0.07}, {});
  const auto deep = overlaps_of(stack);
  ASSERT_EQ(deep.size(), 1u);
  EXPECT_GT(deep[0].depth, 0.07);
}

TEST(PieceOverlaps, APieceInsideAnElementIsFound) {
  Column pair(2, 0);
  double* x = pair.body.attributes().position().rows();
  for (Index v = 0; v < pair.body.attributes().vertex_count(); ++v)
    if (pair.block(v) == 1)
      for (std::size_t c = 0; c < 3; ++c)
        x[4 * std::size_t{v} + c] = 0.14 + 0.05 * x[4 * std::size_t{v} + c];
  const auto found = overlaps_of(pair);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(found[0].depth, 0.03);
  EXPECT_GE(found[0].vertices, 40u);
}

TEST(Pieces, ARollbackRepeatsTheSameBits) {
  Column pair(2, 0.3, {floor_with(0.5)}, {1, 0, -9.81});
  pair.run(pair.dt, 200);
  StateBuffer kept;
  kept.save(pair.dynamics);
  const double time = pair.dynamics.time();
  const auto finish = [&] {
    for (int i = 1; i <= 100; ++i) pair.dynamics.step(pair.dt, time + i * pair.dt);
    return pair.Rig::state();
  };
  const std::vector<double> first = finish();
  kept.load(pair.dynamics);
  EXPECT_EQ(finish(), first);
}

}  // namespace
}  // namespace suture
