// SPDX-License-Identifier: GPL-3.0-or-later
//
// What must change no bit of a run: reading the ledger, the number of threads, and a rollback.
#include <tbb/global_control.h>

#include "tests/dynamics/ledger_rig.hpp"

namespace {

using namespace suture;
using namespace rig;
using namespace spring_model;
using spring_model::Body;

std::vector<double> numbers(const EnergyBalance& b) {
  std::vector<double> all{b.kinetic,    b.elastic, b.prescribed,  b.models,   b.events,
                          b.dissipated, b.balance, b.recoverable, b.exchanged};
  for (const EnergyBalance::Work& work : b.works) all.push_back(work.value);
  return all;
}

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

}  // namespace
