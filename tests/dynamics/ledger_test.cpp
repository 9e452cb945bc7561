// SPDX-License-Identifier: GPL-3.0-or-later
//
// Each entry of the ledger compared with a closed form, and everything that must not depend on
// reading it.
#include "kernel/dynamics/ledger.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "kernel/dynamics/sleep.hpp"
#include "tests/dynamics/rig.hpp"

namespace {

using namespace suture;
using namespace rig;
using namespace spring_model;
using spring_model::Body;

Options with(const char* scheme, double damping = 0, Vec3 gravity = {}, TimeRamp ramp = {}) {
  return {scheme, damping, gravity, ramp};
}

std::vector<double> numbers(const EnergyBalance& b) {
  std::vector<double> all{b.kinetic,    b.elastic, b.prescribed,  b.models,   b.events,
                          b.dissipated, b.balance, b.recoverable, b.exchanged};
  for (const EnergyBalance::Work& work : b.works) all.push_back(work.value);
  return all;
}

/// The equation in the header, by the numbers of a row of energies.csv.
void expect_to_add_up(const EnergyBalance& start, const EnergyBalance& b) {
  double explained = b.prescribed + b.models + b.events - b.dissipated + b.balance;
  for (const EnergyBalance::Work& work : b.works) explained += work.value;
  EXPECT_NEAR(b.kinetic + b.elastic - start.kinetic - start.elastic, explained,
              1e-12 * (b.exchanged + start.elastic));
}

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

TEST(Ledger, PrescribedTranslationOfTheWholeBodyIsItsKineticEnergyAgainstGravity) {
  for (const char* scheme : schemes) {
    Moving m(box(3, 2, 2), with(scheme, 0, {0, -9.8, 0}));
    PrescribedMotion lift;
    lift.translation = {0.1, 0.3, 0};
    lift.ramp = {0, 0.4, true};
    m.hold(all_vertices(m.body), 7, lift);
    const EnergyBalance start = m.start();
    double most = 0;
    for (int i = 0; i < 500; ++i) {
      m.step(1e-3);
      if (i % 10) continue;
      const EnergyBalance b = m.dynamics.balance();
      most = std::max(most, b.kinetic);
      ASSERT_NEAR(b.prescribed, b.kinetic + m.mass() * 9.8 * m.shift(0, 1), 2e-3 * (most + 1));
      ASSERT_LT(std::abs(b.balance), 2e-3 * b.exchanged + 1e-12);
      expect_to_add_up(start, b);
    }
    EXPECT_GT(most, 1);
    const EnergyBalance b = m.dynamics.balance();
    EXPECT_NEAR(b.prescribed, m.mass() * 9.8 * 0.3, 1e-5 * b.prescribed) << "it stands again";
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

// -------------------------------------------------------------------- damping --

// u'' + alpha u' + w^2 u = 0 from rest at u0: what is left of the energy is known.
double energy_left(double u0, double alpha, double t) {
  const double w2 = Oscillator::k / Oscillator::m, wd = std::sqrt(w2 - alpha * alpha / 4);
  const double decay = std::exp(-alpha * t / 2), c = std::cos(wd * t), s = std::sin(wd * t);
  const double u = u0 * decay * (c + alpha / (2 * wd) * s), v = -u0 * decay * w2 / wd * s;
  return Oscillator::m * v * v / 2 + Oscillator::k * u * u / 2;
}

TEST(Ledger, MassDampingDissipatesWhatTheClosedFormLoses) {
  for (const char* scheme : schemes)
    for (const double alpha : {0.5, 4.0}) {
      Oscillator o(with(scheme, alpha));
      o.displace(1e-3);
      const double all = o.start().elastic;
      ASSERT_NEAR(all, 5e-5, 1e-12);
      o.run(1e-3, 1000);
      const EnergyBalance b = o.dynamics.balance();
      const double lost = all - energy_left(1e-3, alpha, 1);
      EXPECT_NEAR(b.dissipated, lost, 0.01 * lost) << alpha;
      EXPECT_LT(std::abs(b.balance), 1e-3 * all) << alpha;
    }
}

TEST(Ledger, DampingIsStillCountedAfterItWasSetOnTheWay) {
  Oscillator o(with(verlet));
  o.displace(1e-3);
  const double all = o.start().elastic;
  o.dynamics.motion().set_damping(4);
  o.run(1e-3, 1000);
  const double lost = all - energy_left(1e-3, 4, 1);
  EXPECT_NEAR(o.dynamics.balance().dissipated, lost, 0.01 * lost);
}

// Springs with c between two plates: the same equation with alpha = c / m.
TEST(Ledger, ViscousSpringsDissipateWhatTheClosedFormLoses) {
  for (const char* scheme : schemes) {
    const double alpha = 2;
    Oscillator o(with(scheme), {100, alpha * Oscillator::m / 4, 0});
    o.displace(1e-3);
    const double all = o.start().elastic;
    double before = 0;
    for (int i = 0; i < 10; ++i) {
      o.run(1e-4, 1000);
      const EnergyBalance b = o.dynamics.balance();
      EXPECT_GT(b.dissipated, before);
      before = b.dissipated;
      const double lost = all - energy_left(1e-3, alpha, 0.1 * (i + 1));
      EXPECT_NEAR(b.dissipated, lost, 0.02 * all);
      EXPECT_LT(std::abs(b.balance), 1e-6 * all);
      EXPECT_EQ(b.models, 0);
    }
  }
}

// ---------------------------------------------------- functors without energy --

TEST(Ledger, WorkOfFunctorsWithoutAnEnergyIsThatOfModels) {
  for (const char* scheme : schemes)
    for (const double edges : {100.0, 0.0}) {
      Moving m(box(3, 2, 2), with(scheme, 0, {0, -9.8, 0}), {edges, 0, 80});
      m.hold(m.at(0, 0), 7);
      const EnergyBalance start = m.start();
      for (int i = 0; i < 300; ++i) {
        m.step(1e-3);
        if (i % 50 != 49) continue;
        const EnergyBalance b = m.dynamics.balance();
        // All springs but the edges' have given what they store.
        const double others =
            reference_energy(m.block, *m.block.instance) - (edges > 0 ? b.elastic : 0);
        ASSERT_GT(others, 1e-3);
        EXPECT_NEAR(b.models, -others, 0.01 * b.exchanged) << edges << " " << i;
        EXPECT_LT(std::abs(b.balance), 0.01 * b.exchanged) << edges << " " << i;
        expect_to_add_up(start, b);
      }
    }
}

// ------------------------------------------------------------------- islands --

TEST(Ledger, SleepIsBookedAndWakingCostsNothing) {
  for (const char* scheme : schemes) {
    Moving m(box(4, 2, 2), with(scheme, 0, {0, -9.8, 0}));
    m.hold(m.at(0, 0), 7);
    m.start();
    m.run(1e-3, 50);
    m.dynamics.synchronise();
    std::vector<Dart> faces;
    for (Dart d = 0; d < 24 * m.body.complex().element_count(); d += 4)
      if (d % 24 == 8 && d / 24 % 4 == 1) faces.push_back(d);  // x1 sides of the second column
    m.body.cut(faces);
    Index islands = 0;
    m.body.complex().islands(&islands);
    ASSERT_EQ(islands, 2u);
    m.run(1e-3, 20);
    std::vector<Index> free;
    for (Index e = 0; e < m.body.complex().element_count(); ++e)
      if (e % 4 > 1) free.push_back(e);
    const EnergyBalance before = m.dynamics.balance();
    put_to_sleep(m.dynamics, free);
    const EnergyBalance after = m.dynamics.balance();
    EXPECT_LT(after.kinetic, before.kinetic);
    EXPECT_NEAR(after.events, after.kinetic - before.kinetic, 1e-12 * before.exchanged);
    EXPECT_NEAR(after.balance, before.balance, 1e-12 * before.exchanged);
    m.run(1e-3, 40);
    EXPECT_LT(std::abs(m.dynamics.balance().balance), 0.02 * before.exchanged);
    wake_all(m.dynamics);
    const EnergyBalance awake = m.dynamics.balance();
    m.run(1e-3, 40);
    const EnergyBalance end = m.dynamics.balance();
    EXPECT_EQ(awake.events, after.events);
    EXPECT_LT(std::abs(end.balance), 0.02 * end.exchanged);
  }
}

// ------------------------------------------------------ what changes no bit --

/// Everything at once: ramps, pressure, a turning end, both sorts of springs.
struct Everything : Moving {
  explicit Everything(const char* scheme, unsigned threads = 1, Index size = 4,
                      double viscosity = 0.5)
      : Moving(box(size, 3, 3), with(scheme, 0.7, {0, -9.8, 1}, {0, 0.05, false}),
               {100, viscosity, 40}, true, threads) {
    PrescribedMotion turn;
    turn.axis = {1, 0, 0};
    turn.angle = 0.5;
    turn.ramp = {0, 0.2, true};
    hold(at(0, 0), 7, turn);
    pressures.add(body.complex(), std::vector<Dart>{0 + 12}, 30, {0, 0.1, false});
    loads.add_force(body.complex(), at(0, 0.1 * size), {1, 1, 0}, {0.02, 0.06, true});
  }
};

TEST(Ledger, LookingAtTheBalanceChangesNoBit) {
  for (const char* scheme : schemes) {
    std::vector<double> expected;
    EnergyBalance balance;
    for (const int every : {0, 1, 7}) {
      Everything m(scheme);
      m.start();
      double time = 0;
      for (int i = 0; i < 100; ++i) {
        const double dt = i < 50 ? 1e-3 : 1.5e-3;
        m.dynamics.step(dt, time += dt);
        if (every > 0 && i % every == 0) m.dynamics.balance();
        if (every == 7 && i % 3 == 0) m.dynamics.synchronise();
      }
      m.dynamics.synchronise();
      const EnergyBalance now = m.dynamics.balance();
      if (every == 0) {
        expected = m.state();
        balance = now;
        continue;
      }
      expect_same_bits(m.state(), expected);
      EXPECT_NEAR(now.balance, balance.balance, 1e-9 * balance.exchanged) << every;
      EXPECT_NEAR(now.prescribed, balance.prescribed, 1e-9 * balance.exchanged) << every;
      EXPECT_NEAR(now.dissipated, balance.dissipated, 1e-9 * balance.exchanged) << every;
    }
  }
}

TEST(Ledger, HasTheSameBitsForAnyNumberOfThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 3);
  std::vector<double> state;
  std::vector<double> balance;
  for (const unsigned threads : {1u, 2u, 3u}) {
    Everything m(verlet, threads, 600);
    ASSERT_GT(m.body.attributes().vertex_count(), 8192u);
    m.start();
    m.run(1e-4, 8);
    m.dynamics.balance();
    m.run(1e-4, 8);
    m.dynamics.synchronise();
    const std::vector<double> now = numbers(m.dynamics.balance());
    if (threads == 1) {
      state = m.state();
      balance = now;
    }
    expect_same_bits(m.state(), state);
    expect_same_bits(now, balance);
  }
}

TEST(Snapshots, GoBackToTheBitWithTheirLedger) {
  for (const char* scheme : schemes)
    for (const bool synchronised : {false, true}) {
      // Forces that a synchronised Verlet has evaluated saw the velocity before its half kick,
      // which is gone: viscous ones come back to their own order in dt only.
      const bool exact_viscosity = scheme == euler || !synchronised;
      Everything m(scheme, 1, 4, exact_viscosity ? 0.5 : 0);
      m.start();
      m.run(1e-3, 40);
      if (synchronised) m.dynamics.synchronise();
      StateBuffer kept;
      kept.save(m.dynamics);
      const double then = m.dynamics.time();
      const auto go_on = [&](double dt) {
        std::vector<double> all;
        for (int i = 0; i < 25; ++i) {
          m.dynamics.step(dt, then + (i + 1) * dt);
          const std::vector<double> now = numbers(m.dynamics.balance());
          all.insert(all.end(), now.begin(), now.end());
          all.push_back(m.dynamics.motion().sums().apparent_frequency());
        }
        m.dynamics.synchronise();
        const std::vector<double> state = m.state();
        all.insert(all.end(), state.begin(), state.end());
        return all;
      };
      const std::vector<double> first = go_on(1e-3);
      kept.load(m.dynamics);
      EXPECT_EQ(m.dynamics.time(), then);
      go_on(1.3e-3);  // another stretch, rejected
      kept.load(m.dynamics);
      expect_same_bits(go_on(1e-3), first);
    }
}

// A pass that meets a number that is not finite has half of a step behind it.
TEST(Snapshots, GoBackFromAStepThatFailed) {
  for (const char* scheme : schemes) {
    Everything m(scheme), other(scheme);
    m.start();
    other.start();
    m.run(1e-3, 20);
    other.run(1e-3, 20);
    StateBuffer kept;
    kept.save(m.dynamics);
    m.run(1e-3, 3);
    m.body.attributes().velocity().set(30, 1, std::nan(""));
    EXPECT_THROW(m.run(1e-3, 2), NumericalError);
    kept.load(m.dynamics);
    m.run(1e-3, 20);
    other.run(1e-3, 20);
    m.dynamics.synchronise();
    other.dynamics.synchronise();
    expect_same_bits(m.state(), other.state());
    EXPECT_NEAR(m.dynamics.balance().balance, other.dynamics.balance().balance, 1e-15);
  }
}

TEST(Dynamics, ApparentFrequencyIsThatOfTheOscillator) {
  for (const char* scheme : schemes) {
    Oscillator o(with(scheme, 0, {2, 0, 0}));
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
