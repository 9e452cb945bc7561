// SPDX-License-Identifier: GPL-3.0-or-later
//
// Each entry of the ledger compared with a closed form: balance, gravity, loads and prescribed
// motion. Losses: ledger_losses_test.cpp.
#include "tests/dynamics/ledger_rig.hpp"

namespace {

using namespace suture;
using namespace rig;
using namespace spring_model;
using spring_model::Body;

// -------------------------------------------------------------------- balance --

// A leap-frog conserves the energy less h^2/8 sum F^2/m where forces are linear. At the start
// Euler's velocity is that of half a step before, so its remainder there is none.
TEST(Ledger, BalanceIsTheRemainderOfTheTrapezoidWhereForcesAreLinear) {
  for (const char* scheme : schemes)
    for (const double fraction : {0.1, 0.5, 0.8}) {
      Oscillator o(with(scheme, 0, {3, 0, 0}));
      o.displace(2e-3);
      const EnergyBalance start = o.start();
      EXPECT_EQ(start.balance, 0);
      const double h = fraction * 2 / Oscillator::omega();
      const auto remainder = [&] {
        const double force = Oscillator::m * 3 - Oscillator::k * o.u();
        return h * h / 8 * force * force / Oscillator::m;
      };
      const double first = scheme == verlet ? remainder() : 0;
      double largest = 0;
      for (int i = 0; i < 200; ++i) {
        o.step(h);
        const EnergyBalance b = o.dynamics.balance();
        ASSERT_NEAR(b.balance, remainder() - first, 1e-13) << "step " << i;
        expect_to_add_up(start, b);
        largest = std::max(largest, std::abs(b.balance));
      }
      EXPECT_GT(largest, 1e-7) << "more than rounding";
    }
}

TEST(Ledger, BalanceOfABodyThatShakesFallsWithTheSquareOfTheStep) {
  for (const char* scheme : schemes) {
    double last = 0;
    for (const double safety : {0.4, 0.2, 0.1}) {
      Moving m(box(4, 3, 3), with(scheme, 0, {0, -9.8, 0}), {2000, 0, 0});
      m.hold(m.at(0, 0), 7);
      m.block.shake(2e-3, 5);
      for (const Index v : m.at(0, 0))
        for (int c = 0; c < 3; ++c) m.body.attributes().velocity().set(v, c, 0);
      for (Index v = 0; v < m.body.attributes().vertex_count(); ++v)
        for (int c = 0; c < 3; ++c) m.body.attributes().velocity().set(v, c, 0);
      m.start();
      const double dt = safety * 0.7 * m.limits.bounds(0).dt;
      double largest = 0;
      for (double t = 0; t < 0.2; t += dt) {
        m.step(dt);
        largest = std::max(largest, std::abs(m.dynamics.balance().balance));
      }
      if (last > 0) {
        EXPECT_GT(last / largest, 3) << safety;
        EXPECT_LT(last / largest, 5.2) << safety;
      }
      last = largest;
    }
  }
}

// What an unstable step feeds is nowhere but in the stored energy.
TEST(Ledger, BalanceIsAllThatAnUnstableStepMakes) {
  for (const char* scheme : schemes) {
    Oscillator o(with(scheme));
    o.displace(1e-6);
    o.start();
    o.run(1.02 * 2 / Oscillator::omega(), 100);
    const EnergyBalance b = o.dynamics.balance();
    EXPECT_GT(b.kinetic + b.elastic, 1e3 * 5e-11);
    EXPECT_GT(b.balance, 0.9 * b.exchanged);
  }
}

// -------------------------------------------------------------------- gravity --

TEST(Ledger, GravityIsWeightTimesTheWay) {
  for (const char* scheme : schemes) {
    Moving m(box(3, 2, 2), with(scheme, 0, {1, -9.8, 2}));
    m.start();
    for (int i = 0; i < 40; ++i) {
      m.step(1e-3);
      const EnergyBalance b = m.dynamics.balance();
      const double work = m.mass() * (1 * m.shift(0, 0) - 9.8 * m.shift(0, 1) + 2 * m.shift(0, 2));
      ASSERT_NEAR(b.work("gravity"), work, 1e-14 + 1e-12 * work);
    }
  }
}

// Free fall under r(t) g with r = t / T: the kinetic energy is the work, m g^2 T^2 / 8 at T.
TEST(Ledger, GravityWithARampIsTheEnergyOfTheFall) {
  for (const char* scheme : schemes)
    for (const bool looks : {false, true}) {
      double error = 0;
      for (const double dt : {2e-3, 1e-3}) {
        Moving m(box(2, 2, 2), with(scheme, 0, {0, -9.8, 0}, {0.05, 0.25, false}));
        m.start();
        for (int i = 0; i < std::lround(0.25 / dt); ++i) {
          m.dynamics.step(dt, (i + 1) * dt);
          if (looks && i % 3 == 0) m.dynamics.balance();
        }
        const EnergyBalance b = m.dynamics.balance();
        const double expected = m.mass() * 9.8 * 9.8 * 0.2 * 0.2 / 8;
        const double now = std::abs(b.work("gravity") - expected) / expected;
        EXPECT_LT(now, 1e-3) << dt;
        EXPECT_LT(std::abs(b.balance), 2e-3 * expected);
        if (error > 0) {
          EXPECT_NEAR(error / now, 4, 0.3);
        }
        error = now;
        // Beyond the ramp it is the weight times the way again.
        const double from = m.x(0, 1);
        m.run(dt, 30);
        EXPECT_NEAR(m.dynamics.balance().work("gravity") - b.work("gravity"),
                    -9.8 * m.mass() * (m.x(0, 1) - from), 1e-10 * expected);
      }
    }
}

// -------------------------------------------------------------------- loads --

TEST(Ledger, DeadLoadsAreForceTimesWayAndWithARampTheStoredEnergy) {
  for (const char* scheme : schemes) {
    Oscillator o(with(scheme));
    o.loads.add_force(o.body.complex(), o.plate, {0.2, 1, 0}, {});
    o.start();
    for (int i = 0; i < 60; ++i) {
      o.step(0.01);
      ASSERT_NEAR(o.dynamics.balance().work("loads"), 0.2 * o.u(), 1e-14);
    }
    // Slowly: half of force times way, all of it stored.
    Oscillator slow(with(scheme, 1));
    slow.loads.add_traction(slow.body.complex(), std::vector<Dart>{8}, {20, 0, 0}, {0, 8, true});
    slow.start();
    slow.run(0.01, 1000);
    const EnergyBalance b = slow.dynamics.balance();
    const double stored = 0.2 * 0.2 / (2 * Oscillator::k);
    EXPECT_NEAR(slow.u(), 2e-3, 1e-5);
    EXPECT_NEAR(b.work("loads"), stored, 0.01 * stored);
    EXPECT_NEAR(b.elastic, stored, 0.01 * stored);
    EXPECT_LT(std::abs(b.balance), 1e-3 * stored);
  }
}

// The work of a pressure on a closed surface is - p dV, however the body deforms.
TEST(Ledger, PressureOnAClosedSurfaceIsMinusPressureTimesChangeOfVolume) {
  for (const char* scheme : schemes) {
    double error = 0;
    for (const double dt : {2e-3, 1e-3}) {
      Moving m(box(3, 2, 2), with(scheme, 0), {200, 0, 0}, true);
      m.pressures.add(m.body.complex(), boundary_faces(m.body), 100, {});
      const EnergyBalance start = m.start();
      const double before = volume(m.body);
      m.run(dt, static_cast<int>(std::lround(0.06 / dt)));
      const EnergyBalance b = m.dynamics.balance();
      const double work = -100 * (volume(m.body) - before);
      ASSERT_GT(work, 0.01 * 100 * before) << "it was squeezed";
      error = std::abs(b.work("pressure") - work) / work;
      EXPECT_LT(error, 1e-3) << dt;
      EXPECT_LT(std::abs(b.balance), 0.02 * b.exchanged);
      expect_to_add_up(start, b);
    }
  }
}

// -------------------------------------------------------- prescribed motion --

/// 500 steps of a whole body that is moved against gravity: what is prescribed must be its kinetic
/// energy and its weight times its height, to `error`. Returns the largest kinetic energy, J.
double carry(Moving& m, double error) {
  const EnergyBalance start = m.start();
  double most = 0;
  for (int i = 0; i < 500; ++i) {
    m.step(1e-3);
    if (i % 10) continue;
    const EnergyBalance b = m.dynamics.balance();
    most = std::max(most, b.kinetic);
    EXPECT_NEAR(b.prescribed, b.kinetic + m.mass() * 9.8 * m.shift(0, 1), error * (most + 1));
    EXPECT_LT(std::abs(b.balance), 2e-3 * b.exchanged + 1e-12);
    expect_to_add_up(start, b);
  }
  EXPECT_GT(most, 1);
  return most;
}

TEST(Ledger, PrescribedTranslationOfTheWholeBodyIsItsKineticEnergyAgainstGravity) {
  for (const char* scheme : schemes) {
    Moving m(box(3, 2, 2), with(scheme, 0, {0, -9.8, 0}));
    PrescribedMotion lift;
    lift.translation = {0.1, 0.3, 0};
    lift.ramp = {0, 0.4, true};
    m.hold(all_vertices(m.body), 7, lift);
    carry(m, 2e-3);
    const EnergyBalance b = m.dynamics.balance();
    EXPECT_NEAR(b.prescribed, m.mass() * 9.8 * 0.3, 1e-5 * b.prescribed) << "it stands again";
  }
}

// In phases: up, aside, down to where it began.
TEST(Ledger, PrescribedPathOfTheWholeBodyIsItsKineticEnergyAgainstGravity) {
  for (const char* scheme : schemes) {
    Moving m(box(3, 2, 2), with(scheme, 0, {0, -9.8, 0}));
    PrescribedMotion path;
    path.path.stations = {
        {0.05, {}, {}}, {0.2, {0, 0.3}, {}}, {0.3, {0.1, 0.3}, {}}, {0.45, {}, {}}};
    path.path.make_monotone();
    m.hold(all_vertices(m.body), 7, path);
    const double most = carry(m, 4e-3);
    EXPECT_NEAR(m.shift(0, 1), 0, 1e-12) << "it is back";
    EXPECT_NEAR(m.dynamics.balance().prescribed, 0, 1e-5 * most);
  }
}

TEST(Ledger, PrescribedRotationIsTheEnergyOfTheSpin) {
  for (const char* scheme : schemes) {
    Moving m(box(3, 2, 2), with(scheme));
    PrescribedMotion turn;
    turn.axis = {0, 0, 1};
    turn.centre = {0.15, 0.1, 0};
    turn.angle = 2;
    turn.ramp = {0, 1, false};  // 2 rad/s at once
    m.hold(all_vertices(m.body), 7, turn);
    double inertia = 0;
    for (const Index v : all_vertices(m.body))
      inertia += m.body.attributes().mass().get(v, 0) *
                 (std::pow(m.x(v, 0) - 0.15, 2) + std::pow(m.x(v, 1) - 0.1, 2));
    m.start();
    m.run(1e-3, 300);
    const EnergyBalance b = m.dynamics.balance();
    EXPECT_NEAR(b.kinetic, inertia * 4 / 2, 1e-9);
    EXPECT_LT(std::abs(b.balance), 1e-5 * b.exchanged);
  }
}

// A plate moved slowly along x bears K u: the work is K u^2 / 2.
TEST(Ledger, PrescribedMotionOfAPlateIsReactionTimesWay) {
  for (const char* scheme : schemes)
    for (const double damping : {0.0, 2.0}) {
      Moving m(box(2, 1, 1), with(scheme, damping));
      m.hold(m.at(0, 0), 7);
      m.hold(m.at(0, 0.1), 6);
      PrescribedMotion pull;
      pull.translation = {0.02, 0, 0};
      pull.ramp = {0, 10, true};
      m.hold(m.at(0, 0.2), 7, pull);
      const EnergyBalance start = m.start();
      m.run(0.01, 1200);
      const EnergyBalance b = m.dynamics.balance();
      const double work = Oscillator::k / 2 * 0.02 * 0.02 / 2;  // two springs in a row
      EXPECT_NEAR(b.prescribed, work, 0.02 * work) << damping;
      EXPECT_NEAR(b.elastic, work, 0.01 * work);
      EXPECT_LT(std::abs(b.balance), 1e-3 * work) << damping;
      expect_to_add_up(start, b);
    }
}

// Moved in less than a step: energy is fed, and all of it is explained.
TEST(Ledger, PrescribedMotionWithinAStepIsExplained) {
  for (const char* scheme : schemes) {
    Moving m(box(4, 1, 1), with(scheme));
    m.hold(m.at(0, 0), 7);
    PrescribedMotion jerk;
    jerk.translation = {0.004, 0, 0};
    jerk.ramp = {0, 1e-6, false};
    m.hold(m.at(0, 0.4), 7, jerk);
    for (int i = 1; i < 4; ++i) m.hold(m.at(0, 0.1 * i), 6);
    m.start();
    m.run(5e-3, 400);
    const EnergyBalance b = m.dynamics.balance();
    EXPECT_GT(b.kinetic + b.elastic, 1e-5);
    EXPECT_LT(std::abs(b.balance), 0.05 * b.exchanged);
  }
}

}  // namespace
