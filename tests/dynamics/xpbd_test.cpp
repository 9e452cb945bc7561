// SPDX-License-Identifier: GPL-3.0-or-later
//
// Position based dynamics: as soft as its formula says, bounded, and the same for any number of
// threads.
#include <gtest/gtest.h>

#include <cstdlib>

#include "kernel/base/archive.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/dynamics/rest_search.hpp"
#include "kernel/forces/contact_law.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/dynamics/model_block.hpp"

namespace {

using suture::Index, suture::Vec3;

constexpr const char* xpbd = "xpbd";

// One spring between a plate that is held and another: a step is one of implicit Euler.
TEST(Xpbd, IsExactForOneSpring) {
  for (const double h : {0.1, 0.05, 0.01}) {
    rig::Oscillator o({.integrator = xpbd, .damping = 20, .gravity = {1, 0, 0}});
    o.start();
    o.run(h, static_cast<int>(20 / h));
    const double square = h * h * o.k / o.m, softness = square / (2 + square);
    EXPECT_NEAR(o.u(), o.m / o.k, 1e-9) << h;
    EXPECT_NEAR(o.dynamics.softness(), softness, 1e-9 * softness);
    EXPECT_NEAR(o.dynamics.step_of_softness(softness), h, 0.05 * h);
  }
}

// Its period, and all that its steps lose, is in the balance.
TEST(Xpbd, BooksWhatItLoses) {
  rig::Oscillator o({.integrator = xpbd});
  o.displace(0.01);
  o.start();
  double before = energies(o.dynamics).total();
  const double all = before;
  for (int i = 0; i < 400; ++i) {
    o.step(5e-3);
    const double now = energies(o.dynamics).total();
    ASSERT_LT(now, before + 1e-12 * all);
    before = now;
  }
  const suture::EnergyBalance end = o.dynamics.balance();
  EXPECT_GT(end.dissipated, 0.05 * all);
  EXPECT_NEAR(end.dissipated, all - before, 1e-9 * all);
  EXPECT_NEAR(end.balance, 0, 1e-9 * all);
}

TEST(Xpbd, IsTheSameForAnyNumberOfThreads) {
  std::vector<double> one;
  for (const unsigned threads : suture::test::thread_counts()) {
    rig::Moving m(spring_model::box(20, 20, 20), {xpbd, 1, {0, -9.8, 0}, {}}, {100, 0, 0}, true,
                  threads);
    m.hold(m.at(0, 0), 7);
    m.start();
    m.run(1e-3, 5);
    if (one.empty()) one = m.state();
    rig::expect_same_bits(m.state(), one);
  }
}

// Steps far beyond the stable one. SUTURE_FULL=1: 10,000 frames of 20 steps, 5x5x20 elements.
TEST(Xpbd, StaysBoundedAtAnyStiffness) {
  const bool full = std::getenv("SUTURE_FULL") != nullptr;
  const double h = full ? 1.0 / 1200 : 1.0 / 600;
  for (const bool compensates : {false, true})
    for (const double E : {4e3, 4e5, 4e7, 4e9})
      for (const char* model : {"tm-faure", "mss-baudet"}) {
        rig::Cantilever body(model, {{"E", E}, {"nu", 0.3}, {"rho", 1000}, {"viscosity", 0}},
                             {.integrator = xpbd, .solver = {.compensates = compensates}}, {},
                             full ? 5 : 2);
        for (int part = 0; part < (full ? 2000 : 6); ++part) {
          body.run(h, 100);
          ASSERT_LT(std::abs(body.tip()), 2) << model << E << compensates;
        }
      }
}

// What is missing falls with the square of the step, and the estimate says how much it is.
TEST(Xpbd, ErrorFallsWithTheSquareOfTheStep) {
  const auto tip = [](double h) {
    rig::Cantilever body("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}},
                         {.integrator = xpbd, .damping = 5});
    body.run(h, static_cast<int>(4 / h));
    return std::pair(body.tip(), body.dynamics.softness());
  };
  const auto [coarse, soft] = tip(1.0 / 400);
  const auto [fine, half_soft] = tip(1.0 / 800);
  const auto [finest, unused] = tip(1.0 / 1600);
  EXPECT_NEAR((coarse - fine) / (fine - finest), 4, 1);
  const double exact = finest - (fine - finest) / 3;
  EXPECT_NEAR(soft, coarse / exact - 1, 0.25 * soft);
  EXPECT_NEAR(soft / half_soft, 4, 0.5);
}

// Cells that are stiffer by what the steps leave out rest where the finest steps do, but for a part
// of that: those at the surface have fewer neighbours that act against them.
TEST(Xpbd, CompensatesForItsSoftness) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    const auto tip = [&](double h, bool compensates) {
      rig::Cantilever body(
          model, {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}},
          {.integrator = xpbd, .damping = 5, .solver = {.compensates = compensates}});
      body.run(h, static_cast<int>(4 / h));
      return body.tip();
    };
    const double fine = tip(1.0 / 800, false), finest = tip(1.0 / 1600, false);
    const double exact = finest - (fine - finest) / 3;
    const double soft = tip(1.0 / 400, false) / exact - 1;
    EXPECT_GT(soft, 0.02) << model;
    EXPECT_NEAR(tip(1.0 / 400, true) / exact - 1, 0, soft / 10) << model;
  }
}

TEST(Xpbd, GoesOnAfterACut) {
  rig::Cantilever body("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {.integrator = xpbd});
  body.run(1e-3, 50);
  std::vector<suture::Dart> faces;
  for (Index e = 0; e < 4; ++e)
    for (Index f = 0; f < 6; ++f) {
      const suture::Dart face = 24 * (e + 12) + 4 * f, mate = body.complex().beta3(face);
      if (mate != suture::none && suture::element_of(mate) >= 16) faces.push_back(face);
    }
  ASSERT_EQ(faces.size(), 4u);
  body.cut(faces);
  body.run(1e-3, 400);
  EXPECT_GT(-body.tip(), 0.15) << "the end falls";
}

TEST(Xpbd, LeavesTheStateWhereItFindsNoStep) {
  rig::Oscillator o({.integrator = xpbd});
  o.displace(1e200);
  o.dynamics.start();
  const std::vector<double> before = o.state();
  EXPECT_THROW(o.dynamics.step_of_softness(0.05), suture::NumericalError);
  rig::expect_same_bits(o.state(), before);
}

// Nodes that vanish have no mass.
TEST(Xpbd, GoesOnAfterARemoval) {
  rig::Cantilever body("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {.integrator = xpbd});
  body.run(1e-3, 50);
  const double before = body.tip();
  body.body.pierce({28, 29, 30, 31});
  body.run(1e-3, 50);
  for (const double x : body.Rig::state()) ASSERT_TRUE(std::isfinite(x));
  EXPECT_LT(body.x(body.vertices([](const Vec3& x) { return x[2] > 0.87; })[0], 1), before);
}

// The closed form of four springs and dashpots in parallel.
TEST(Xpbd, DampsByADashpot) {
  for (const double viscosity : {0.25, 1.0}) {
    rig::Oscillator o({.integrator = xpbd}, {100, viscosity, 0});
    const double rate = 4 * viscosity / (2 * o.m), w = std::sqrt(o.k / o.m - rate * rate);
    o.displace(0.01);
    o.start();
    o.run(1e-5, 20000);
    const double t = o.dynamics.time();
    const double exact =
        0.01 * std::exp(-rate * t) * (std::cos(w * t) + rate / w * std::sin(w * t));
    EXPECT_NEAR(o.u(), exact, 2e-5) << viscosity;
    EXPECT_NEAR(o.dynamics.balance().balance, 0, 1e-9) << viscosity;
  }
}

// A dashpot beyond any explicit step: the plate creeps, 4 c u' = -k u.
TEST(Xpbd, IsBoundedWithAnyViscosity) {
  for (const double h : {0.1, 0.01}) {
    rig::Oscillator o({.integrator = xpbd}, {100, 1000, 0});
    o.displace(0.01);
    o.start();
    double before = energies(o.dynamics).total();
    for (int i = 0; i < static_cast<int>(10 / h); ++i) {
      o.step(h);
      const double now = energies(o.dynamics).total();
      ASSERT_LT(now, before);
      before = now;
    }
    EXPECT_NEAR(o.u(), 0.01 * std::exp(-10 * o.k / 4000), 0.5 * h * h) << h;
  }
}

constexpr double weight = 9.81;  // m/s^2

/// A block of springs above a floor.
struct OnFloor : rig::Moving {
  OnFloor(Index n, double height, bool distorted, unsigned threads)
      : Moving(spring_model::box(n, n, n), {xpbd, 5, {0, 0, -weight}, {}}, {1000, 0, 0}, distorted,
               threads) {
    body.add_contact({{"floor", "", suture::HalfSpace{{0, 0, -height}, {0, 0, 1}}, {}, 0.5}}, 0);
    start();
  }
};

// Nothing ends inside, at rest the floor carries the weight, and the balance closes.
TEST(Xpbd, RestsOnAFloor) {
  OnFloor block(4, 0.03, false, 1);
  for (int i = 0; i < 4000; ++i) {
    block.step(1e-3);
    for (const Index v : block.at(2, 0)) ASSERT_GE(block.x(v, 2), -0.03 - 1e-12);
  }
  const suture::ContactLaw& contact = *block.body.contact();
  EXPECT_NEAR(contact.loads()[0].force[2] / (block.mass() * weight), -1, 1e-4);
  const suture::EnergyBalance end = block.dynamics.balance();
  EXPECT_LT(end.work("contact"), -0.05 * end.work("gravity")) << "the impact";
  EXPECT_NEAR(end.balance, 0, 2e-4 * end.exchanged);  // springs that turn: not linear
  EXPECT_LT(end.kinetic, 1e-7 * end.exchanged);
}

TEST(Xpbd, TouchesWithTheSameBitsForAnyNumberOfThreads) {
  std::vector<double> one;
  for (const unsigned threads : suture::test::thread_counts()) {
    OnFloor block(20, 0, true, threads);
    block.run(1e-3, 5);
    ASSERT_FALSE(block.body.contact()->touches().empty());
    if (one.empty()) one = block.state();
    rig::expect_same_bits(block.state(), one);
  }
}

// Its rest is where a step changes nothing, though the forces there are not in balance.
TEST(Xpbd, FindsItsRest) {
  const auto tip_after = [](bool search) {
    rig::Cantilever body("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}},
                         {.integrator = xpbd, .damping = 5});
    suture::RestSearch rest(1e-6, true);
    int steps = 0;
    do body.step(1.0 / 400);
    while (++steps < 10000 && !(search && rest.at_rest(body.dynamics)));
    if (search) {
      EXPECT_LT(steps, 5000);
    }
    return body.tip();
  };
  const double after_long = tip_after(false);
  EXPECT_NEAR(tip_after(true), after_long, 1e-5 * std::abs(after_long));
}

// A search for rest that goes on from a state sees the forces that it saw before.
TEST(Xpbd, KeepsWhatItWithholdsInAState) {
  rig::Cantilever body("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {.integrator = xpbd});
  body.run(1.0 / 400, 10);
  suture::Motion& motion = body.dynamics.motion();
  const auto residual = [&] { return suture::RestSums().evaluate(motion).residual; };
  const double before = residual();
  suture::StateTree state;
  save_state(state, body.dynamics);
  motion.discard_forces();
  EXPECT_NE(residual(), before);
  load_state(state, body.dynamics);
  EXPECT_EQ(residual(), before);
}

/// Loads without a force that refuse the forces at the end of a step.
struct LateRefusal : suture::ForceTerm {
  double from;
  explicit LateRefusal(double time) : from(time) {}
  const char* name() const override { return "refusal"; }
  void add_forces(double, const suture::LiveMask&, double*) override {}
  void add_forces_in_step(const suture::StepTimes& step, const suture::LiveMask&,
                          double*) override {
    if (step.time > from) throw suture::StepRejected("refused", 0.5);
  }
  void add_forces_at(const suture::VertexSelection&, std::span<const Index>, double,
                     std::vector<Vec3>&) override {}
};

TEST(Xpbd, SaysThatItsEndWasRefused) {
  rig::Oscillator o({.integrator = xpbd});
  o.body.add(std::make_unique<LateRefusal>(0.035));
  o.start();
  o.run(0.01, 3);
  EXPECT_TRUE(o.dynamics.is_whole());
  EXPECT_THROW(o.step(0.01), suture::StepRejected);
  EXPECT_FALSE(o.dynamics.is_whole());
}

// Where there is no energy, there is nothing to project.
TEST(Xpbd, RefusesWhatItCannotProject) {
  const auto message = [](const rig::Springs& springs) -> std::string {
    try {
      rig::Oscillator(rig::Options{.integrator = xpbd}, springs);
    } catch (const suture::InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({100, 1, 0}), "");
  EXPECT_NE(message({100, 0, 40}).find("no energy"), std::string::npos);
}

}  // namespace
