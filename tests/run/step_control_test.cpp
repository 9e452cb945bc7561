// SPDX-License-Identifier: GPL-3.0-or-later
//
// Steps that are rejected and repeated: they leave no trace in the state or on disk.
#include "kernel/steps/step_control.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <set>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/steps/kept_states.hpp"
#include "tests/base/same_state.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

using Integrator = std::string;
constexpr double never = 1e300;

class Retry : public testing::TestWithParam<Integrator> {
 protected:
  Retry() {
    scene.solver.integrator = GetParam();
    scene.solver.end = 0.1;
    scene.output.enabled = true;
    scene.output.directory = folder / "out";
    scene.output.energies_every = scene.output.probes_every = 1;
    scene.output.probes.push_back({"tip", beam_tip(2)});
  }
  /// Edges that fail from `from` to `to` where a step is longer than `longest`; how: 1 retry,
  /// 2 NaN, 3 stop.
  void add_moody(double how, double from, double to, double longest, double factor = 0.5) {
    ModelUse use;
    use.name = "moody";
    use.model = &host().model("moody");
    use.parameters = parameters(
        *use.model,
        {{"how", how}, {"from", from}, {"to", to}, {"longest", longest}, {"factor", factor}});
    scene.models.push_back(use);
  }
  void add_cut() { scene.events.push_back(event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}}, 0.02)); }
  RunSummary run() {
    simulation = std::make_unique<Simulation>(scene, host(), diagnostics);
    return simulation->run(listener);
  }
  std::vector<double> positions() {
    const Column& x = simulation->attributes().position();
    return {x.rows(), x.rows() + std::size_t{x.size()} * x.stride()};
  }
  CsvTable energies() { return CsvTable(folder / "out/energies.csv"); }
  /// The same steps in one go, nothing rejected.
  std::vector<double> repeated() {
    Diagnostics unused;
    BuiltScene built(scene, unused);
    built.dynamics().start();
    const CsvTable table = energies();
    const std::vector<double> time = table.column("time [s]"), dt = table.column("dt [s]");
    for (std::size_t i = 1; i < time.size(); ++i) built.dynamics().step(dt[i], time[i]);
    const Column& x = built.body().attributes().position();
    return {x.rows(), x.rows() + std::size_t{x.size()} * x.stride()};
  }
  void expect_whole_tables() {
    const CsvTable table = energies();
    const std::vector<double> step = table.column("step"), time = table.column("time [s]"),
                              dt = table.column("dt [s]");
    for (std::size_t i = 0; i < step.size(); ++i) {
      ASSERT_EQ(step[i], static_cast<double>(i)) << "no gap and no double";
      if (i > 0) {
        ASSERT_NEAR(time[i] - time[i - 1], dt[i], 1e-9 * dt[i]) << i;
      }
    }
    EXPECT_EQ(CsvTable(folder / "out/probes.csv").column("time [s]"), time);
  }
  TemporaryFolder folder;
  Scene scene = beam(host(), "tm-faure", 4, 2, 9.8);
  Diagnostics diagnostics;
  Listener listener;
  std::unique_ptr<Simulation> simulation;
};
INSTANTIATE_TEST_SUITE_P(Both, Retry, testing::Values("symplectic-euler", "velocity-verlet"),
                         [](const auto& one) {
                           return one.param == "velocity-verlet" ? std::string("verlet")
                                                                 : std::string("euler");
                         });

TEST_P(Retry, IsHonouredWithAnAutomaticStepAndLeavesNoTrace) {
  const RunSummary whole = run();
  const double longest = 0.3 * whole.dt;
  const double tip = simulation->mean_displacement(beam_tip(2))[1];
  add_moody(1, 0.04, 0.05, longest);
  const RunSummary summary = run();
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished);
  EXPECT_GE(summary.rollbacks, 2u) << "two halvings";
  EXPECT_EQ(summary.time, 0.1);
  expect_whole_tables();
  const CsvTable table = energies();
  const std::vector<double> time = table.column("time [s]"), dt = table.column("dt [s]");
  for (std::size_t i = 2; i < time.size(); ++i)
    if (time[i - 1] >= 0.041 && time[i - 1] < 0.05) {
      ASSERT_LE(dt[i], longest * (1 + 1e-6)) << i;
    }
  EXPECT_EQ(positions(), repeated());
  const double order = GetParam() == "velocity-verlet" ? 2e-3 : 0.05;  // second, first
  EXPECT_NEAR(simulation->mean_displacement(beam_tip(2))[1], tip, order * std::abs(tip));
  ASSERT_FALSE(listener.lines.empty());
  const std::string& line = listener.lines.front();
  for (const char* words :
       {"moody", "the edges want a smaller step", "rolled back to t = ", "with dt = "})
    EXPECT_NE(line.find(words), std::string::npos) << line;
}

TEST_P(Retry, DividesAFixedStepAndGoesBackToWholeOnes) {
  scene.solver.dt = 1e-4;
  scene.solver.end = 0.2;
  add_moody(1, 0.02, 0.025, 0.5e-4);
  const RunSummary summary = run();
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished);
  EXPECT_GE(summary.rollbacks, 1u);
  EXPECT_EQ(summary.dt, 1e-4) << "whole steps again";
  EXPECT_EQ(summary.time, 2000 * 1e-4);
  expect_whole_tables();
  const std::vector<double> time = energies().column("time [s]");
  const std::set<double> times(time.begin(), time.end());
  for (int i = 0; i <= 2000; ++i) ASSERT_TRUE(times.contains(i * 1e-4)) << i;
  EXPECT_GT(time.size(), 2001u);
  EXPECT_LT(time.size(), 2001u + 1200u) << "halved for 512 steps, and those of the failure";
  EXPECT_EQ(positions(), repeated());
}

TEST_P(Retry, TakesTheStepThatTheModelProposes) {
  scene.solver.dt = 1e-4;
  add_moody(1, 0.02, 0.0205, 1e-4 / 8, 0.125);
  const RunSummary summary = run();
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished);
  EXPECT_EQ(summary.rollbacks, 1u) << "three halvings at once";
}

TEST_P(Retry, ThatNothingSatisfiesEndsTheRun) {
  for (const bool fixed : {false, true}) {
    if (fixed) scene.solver.dt = 1e-4;
    scene.models.resize(1);
    add_moody(1, 0.02, never, 0);
    try {
      run();
      FAIL() << "no error";
    } catch (const NumericalError& error) {
      const std::string text = error.what();
      for (const char* words :
           {"moody", "the edges want a smaller step", "maller steps do not help"})
        EXPECT_NE(text.find(words), std::string::npos) << text;
      EXPECT_EQ(text.find("\"auto\""), std::string::npos) << text;
    }
  }
}

TEST_P(Retry, SoonAfterACutIsHonouredAndTheCutStays) {
  scene.solver.dt = 1e-4;
  add_cut();
  for (const double from : {0.0212, 0.023, 0.03}) {
    scene.models.resize(1);
    add_moody(1, from, from + 5e-4, 0.5e-4);
    const RunSummary summary = run();
    EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished) << from;
    EXPECT_EQ(summary.faces_cut, 4u) << from;
    EXPECT_GE(summary.rollbacks, 1u) << from;
    expect_whole_tables();
  }
}

/// Nothing goes back behind the cut, but a step of Euler that is rejected has moved nothing.
/// (Forces of Verlet are those of the step before, which cannot be made again.)
TEST_P(Retry, InTheVeryStepOfACutMakesThatStepSmaller) {
  scene.output.energies_every = scene.output.probes_every = 0;
  scene.solver.dt = 1e-4;
  add_cut();
  const bool is_euler = GetParam() == "symplectic-euler";
  add_moody(1, 0.02, 0.0205, 0.5e-4);
  if (!is_euler) {
    EXPECT_THROW(run(), NumericalError);
    return;
  }
  const RunSummary summary = run();
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished);
  EXPECT_EQ(summary.faces_cut, 4u);
  EXPECT_EQ(summary.rollbacks, 1u);
  EXPECT_EQ(summary.time, 1000 * 1e-4);
}

TEST_P(Retry, CutsWithABladeWhatAnUndisturbedRunCuts) {
  scene.solver.dt = 1e-4;
  scene.gravity = {0, 0, 0};
  CutBlade blade;
  for (const auto& [at, y] : {std::pair{0.01, 0.3}, std::pair{0.09, -0.05}})
    blade.stations.push_back({at, {{0.4, y, -0.1}, {0.4, y, 0.4}}});
  scene.events.push_back(event_of(blade));
  const RunSummary whole = run();
  ASSERT_EQ(whole.faces_cut, 4u);
  for (const double from : {0.015, 0.042, 0.07, 0.088}) {
    scene.models.resize(1);
    add_moody(1, from, from + 5e-4, 0.5e-4);
    EXPECT_EQ(run().faces_cut, whole.faces_cut) << from;
    expect_whole_tables();
  }
}

TEST_P(Retry, WritesEachFrameOnce) {
  scene.solver.dt = 1e-4;
  scene.output.every = 2e-3;
  add_moody(1, 0.0505, 0.052, 0.25e-4);
  const RunSummary summary = run();
  EXPECT_GE(summary.rollbacks, 2u);
  EXPECT_EQ(summary.frames, 51u);
  const std::string pvd = read_text(folder / "out/run.pvd");
  std::size_t at = 0;
  for (int i = 0; i <= 50; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "frame_%04d.vtu", i);
    const std::size_t found = pvd.find(name, at);
    ASSERT_NE(found, std::string::npos) << name;
    at = found + 1;
    const std::size_t stamp = pvd.rfind("timestep=\"", found);
    ASSERT_NE(stamp, std::string::npos);
    EXPECT_NEAR(std::stod(pvd.substr(stamp + 10)), i * 2e-3, 1e-9) << name;
  }
  EXPECT_EQ(pvd.find("frame_0051"), std::string::npos);
}

// Two looks per frame would let a frame of a rejected step slip out.
TEST_P(Retry, HoldsBackWhatMayStillBeRejected) {
  scene.solver.dt = 1e-4;
  scene.output.every_steps = 1;
  add_moody(3, 0.0505, never, 0);
  EXPECT_THROW(run(), NumericalError);
  const CsvTable table = energies();
  EXPECT_LE(table.last("time [s]"), 0.0506);
  expect_whole_tables();
  EXPECT_TRUE(std::filesystem::exists(folder / "out/failed.pvd"));
}

TEST_P(Retry, AForceThatIsNotFiniteIsTriedAgainBeforeItEndsTheRun) {
  // A smaller step does not help: it ends with cause and place.
  add_moody(2, 0.04, never, 0);
  for (const bool fixed : {false, true}) {
    if (fixed) scene.solver.dt = 1e-4;
    listener.lines.clear();
    try {
      run();
      FAIL() << "no error";
    } catch (const NumericalError& error) {
      const std::string text = error.what();
      for (const char* words : {"moody", "finite"})
        EXPECT_NE(text.find(words), std::string::npos) << text;
    }
    EXPECT_FALSE(listener.lines.empty()) << fixed;
  }
  // One that does.
  scene.solver.dt.reset();
  scene.models.resize(1);
  add_moody(2, 0.04, 0.041, 1e-3 / 4);
  const RunSummary summary = run();
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished);
}

// -------------------------------------------------------------- unstable steps --

/// A block of 1 m stretched by 60 % in half a second: the stable step falls by a half on the way.
Scene stretched() {
  Scene scene = beam(host(), "tm-faure", 4, 2, 0);
  Constraint pull;
  pull.where.what = Selection::Named{"x1"};
  pull.moves = true;
  pull.translation = {0.6, 0, 0};
  pull.ramp = {0, 0.5, true};
  scene.constraints.push_back(pull);
  scene.solver.end = 0.6;
  return scene;
}

TEST(UnstableSteps, AreFoundAndMadeAgain) {
  double reference = 0;
  for (const double safety : {0.05, 0.8}) {
    Scene scene = stretched();
    scene.solver.safety = safety;
    Listener listener;
    TestSimulation simulation(scene);
    const RunSummary summary = simulation.run(listener);
    EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished);
    EXPECT_LT(std::abs(summary.balance), 0.02 * summary.exchanged) << safety;
    Selection middle;
    middle.what = Selection::InBox{{0.49, 0, 0}, {0.51, 1, 1}};
    middle.path = "/middle";
    const double now = simulation.mean_displacement(middle)[0];
    if (safety < 0.1)
      reference = now;
    else {
      EXPECT_NEAR(now, reference, 0.01);
    }
  }
}

TEST(UnstableSteps, OfAFixedStepEndTheRunWithAdviceThatFits) {
  Scene scene = beam(host(), "tm-faure", 4, 2, 9.8);
  scene.solver.end = 1e4;
  scene.solver.dt = 0.02;
  Listener listener;
  TestSimulation simulation(scene);
  try {
    simulation.run(listener);
    FAIL() << "no error";
  } catch (const NumericalError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/solver/dt is 0.02 s"), std::string::npos) << text;
    EXPECT_NE(text.find("set it to \"auto\""), std::string::npos) << text;
    EXPECT_EQ(text.find("shows"), std::string::npos) << "no output, no frame: " << text;
  }
}

// Steps back are made from them.
TEST(KeptStates, OfANumberThatNoRunKeepsAreRefused) {
  KeptStates states, found;
  for (const char* name : {"older", "count"}) {
    StateTree tree = state_of(states);
    overwrite(tree, name, 0, 3U);
    EXPECT_EQ(refusal_of(tree, found), "/: there are more kept states than a run keeps");
  }
}

}  // namespace
}  // namespace suture::test
