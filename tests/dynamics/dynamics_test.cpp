// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "kernel/dynamics/inversion.hpp"
#include "kernel/dynamics/rest_search.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/dynamics/rig.hpp"

namespace {

using namespace suture;
using namespace rig;
using namespace spring_model;
using spring_model::Body;

/// Error after one second of u'' + alpha u' + omega^2 u = g, from rest at u0.
double error_after_a_second(const char* scheme, double alpha, double gravity, int steps) {
  Oscillator o({scheme, alpha, {gravity, 0, 0}, {}});
  const double u0 = 1e-3;
  o.displace(u0);
  o.dynamics.start();
  o.run(1.0 / steps, steps);
  o.dynamics.synchronise();
  const double w2 = Oscillator::omega() * Oscillator::omega(), shift = gravity / w2;
  const double wd = std::sqrt(w2 - alpha * alpha / 4), decay = std::exp(-alpha / 2);
  const double c = std::cos(wd), s = std::sin(wd), a = u0 - shift;
  const double u = shift + a * decay * (c + alpha / (2 * wd) * s);
  const double v = -a * decay * w2 / wd * s;
  return std::hypot(o.u() - u, (o.velocity() - v) / Oscillator::omega()) / u0;
}

TEST(Integrators, ConvergeWithTheirOrderToTheDampedOscillator) {
  for (const double alpha : {0.0, 1.5, 6.0}) {
    const double coarse = error_after_a_second(verlet, alpha, 0.05, 200);
    const double finer = error_after_a_second(verlet, alpha, 0.05, 400);
    EXPECT_LT(coarse, 5e-3);
    EXPECT_NEAR(coarse / finer, 4, 0.2) << "alpha " << alpha;
    const double first = error_after_a_second(euler, alpha, 0.05, 400);
    EXPECT_NEAR(first / error_after_a_second(euler, alpha, 0.05, 800), 2, 0.2) << "alpha " << alpha;
  }
}

TEST(Integrators, AreStableForAnyMassDamping) {
  for (const char* scheme : schemes)
    for (const double alpha : {10.0, 1e3, 1e6}) {
      Oscillator o({scheme, alpha, {0.1, 0, 0}, {}});
      o.dynamics.start();
      o.run(1.9 / Oscillator::omega(), 3000);
      EXPECT_LT(std::abs(o.u()), 2.1 * 0.1 / std::pow(Oscillator::omega(), 2));
      EXPECT_GE(o.u(), 0);
    }
}

/// formulas.md 2: stable iff omega dt < 2 (sqrt(zeta^2 + 1) - zeta).
TEST(Integrators, AreStableUpToTheBoundAndNoFurther) {
  for (const char* scheme : schemes)
    for (const double zeta : {0.0, 1.0, std::sqrt(2.0), 3.0})
      for (const double factor : {0.98, 1.02}) {
        // c per edge; four edges in parallel on one plate of mass M.
        Oscillator o({scheme, 0, {}, {}},
                     {100, 2 * zeta * Oscillator::omega() * Oscillator::m / 4, 0});
        o.displace(1e-9);
        o.dynamics.start();
        const double limit = 2 * (std::sqrt(zeta * zeta + 1) - zeta) / Oscillator::omega();
        o.run(factor * limit, 500);
        const double u = std::abs(o.x(o.plate[0]) - 0.1);
        if (factor < 1)
          EXPECT_LT(u, 1e-7) << zeta;
        else
          EXPECT_GT(u, 1e-6) << zeta;
      }
}

TEST(Integrators, TheStateBetweenStepsMayBeLookedAt) {
  for (const char* scheme : schemes) {
    std::vector<double> states[2];
    for (int look = 0; look < 2; ++look) {
      Moving m(box(4, 3, 3), {scheme, 0.7, {0, 0, -9.8}, {}}, {100, 1, 50});
      PrescribedMotion turn;
      turn.axis = {1, 0, 0};
      turn.angle = 0.5;
      turn.ramp = {0, 0.2, true};
      m.hold(m.at(0, 0), 7, turn);
      m.dynamics.start();
      RestSums sums;
      double time = 0;
      for (int i = 0; i < 100; ++i) {
        const double dt = i < 50 ? 1e-3 : 1.5e-3;
        m.dynamics.step(dt, time += dt);
        if (look && i % 7 == 0) energies(m.dynamics);
        if (look && i % 5 == 0) sums.evaluate(m.dynamics.motion());
      }
      m.dynamics.synchronise();
      states[look] = m.state();
    }
    expect_same_bits(states[0], states[1]);
  }
}

/// Forces that do not exist while it refuses.
struct Refusal : suture::ForceTerm {
  const char* name() const override { return "refusal"; }
  void add_forces(double, const LiveMask&, double*) override {
    if (refuses) throw NumericalError("refused");
  }
  void add_forces_at(const suture::VertexSelection&, std::span<const Index>, double,
                     std::vector<Vec3>&) override {}
  bool refuses = false;
};

// Not the state at the start of the step before.
TEST(Integrators, AStepThatFailsAtItsStartLeavesTheState) {
  for (const char* scheme : {euler, verlet, "xpbd"}) {
    Oscillator o({.integrator = scheme});
    auto& refusal = o.body.add(std::make_unique<Refusal>());
    o.dynamics.start();
    o.run(1e-3, 3);
    o.displace(0.01);
    o.dynamics.start();
    const std::vector<double> before = o.state();
    refusal.refuses = true;
    EXPECT_THROW(o.step(1e-3), NumericalError) << scheme;
    expect_same_bits(o.state(), before);
  }
}

TEST(Dynamics, SameBitsForAnyNumberOfThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<double> one;
  for (const unsigned threads : test::thread_counts()) {
    Moving m(box(20, 20, 20), {euler, 0, {0, -9.8, 0}, {}}, {100, 0, 50}, false, threads);
    m.hold(m.at(0, 0), 7);
    m.dynamics.start();
    m.run(1e-3, 5);
    m.dynamics.synchronise();
    m.block.cut_random(200, 3);
    for (int i = 5; i < 10; ++i) m.dynamics.step(1e-3, (i + 1) * 1e-3);
    const double* x = m.body.attributes().position().rows();
    if (threads == 1) one.assign(x, x + 4 * m.body.attributes().vertex_count());
    EXPECT_EQ(std::memcmp(one.data(), x, one.size() * sizeof(double)), 0) << threads;
  }
}

TEST(Dynamics, FreeBodyKeepsItsMomentumAndEnergyThroughCuts) {
  Moving m(box(4, 4, 4), {verlet, 0, {}, {}});  // diagonals have no energy extension
  Body& body = m.block;
  Dynamics& dynamics = m.dynamics;
  body.shake(2e-3, 4);
  dynamics.start();
  const auto momentum = [&] {
    Vec3 p{};
    for (Index v = 0; v < body.attributes().vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        p[static_cast<std::size_t>(c)] +=
            body.attributes().mass().get(v, 0) * body.attributes().velocity().get(v, c);
    return p;
  };
  const Vec3 before = momentum();
  double energy = energies(dynamics).total();
  double time = 0;
  for (unsigned round = 0; round < 6; ++round) {
    for (int i = 0; i < 200; ++i) dynamics.step(1e-4, time += 1e-4);
    EXPECT_NEAR(energies(dynamics).total(), energy, 1e-4 * energy) << round;
    dynamics.synchronise();
    body.cut_random(8, round);
    EXPECT_NEAR(energies(dynamics).total(), energy, 1e-4 * energy) << "cut " << round;
    energy = energies(dynamics).total();
  }
  const Vec3 after = momentum();
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(after[c], before[c], 1e-12);
}

TEST(Constraints, PrescribedRotationAndTranslationAreExact) {
  Moving m(box(3, 2, 2), {}, {100, 0, 50});
  Body& body = m.block;
  PrescribedMotion motion;
  motion.axis = {0, 0, 2};  // any length
  motion.angle = std::numbers::pi / 2;
  motion.centre = {0, 0.1, 0};
  motion.translation = {0.5, 0, 0.25};
  motion.ramp = {0, 0.1, false};
  const auto held = m.at(0, 0);
  m.hold(held, 7, motion);
  m.dynamics.start();
  EXPECT_EQ(body.last_change(), 0.1);
  m.run(1e-3, 50);
  for (const Index v : held) {  // half way: 45 degrees
    const double y = body.attributes().rest().get(v, 1) - 0.1,
                 z = body.attributes().rest().get(v, 2);
    const double r = std::sqrt(0.5), w = std::numbers::pi / 2 / 0.1;
    EXPECT_NEAR(body.attributes().position().get(v, 0), -r * y + 0.25, 1e-14);
    EXPECT_NEAR(body.attributes().position().get(v, 1), 0.1 + r * y, 1e-14);
    EXPECT_NEAR(body.attributes().position().get(v, 2), z + 0.125, 1e-14);
    EXPECT_NEAR(body.attributes().velocity().get(v, 0), -w * r * y + 5, 1e-12);
    EXPECT_NEAR(body.attributes().velocity().get(v, 1), -w * r * y, 1e-12);
  }
  for (int i = 50; i < 120; ++i) m.dynamics.step(1e-3, (i + 1) * 1e-3);
  for (const Index v : held) {
    EXPECT_NEAR(body.attributes().position().get(v, 0),
                0.5 - (body.attributes().rest().get(v, 1) - 0.1), 1e-14);
    EXPECT_EQ(body.attributes().velocity().get(v, 0), 0);
  }
}

TEST(Constraints, FollowASplitVertex) {
  Moving m(box(2, 2, 1), {}, {100, 0, 50});
  Body& body = m.block;
  m.hold(m.at(2, 0), 7);
  m.dynamics.start();
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * body.complex().element_count(); d += 4)
    if (body.complex().can_cut(d)) faces.push_back(d);
  body.cut(faces);
  EXPECT_EQ(m.at(2, 0).size(), 16u);
  EXPECT_EQ(body.constraints().vertex_count(), 16u);
}

/// The forces of dead loads and pressures, one row of 4 per vertex.
std::vector<double> rows_of_loads(Rig& rig, double time) {
  std::vector<double> rows(4 * std::size_t{rig.body.attributes().vertex_count()});
  rig.loads.add_forces(time, {}, rows.data());
  rig.pressures.add_forces(time, {}, rows.data());
  return rows;
}

double sum_of_loads(Rig& rig, double time, std::size_t component) {
  const std::vector<double> rows = rows_of_loads(rig, time);
  double sum = 0;
  for (std::size_t i = component; i < rows.size(); i += 4) sum += rows[i];
  return sum;
}

TEST(Loads, TotalsAreKeptByCutsAndSharedByArea) {
  Moving m(box(4, 4, 2), {}, {100, 0, 50});
  Body& body = m.block;
  const auto top = m.at(2, 0.2);
  m.loads.add_force(body.complex(), top, {3, -5, 7}, {0, 2, false});
  const std::vector<double> rows = rows_of_loads(m, 2);
  const Index corner = [&] {
    for (const Index v : top)
      if (body.attributes().rest().get(v, 0) == 0 && body.attributes().rest().get(v, 1) == 0)
        return v;
    return none;
  }();
  EXPECT_NEAR(rows[4 * corner + 2], 7.0 / 16 / 4, 1e-14) << "a quarter of a face of sixteen";
  EXPECT_NEAR(sum_of_loads(m, 1, 2), 3.5, 1e-13) << "half the ramp";
  for (unsigned seed = 0; seed < 4; ++seed) {
    body.cut_random(10, seed);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(sum_of_loads(m, 5, c), (std::array{3, -5, 7})[c], 1e-13);
  }
}

TEST(Loads, TractionHasTheRestAreaAndPressureFollows) {
  Moving m(box(3, 2, 2), {}, {100, 0, 50}, true);
  Body& body = m.block;
  m.pressures.add(body.complex(), boundary_faces(body), 1000, {});
  // A closed surface is in equilibrium under pressure, however it is deformed.
  body.shake(0.02, 11);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sum_of_loads(m, 0, c), 0, 1e-11);
  // Power of a uniform expansion x' = x: - 3 p V, here with p = 1000.
  const std::vector<double> rows = rows_of_loads(m, 0);
  double power = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    power += rows[i] * body.attributes().position().rows()[i];
  const double now = volume(body);
  EXPECT_NEAR(power, -3 * 1000 * now, 1e-9 * 3000 * now);

  Moving other(box(3, 2, 2), {}, {100, 0, 50});
  other.loads.add_traction(other.body.complex(), boundary_faces(other.body), {0, 10, 0}, {});
  EXPECT_NEAR(sum_of_loads(other, 0, 1), 10 * 2 * (0.06 + 0.06 + 0.04), 1e-12);
}

TEST(Dynamics, ChecksNameWhatIsWrong) {
  Moving m(box(3, 3, 3), {}, {100, 0, 50});
  Body& body = m.block;
  m.dynamics.start();
  EXPECT_TRUE(find_inverted(body.complex(), body.attributes()).empty());
  const Index vertex = vertices_at(body, 0, 0.1)[3];
  body.attributes().position().set(vertex, 0, 0.75);  // through the element in front
  const std::vector<Index> found = find_inverted(body.complex(), body.attributes());
  EXPECT_FALSE(found.empty());
  EXPECT_TRUE(std::ranges::is_sorted(found));
  std::vector<Dart> star;
  body.complex().star(0, vertex, star);
  for (const Index e : found)
    EXPECT_TRUE(std::ranges::any_of(star, [&](Dart d) { return d / 24 == e; })) << e;
  body.attributes().velocity().set(vertex, 1, std::nan(""));
  try {
    m.dynamics.step(1e-4, 1e-4);
    FAIL() << "no error";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("node " + std::to_string(vertex)), std::string::npos)
        << error.what();
  }
}

TEST(RestSearch, FindsTheEquilibriumOfAHangingBlock) {
  Moving m(box(6, 2, 2), {euler, 0, {9.8, 0, 0}, {0, 0.5, false}}, {4000, 0, 0});
  m.hold(m.at(0, 0), 7);
  m.hold(all_vertices(m.body), 6);
  m.dynamics.start();
  const double dt = 0.8 * m.limits.bounds(0).dt;
  RestSearch search(1e-8, true);
  int steps = 0;
  while (!search.at_rest(m.dynamics) && steps < 20000) {
    m.dynamics.step(dt, (steps + 1) * dt);
    ++steps;
  }
  EXPECT_LT(steps, 5000);
  EXPECT_GT(m.dynamics.time(), 0.5);
  // Springs in a row: spring i carries the plates behind it. Sections of 4 cells,
  // k per section 4 x k, mass of a plate 4 cells but half at the end.
  const double plate = 4 * 1.0, k = 4 * 4000;
  double expected = 0;
  for (int i = 0; i < 6; ++i) expected += 9.8 * plate * (5.5 - i) / k;
  EXPECT_NEAR(m.x(m.at(0, 0.6)[0]) - 0.6, expected, 1e-7 * expected);
}

TEST(Dynamics, ApparentFrequencyIsThatOfTheOscillator) {
  for (const char* scheme : schemes) {
    Oscillator o(Options{scheme, 0, {2, 0, 0}, {}});
    o.start();
    const double h = 0.02;
    o.run(h, 3);
    for (int i = 0; i < 60; ++i) {
      o.step(h);
      ASSERT_NEAR(o.dynamics.motion().sums().apparent_frequency(), h * Oscillator::omega(), 1e-6)
          << i;
    }
    EXPECT_NE(std::ranges::find(o.plate, o.dynamics.motion().fastest_vertex()), o.plate.end());
  }
}

}  // namespace
