// SPDX-License-Identifier: GPL-3.0-or-later
//
// Steps that follow their error: what they promise, where they become shorter and longer, and that
// rejected ones leave no trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/steps/step_accuracy.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

class AdaptiveRun : public testing::Test {
 protected:
  AdaptiveRun() {
    scene.solver.integrator = "newmark";
    scene.solver.step_error = 1e-3;
    scene.solver.end = 0.3;
    scene.output.enabled = true;
    scene.output.directory = folder / "out";
    scene.output.energies_every = 1;
  }
  void add_model(const char* name, const std::map<std::string, double>& values) {
    ModelUse use;
    use.name = name;
    use.model = &host().model(name);
    use.parameters = parameters(*use.model, values);
    scene.models.push_back(use);
  }
  void push_tip(double force, const TimeRamp& ramp) {
    Load load;
    load.value = {0, -force, 0};
    load.where.what = Selection::Named{"x1"};
    load.ramp = ramp;
    scene.loads.push_back(load);
  }
  RunSummary run() {
    simulation = std::make_unique<Simulation>(scene, host(), diagnostics);
    Observer nobody;
    return simulation->run(nobody);
  }
  double tip() { return simulation->mean_displacement(beam_tip(2))[1]; }
  std::vector<double> column(const char* name) {
    return CsvTable(folder / "out/energies.csv").column(name);
  }
  /// The longest step that ends in (from, to].
  double longest(double from, double to) {
    const std::vector<double> time = column("time [s]"), dt = column("dt [s]");
    double result = 0;
    for (std::size_t i = 1; i < time.size(); ++i)
      if (time[i] > from && time[i] <= to) result = std::max(result, dt[i]);
    return result;
  }
  TemporaryFolder folder;
  Scene scene = beam(host(), "tm-faure", 8, 2, 2.45);
  Diagnostics diagnostics;
  std::unique_ptr<Simulation> simulation;
};

std::vector<double> positions_of(Attributes& attributes) {
  const Column& x = attributes.position();
  return {x.rows(), x.rows() + std::size_t{x.size()} * x.stride()};
}

// ------------------------------------------------------------------- accuracy --

struct Order {
  const char* integrator;
  double coarse, fine;  ///< tolerances
};
class AdaptiveOrder : public AdaptiveRun, public testing::WithParamInterface<Order> {
 protected:
  double error(double tolerance, double exact) {
    scene.solver.step_error = tolerance;
    run();
    return std::abs(tip() - exact);
  }
};
INSTANTIATE_TEST_SUITE_P(Both, AdaptiveOrder,
                         testing::Values(Order{"newmark", 1e-3, 1e-6},
                                         Order{"velocity-verlet", 1e-6, 1e-8}),
                         [](const auto& one) {
                           return one.param.coarse < 1e-4 ? std::string("verlet")
                                                          : std::string("newmark");
                         });

// The error of a step grows with h^3 and so h with tolerance^(1/3); that of the run with h^2.
TEST_P(AdaptiveOrder, TheErrorOfARunFollowsTheTolerance) {
  scene.gravity_ramp = {0, 0.1, true};
  scene.solver.step_tolerance = 1e-11;
  Scene adaptive = scene;
  scene.solver.integrator = "velocity-verlet";
  scene.solver.step_error.reset();
  scene.solver.dt = 2e-5;
  run();
  const double exact = tip();
  scene = adaptive;
  scene.solver.integrator = GetParam().integrator;
  const double coarse = error(GetParam().coarse, exact), fine = error(GetParam().fine, exact);
  EXPECT_NEAR(std::log(coarse / fine) / std::log(GetParam().coarse / GetParam().fine), 2. / 3, 0.1)
      << coarse << " and " << fine;
}

TEST_F(AdaptiveRun, StepsAreShortOnlyWhereTheBodyMoves) {
  scene.gravity = {};
  scene.solver.damping = 15;
  scene.solver.end = 4;
  push_tip(2, {0.5, 0.55, false});
  const RunSummary summary = run();
  EXPECT_EQ(longest(0, 0.5), 0.5) << "one step until the load begins";
  EXPECT_LT(longest(0.5, 0.6), 0.02);
  EXPECT_GT(longest(2, 4), 4 * longest(0.5, 0.6)) << "at rest again";
  EXPECT_LT(summary.rejected_steps, summary.steps / 2);
  EXPECT_EQ(summary.longest_dt, longest(0, 4));
}

TEST_F(AdaptiveRun, SuddenLoadsCostFewRejections) {
  push_tip(1, {0.1, 0.1, false});
  push_tip(-1, {0.2, 0.2, false});
  EXPECT_LT(run().rejected_steps, 20u);
}

// ------------------------------------------------------------- rejected steps --

class RejectedSteps : public AdaptiveRun, public testing::WithParamInterface<std::string> {
 protected:
  RejectedSteps() {
    scene.solver.integrator = GetParam();
    scene.solver.step_error = GetParam() == "newmark" ? 1e-4 : 1e-6;
    add_model("maxwell", {{"k", 100}, {"tau", 0.1}});
    push_tip(60, {0.1, 0.12, false});
    push_tip(60, {0.2, 0.2, false});
  }
};
INSTANTIATE_TEST_SUITE_P(Both, RejectedSteps, testing::Values("newmark", "velocity-verlet"),
                         [](const auto& one) {
                           return one.param == "newmark" ? std::string("newmark")
                                                         : std::string("verlet");
                         });

// The states of the model are part of this: its forces depend on them.
TEST_P(RejectedSteps, LeaveNoTrace) {
  EXPECT_GT(run().rejected_steps, 0u);
  Diagnostics unused;
  BuiltScene built(scene, unused);
  built.dynamics().start();
  const std::vector<double> time = column("time [s]"), dt = column("dt [s]");
  for (std::size_t i = 1; i < time.size(); ++i) built.dynamics().step(dt[i], time[i]);
  EXPECT_EQ(positions_of(simulation->attributes()), positions_of(built.body().attributes()));
}

TEST_P(RejectedSteps, LeaveEventsAndFramesAtTheirTimes) {
  scene.events.push_back(event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}}, 0.15));
  scene.output.every = 0.07;
  const RunSummary summary = run();
  EXPECT_EQ(summary.faces_cut, 4u);
  EXPECT_EQ(summary.time, 0.3);
  EXPECT_EQ(summary.frames, 6u);
  const std::vector<double> time = column("time [s]"), step = column("step");
  for (const double stop : {0.07, 0.1, 0.12, 0.14, 0.15, 0.21, 0.28})
    EXPECT_NE(std::ranges::find_if(time, [&](double t) { return std::abs(t - stop) < 1e-12; }),
              time.end())
        << stop;
  EXPECT_EQ(step.back() + 1, static_cast<double>(step.size()));
}

// ------------------------------------------------------------------- failures --

class FailingSteps : public AdaptiveRun {
 protected:
  std::string failure() {
    try {
      run();
    } catch (const NumericalError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(FailingSteps, ShrunkToNothingSayWhereAndWhy) {
  add_model("moody", {{"how", 4}, {"from", 0.02}});
  scene.solver.integrator = "velocity-verlet";
  const std::string text = failure();
  for (const char* words : {"no step is short enough", "0.02", "rejections in succession",
                            "/solver/step_error is 0.001", "at element ", "increase /solver/"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
}

TEST_F(FailingSteps, OfAModelThatRefusesAnyStepEndWithItsMessage) {
  add_model("moody", {{"how", 1}, {"from", 0.02}});
  const std::string text = failure();
  EXPECT_NE(text.find("the edges want a smaller step"), std::string::npos) << text;
}

TEST_F(AdaptiveRun, AModelMayAskForASmallerStep) {
  add_model("moody", {{"how", 1}, {"from", 0.1}, {"to", 0.15}, {"longest", 1e-3}});
  const RunSummary summary = run();
  EXPECT_EQ(summary.time, 0.3);
  EXPECT_LE(longest(0.105, 0.15), 1.001e-3);
  EXPECT_GT(longest(0.2, 0.3), 5e-3);
}

// -------------------------------------------------------------------- control --

StepError step_error(double error) { return {.error = error, .displacement = 1, .vertex = 0}; }

TEST(StepAccuracy, KeepsAStepThatFits) {
  StepAccuracy accuracy(1e-3, 1);
  accuracy.start(1);
  for (const double error : {0.45e-3, 0.9e-3}) {
    EXPECT_TRUE(accuracy.accepts(step_error(error), 1));
    EXPECT_EQ(accuracy.wanted(), 1);
  }
  EXPECT_TRUE(accuracy.accepts(step_error(0.0), 1));
  EXPECT_EQ(accuracy.wanted(), 3) << "the largest growth";
  EXPECT_TRUE(accuracy.accepts(step_error(1e-9), 1e-3));
  EXPECT_NEAR(accuracy.wanted(), 1e-3 * std::cbrt(0.7e6), 1e-12)
      << "a step that a stop made short tells little";
}

TEST(StepAccuracy, RepeatsAStepUntilItFits) {
  StepAccuracy accuracy(1e-3, 1);
  accuracy.start(1);
  EXPECT_FALSE(accuracy.accepts(step_error(8e-3), 1));
  EXPECT_NEAR(accuracy.wanted(), std::cbrt(0.7 / 8), 1e-12);
  EXPECT_FALSE(accuracy.accepts(step_error(4e-3), 0.5));
  EXPECT_NEAR(accuracy.wanted(), 0.5 * std::sqrt(0.7 / 4), 1e-12) << "forces that jump";
  EXPECT_EQ(accuracy.rejections(), 2u);
  EXPECT_TRUE(accuracy.accepts(step_error(0.0), 0.1));
  EXPECT_EQ(accuracy.rejections(), 0u);
  EXPECT_EQ(accuracy.rejected_steps(), 2u);
  EXPECT_EQ(accuracy.shortest(), 0.1);
}

TEST(StepAccuracy, IsStuckBelowTheResolutionOfTime) {
  StepAccuracy accuracy(1e-3, 1);
  accuracy.start(1e-15);
  EXPECT_FALSE(accuracy.is_stuck(0));
  EXPECT_TRUE(accuracy.is_stuck(100));
}

}  // namespace
}  // namespace suture::test
