// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the ledger counts as lost or unexplained by an energy, compared with closed forms: damping,
// functors without an energy, islands put to sleep.
#include "kernel/dynamics/sleep.hpp"
#include "tests/dynamics/ledger_rig.hpp"

namespace {

using namespace suture;
using namespace rig;
using namespace spring_model;
using spring_model::Body;

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

// Long steps near the middle, where there is no force, short ones at the turning points.
TEST(Ledger, StepsOfOtherLengthsDampNoLess) {
  for (const char* scheme : schemes) {
    const double alpha = 0.05;
    Oscillator o(with(scheme, alpha));
    o.displace(1e-3);
    const double all = o.start().elastic;
    while (o.dynamics.time() < 10) o.step(std::abs(o.u()) < 5e-4 ? 1e-2 : 1e-3);
    const EnergyBalance b = o.dynamics.balance();
    const double lost = all - energy_left(1e-3, alpha, o.dynamics.time());
    EXPECT_NEAR(b.dissipated, lost, 0.01 * lost) << scheme;
    EXPECT_NEAR(b.balance, b.recoverable, 0.01 * lost) << scheme;
  }
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

TEST(Ledger, SleepAndWakingAreBooked) {
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
    const EnergyBalance asleep = m.dynamics.balance();
    EXPECT_LT(std::abs(asleep.balance), 0.02 * before.exchanged);
    wake_all(m.dynamics);
    const EnergyBalance awake = m.dynamics.balance();
    m.run(1e-3, 40);
    const EnergyBalance end = m.dynamics.balance();
    // The part of the first step that a leapfrog scheme counts: h^2/8 times |f|^2/m.
    EXPECT_NEAR(awake.events, after.events, 1e-4 * before.exchanged);
    EXPECT_NEAR(awake.balance, asleep.balance, 1e-12 * before.exchanged);
    EXPECT_LT(std::abs(end.balance), 0.02 * end.exchanged);
  }
}

// --------------------------------------------------------- removals and seams --

/// What an event changes besides the energies that are booked under events: nothing.
void expect_event(const EnergyBalance& before, const EnergyBalance& after) {
  const double exact = 1e-12 * before.exchanged;
  EXPECT_NE(after.kinetic, before.kinetic);
  EXPECT_NEAR(after.events - before.events,
              after.kinetic + after.elastic - before.kinetic - before.elastic, exact);
  EXPECT_NEAR(after.work("gravity"), before.work("gravity"), exact);
  EXPECT_NEAR(after.balance, before.balance, exact);
  EXPECT_NEAR(after.dissipated, before.dissipated, exact);
  EXPECT_NEAR(after.models, before.models, exact);
  EXPECT_NEAR(after.recoverable, before.recoverable, exact);
}

// With springs of the edges, which have an energy while those of the elements have none, the sums
// before and after are over the whole body, otherwise around the elements that change.
TEST(Ledger, RemovalsAndSeamsAreBookedAsEventsAndNothingElseJumps) {
  for (const char* scheme : schemes)
    for (const double damping : {0.0, 0.5})
      for (const Springs& springs : {Springs{}, Springs{100, 0, 80}}) {
        Moving m(box(4, 3, 2), with(scheme, damping, {0.5, -9.8, 0}, {0, 0.06}), springs);
        m.hold(m.at(0, 0), 7);
        const EnergyBalance start = m.start();
        m.run(1e-3, 50);
        bool splits = false;  // where elements that are left shared an edge or a vertex only
        const auto expect_only_events = [&](const auto& change) {
          m.run(1e-3, 5);
          const EnergyBalance before = m.dynamics.balance();
          const Index vertices = m.body.complex().existing(0);
          change();
          splits |= m.body.complex().existing(0) > vertices;
          const EnergyBalance after = m.dynamics.balance();
          expect_event(before, after);
          expect_to_add_up(start, after);
        };
        for (const std::vector<Index>& elements : {std::vector<Index>{23}, {6, 7, 18}, {9}, {14}})
          expect_only_events([&] { m.body.pierce(elements); });
        EXPECT_TRUE(splits);
        const Dart side = 24 * 1 + 8, behind = m.body.complex().beta3(side);
        ASSERT_NE(behind, none);
        m.body.cut({side});
        expect_only_events([&] { m.body.sew({{side, behind}}); });
        m.run(1e-3, 40);
        const EnergyBalance end = m.dynamics.balance();
        EXPECT_LT(std::abs(end.balance), 0.02 * end.exchanged);
        expect_to_add_up(start, end);
      }
}

// Damping takes alpha h times twice the kinetic energy, in the step after an operation as well.
TEST(Ledger, DampingIsCountedInTheStepAfterAnOperation) {
  for (const char* scheme : schemes) {
    constexpr double alpha = 20, h = 2e-4;
    Moving m(box(4, 3, 2), with(scheme, alpha, {0.5, -9.8, 0}));
    m.hold(m.at(0, 0), 7);
    m.start();
    m.run(h, 500);
    const auto expect_damping = [&](const char* operation) {
      const EnergyBalance before = m.dynamics.balance();
      m.step(h);
      const double lost = m.dynamics.balance().dissipated - before.dissipated;
      EXPECT_NEAR(lost, 2 * alpha * h * before.kinetic, 0.02 * lost) << scheme << operation;
    };
    expect_damping(" nothing");
    const std::vector<Dart> side{24 * 1 + 8};
    const Dart behind = m.body.complex().beta3(side[0]);
    ASSERT_NE(behind, none);
    m.body.cut(side);
    expect_damping(" cut");
    m.body.sew({{side[0], behind}});
    expect_damping(" sew");
    m.body.pierce({23});
    expect_damping(" pierce");
    m.dynamics.jump([&] {
      for (Index v = 0; v < m.body.attributes().vertex_count(); ++v)
        if (m.body.attributes().fixed().get(v, 0) == 0)
          m.body.attributes().velocity().set(v, 0, m.body.attributes().velocity().get(v, 0) + 0.5);
    });
    expect_damping(" kick");
    m.dynamics.constrain([&] {
      m.hold(m.at(0, 1), 7);
      return std::vector<Index>{};
    });
    expect_damping(" hold");
  }
}

}  // namespace
