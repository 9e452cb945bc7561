// SPDX-License-Identifier: GPL-3.0-or-later
//
// Preconditioners outlive steps, and results depend on the state alone nevertheless.
#include "kernel/implicit/step_solver.hpp"

#include <gtest/gtest.h>

#include "kernel/base/archive.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/implicit/newton.hpp"
#include "tests/dynamics/model_block.hpp"

namespace {

using suture::Index, suture::Vec3;

constexpr double cell = 0.0625;
constexpr double dt = 1.0 / 60;

/// The paper's cantilever along z, 4x4x16 cells, that begins to sag.
struct Beam : rig::Block {
  explicit Beam(const char* integrator)
      : Block("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {4, 4, 16}, cell,
              {.integrator = integrator, .gravity = {0, -2.45, 0}, .gravity_ramp = {0, 1, false}}) {
    hold(vertices([](const Vec3& x) { return x[2] < 1e-9; }), 7);
    dynamics.start();
  }
  unsigned builds() { return dynamics.newton()->builds(); }
  std::vector<double> positions() {
    const double* x = attributes().position().rows();
    return {x, x + std::size_t{attributes().vertex_count()} * 4};
  }
  void state(suture::Archive& archive) {
    archive("attributes", attributes());
    archive("dynamics", dynamics);
  }
};

class StepSolver : public testing::TestWithParam<const char*> {};

TEST_P(StepSolver, BuildsAPreconditionerForSeveralSteps) {
  Beam beam(GetParam());
  beam.run(dt, 12);
  EXPECT_GE(beam.builds(), 1u);
  EXPECT_LE(beam.builds(), 4u);
}

TEST_P(StepSolver, BuildsTheSameOneAgainAfterARollback) {
  Beam beam(GetParam());
  beam.run(dt, 6);
  suture::StateBuffer kept;
  kept.save(beam);
  beam.run(dt, 6);
  const std::vector<double> once = beam.positions();
  beam.run(4 * dt, 6);  // another one
  kept.load(beam);
  beam.run(dt, 6);
  EXPECT_EQ(beam.positions(), once);
}

INSTANTIATE_TEST_SUITE_P(Of, StepSolver, testing::Values("static", "implicit-euler", "newmark"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

/// Forces that cease to exist during a step that ends late.
struct Refusal : suture::ForceTerm {
  const char* name() const override { return "refusal"; }
  void add_forces(double time, const suture::LiveMask&, double*) override {
    if (time > 100 && ++late_calls > 3) throw suture::NumericalError("too late");
  }
  void add_forces_at(const suture::VertexSelection&, std::span<const Index>, double,
                     std::vector<Vec3>&) override {}
  int late_calls = 0;
};

// As if it had not begun: a replay makes the accepted steps alone.
TEST(StepSolvers, ForgetARejectedStep) {
  Beam beam("implicit-euler"), other("implicit-euler");
  beam.add(std::make_unique<Refusal>());
  for (Beam* b : {&beam, &other}) b->run(dt, 3);
  const unsigned builds = beam.builds();
  EXPECT_THROW(beam.dynamics.step(1e3, 1e3), suture::StepRejected);
  EXPECT_GT(beam.builds(), builds);
  for (Beam* b : {&beam, &other}) b->run(dt, 6);
  EXPECT_EQ(beam.positions(), other.positions());
}

// Where it is going: from where it is, every step would have to find its whole way.
TEST(StepSolvers, StartFromWhereTheVelocitiesLead) {
  Beam beam("implicit-euler");
  unsigned iterations = 0;
  beam.dynamics.newton()->on_iteration = [&](const suture::Newton::Iteration& i) {
    iterations += i.linear_iterations;
  };
  beam.run(dt, 60);
  EXPECT_LE(iterations, 455u);
}

}  // namespace
