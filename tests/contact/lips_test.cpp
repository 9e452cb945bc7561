// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lips of cuts: what they carry, how they slide, that that they do not cross.
#include <gtest/gtest.h>

#include <functional>

#include "kernel/contact/multiplier_forces.hpp"
#include "tests/dynamics/model_block.hpp"

namespace suture {
namespace {

/// A block of 6 x 6 x 6 elements of 0.1 m between two plates that it sticks to, one of which moves.
struct Pressed : rig::Block {
  /// `friction` < 0: no contact.
  Pressed(const Vec3& translation, double friction, const std::string& integrator = rig::euler)
      : Block("tm-faure", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}, {6, 6, 6}, 0.1,
              {integrator, 20, {}, {}}),
        contact(body.add_contact({}, 0)) {
    if (friction >= 0) contact.touch_pieces({friction});
    if (dynamics.is_implicit())
      body.add(std::make_unique<MultiplierForces>(contact, body.attributes(), body.models(),
                                                  dynamics.is_static()));
    const auto bottom = vertices([](const Vec3& x) { return x[2] < 1e-9; });
    const auto top = vertices([](const Vec3& x) { return x[2] > 0.6 - 1e-9; });
    hold(bottom, 7);
    PrescribedMotion motion;
    motion.translation = translation;
    motion.ramp = {0, 0.5, true};
    hold(top, 7, motion);
    plate = bottom;
  }
  /// Between elements that belong to different sides.
  void cut(const std::function<bool(Index x, Index z)>& is_above, Index from = 0) {
    std::vector<Dart> faces;
    const CellComplex& complex = body.complex();
    const auto side = [&](Index e) { return is_above(e % 6, e / 36); };
    for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
      if (complex.can_cut(d) && d / 24 % 6 >= from && complex.beta3(d) / 24 % 6 >= from &&
          side(d / 24) && !side(complex.beta3(d) / 24))
        faces.push_back(d);
    seams.clear();
    for (const Dart d : faces) seams.push_back({d, complex.beta3(d)});
    body.cut(faces);
  }
  /// The force of the block on the plate that stays, after it has come to rest. N
  Vec3 carried() {
    start();
    const double dt = dynamics.is_static() ? 0.5 : 0.7 * stable_step();
    run(dt, dynamics.is_static() ? 1 : static_cast<int>(1.5 / dt));
    Vec3 sum{};
    for (const Vec3& force : body.forces_at(plate, dynamics.time())) sum = plus(sum, force);
    return sum;
  }
  /// How far any vertex of the upper part of a plane cut is below the lower lip where it was. m
  double crossing(double height) {
    const CellComplex& complex = body.complex();
    double deepest = 0;
    for (Index a = 0; a < body.attributes().vertex_count(); ++a) {
      if (std::abs(rest(a)[2] - height) > 1e-9 || complex.dart_of(0, a) / 24 / 36 < 3) continue;
      for (Index b = 0; b < body.attributes().vertex_count(); ++b)
        if (a != b && norm(minus(rest(a), rest(b))) < 1e-9)
          deepest = std::max(deepest, x(b, 2) - x(a, 2));
    }
    return deepest;
  }
  Contact& contact;
  std::vector<Index> plate;
  std::vector<Seam> seams;  ///< that would undo the last cut
};

bool plane(Index, Index z) { return z >= 3; }
bool stairs(Index x, Index z) { return z >= (x < 2 ? 2u : x < 4 ? 3u : 4u); }

TEST(Lips, CarryThePressureOfTheUncutBlock) {
  const Vec3 squeeze{0, 0, -0.012};  // 2 %
  Pressed whole(squeeze, 0);
  const double expected = whole.carried()[2];
  EXPECT_LT(expected, -100);
  for (const auto& cut : {plane, stairs})
    for (const Index from : {0u, 2u}) {
      Pressed block(squeeze, 0);
      block.cut(cut, from);
      EXPECT_NEAR(block.carried()[2] / expected, 1, 0.01)
          << (cut == plane ? "plane" : "stairs") << (from == 0 ? "" : ", which ends inside");
      EXPECT_GT(block.contact.touches().size(), 20u);
    }
}

TEST(Lips, SlideFreelyWithoutFriction) {
  for (const double squeeze : {0.0, -0.012}) {
    const Vec3 shear{0.012, 0, squeeze};
    Pressed whole(shear, 0), open(shear, 0), rough(shear, 10);
    const double expected = whole.carried()[0];
    open.cut(plane);
    rough.cut(plane);
    EXPECT_LT(std::abs(open.carried()[0] / expected), 0.02) << "squeezed by " << squeeze;
    if (squeeze == 0) continue;
    EXPECT_GT(rough.carried()[0] / expected, 0.9);
  }
}

TEST(Lips, CarryThePressureOfTheUncutBlockInEquilibrium) {
  const Vec3 squeeze{0, 0, -0.012};  // 2 %
  Pressed whole(squeeze, 0, "static");
  const double expected = whole.carried()[2];
  EXPECT_LT(expected, -100);
  for (const auto& cut : {plane, stairs})
    for (const Index from : {0u, 2u}) {
      Pressed block(squeeze, 0, "static");
      block.cut(cut, from);
      EXPECT_NEAR(block.carried()[2] / expected, 1, 0.01)
          << (cut == plane ? "plane" : "stairs") << (from == 0 ? "" : ", which ends inside");
      EXPECT_GT(block.contact.touches().size(), 20u);
    }
}

TEST(Lips, SlideFreelyWithoutFrictionInEquilibrium) {
  const Vec3 shear{0.012, 0, -0.012};
  Pressed whole(shear, 0, "static"), open(shear, 0, "static"), rough(shear, 10, "static");
  const double expected = whole.carried()[0];
  open.cut(plane);
  rough.cut(plane);
  EXPECT_LT(std::abs(open.carried()[0] / expected), 0.02);
  EXPECT_GT(rough.carried()[0] / expected, 0.9);
}

TEST(Lips, DoNotRepelWhenTheyAreMade) {
  Pressed block({}, 0.5);
  block.cut(plane, 2);
  block.start();
  block.run(0.7 * block.stable_step(), 50);
  for (Index v = 0; v < block.body.attributes().vertex_count(); ++v)
    EXPECT_LT(norm({block.shift(v, 0), block.shift(v, 1), block.shift(v, 2)}), 1e-15);
}

TEST(Lips, FollowOperationsWhileTheyTouch) {
  Pressed block({0, 0, -0.012}, 0.3);
  const double whole = Pressed({0, 0, -0.012}, 0.3).carried()[2];
  block.start();
  const double dt = 0.7 * block.stable_step();
  const auto run = [&](double seconds) { block.run(dt, static_cast<int>(seconds / dt)); };
  run(0.6);
  block.cut(plane, 2);  // under pressure
  run(0.2);
  const std::size_t touching = block.contact.touches().size();
  EXPECT_GT(touching, 20u);
  std::vector<Index> hole;  // between the lips
  for (const Index z : {2u, 3u})
    for (const Index y : {2u, 3u})
      for (const Index x : {3u, 4u}) hole.push_back(x + 6 * (y + 6 * z));
  block.body.pierce(hole);
  run(0.2);
  EXPECT_LT(block.contact.touches().size(), touching);
  EXPECT_GT(block.contact.touches().size(), 10u);
  const CellComplex& complex = block.body.complex();
  std::erase_if(block.seams, [&](const Seam& s) { return !complex.exists(3, s.one / 24); });
  block.body.sew(block.seams);
  run(0.5);
  EXPECT_EQ(block.contact.touches().size(), 0u);
  Vec3 carried{};
  for (const Vec3& force : block.body.forces_at(block.plate, block.dynamics.time()))
    carried = plus(carried, force);
  EXPECT_NEAR(carried[2] / whole, 0.92, 0.07) << "less the hole";
}

TEST(Lips, WithoutContactTheyCross) {
  Pressed block({0, 0, -0.012}, -1);
  block.cut(plane);
  block.carried();
  EXPECT_GT(block.crossing(0.3), 0.005);
}

TEST(Lips, DoNotCrossOnceTheyHaveParted) {
  Pressed block({}, 0.3);
  block.cut(plane, 2);
  for (Index v = 0; v < block.body.attributes().vertex_count(); ++v)  // throws the lips together
    block.body.attributes().velocity().set(v, 2, block.rest(v)[2] > 0.3 ? 0.5 : 0);
  block.start();
  const double dt = 0.5 * block.stable_step();
  double widest = 0, deepest = 0;
  for (int i = 0; i < 400; ++i) {
    block.run(dt, 1);
    widest = std::max(widest, -block.crossing(0.3));
    deepest = std::max(deepest, block.crossing(0.3));
  }
  EXPECT_LT(deepest, 0.1 * 0.1) << "10 % of an element";
  block.run(dt, static_cast<int>(2 / dt));
  EXPECT_LT(block.crossing(0.3), 1e-4);
}

}  // namespace
}  // namespace suture
