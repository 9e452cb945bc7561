// SPDX-License-Identifier: GPL-3.0-or-later
//
// Implicit Euler on a budget: never more energy, and the rest of the forces in the end.
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "kernel/implicit/newton.hpp"
#include "tests/dynamics/model_block.hpp"

namespace {

using suture::Index, suture::StepBudget, suture::Vec3;

constexpr double frame = 1.0 / 60;

rig::Options with(std::optional<StepBudget> budget, double damping = 0) {
  return {.integrator = "implicit-euler", .damping = damping, .solver = {.budget = budget}};
}

std::map<std::string, double> solid(double E, double nu = 0.3) {
  return {{"E", E}, {"nu", nu}, {"rho", 1000}};
}

// From gel to steel, with one iteration and with enough.
TEST(Budget, NeverAddsEnergy) {
  for (const double E : {4e3, 4e5, 4e7, 4e9})
    for (const unsigned iterations : {1u, 4u, 40u}) {
      rig::Cantilever body("tm-faure", solid(E), with(StepBudget{iterations, 0}));
      double before = energies(body.dynamics).total(), scale = 0;
      for (int i = 1; i <= 120; ++i) {
        body.step(frame);
        const suture::Energies now = energies(body.dynamics);
        scale = std::max({scale, now.kinetic, now.elastic, std::abs(now.external)});
        ASSERT_LE(now.total(), before + 1e-10 * scale) << E << " Pa, step " << i;
        before = now.total();
      }
      EXPECT_LT(body.tip(), 0);
    }
}

// A turning, free body is lengthened by every linear step.
TEST(Budget, TurnsWithoutEnergy) {
  rig::Block body("tm-faure", solid(4e5), {2, 2, 8}, 0.125,
                  {.integrator = "implicit-euler", .solver = {.budget = StepBudget{20, 0}}});
  const suture::Column& rest = body.attributes().rest();
  for (Index v = 0; v < rest.size(); ++v) {
    body.attributes().velocity().set(v, 1, -3 * (rest.get(v, 2) - 0.5));
    body.attributes().velocity().set(v, 2, 3 * (rest.get(v, 1) - 0.125));
  }
  body.start();
  double before = energies(body.dynamics).total();
  const double all = before;
  for (int i = 0; i < 100; ++i) {
    body.step(frame);
    const double now = energies(body.dynamics).total();
    ASSERT_LE(now, before + 1e-10 * all) << "step " << i;
    before = now;
  }
  EXPECT_GT(before, 0.05 * all) << "it turns still";
}

TEST(Budget, RestsWhereTheForcesDo) {
  for (const double nu : {0.3, 0.49}) {
    rig::Cantilever body("tm-faure", solid(4e5, nu), with(StepBudget{4, 0}, 2));
    body.run(frame, 1200);
    rig::Cantilever rest("tm-faure", solid(4e5, nu), {.integrator = "static"});
    rest.step(1);
    EXPECT_NEAR(body.tip() / rest.tip(), 1, 1e-3) << nu;
  }
}

// Where time is no limit, steps differ from those of Newton's method by what is not linear.
TEST(Budget, StepsAreThoseOfNewtonInSmallMotions) {
  rig::Cantilever body("tm-faure", solid(4e7), with(StepBudget{1000, 0})),
      solved("tm-faure", solid(4e7), with({}));
  body.run(frame, 20);
  solved.run(frame, 20);
  EXPECT_NEAR(body.tip() / solved.tip(), 1, 3e-3);
}

// Even where no iteration has time, one is made, also where a pressure has no energy.
TEST(Budget, MovesInNoTime) {
  for (const bool has_pressure : {false, true}) {
    rig::Cantilever body("tm-faure", solid(4e5), with(StepBudget{0, 1e-9}));
    if (has_pressure) body.pressures.add(body.complex(), std::vector<suture::Dart>{12}, 1, {});
    body.start();
    body.run(frame, 30);
    EXPECT_LT(body.tip(), -1e-3);
    EXPECT_NE(body.dynamics.newton()->budget_text().find(" of 30 linear solves early"),
              std::string::npos)
        << body.dynamics.newton()->budget_text();
  }
}

TEST(Budget, FollowsWhatIsMoved) {
  suture::PrescribedMotion motion;
  motion.translation = {0, 0.2, 0};
  motion.ramp = {0, 0.5, false};
  rig::Cantilever body("tm-faure", solid(4e5), with(StepBudget{10, 0}, 2), motion);
  body.run(frame, 1200);
  rig::Cantilever rest("tm-faure", solid(4e5), {.integrator = "static"});
  rest.step(1);
  EXPECT_NEAR(body.tip() - 0.2, rest.tip(), 1e-3 * std::abs(rest.tip()));
}

}  // namespace
