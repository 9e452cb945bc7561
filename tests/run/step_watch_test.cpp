// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stable step: that the search finds the largest eigenvalue of any body, against a
// dense solver, and when a run searches.
#include "kernel/run/step_watch.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>
#include <random>

#include "kernel/scene/built_scene.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {
namespace {

PluginHost& host() {
  static PluginHost plugins;
  return plugins;
}

struct Case {
  const char* name;
  const char* model;
  std::map<std::string, double> values;
};

class StepSearch : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Models, StepSearch,
                         testing::Values(Case{"tm", "tm-faure", {}}, Case{"ms", "mss-baudet", {}},
                                         Case{"viscous", "mss-baudet", {{"viscosity", 1}}}),
                         [](const auto& model) { return std::string(model.param.name); });

/// Largest eigenvalue of M^-1/2 (dt^2/4 K + dt/2 C) M^-1/2 over the free components, by a
/// dense solver; the matrix column by column from the derivatives of the forces.
double largest_eigenvalue(BuiltScene& w, double dt) {
  const Index vertices = w.body().attributes().vertex_count();
  std::vector<float> direction(3 * vertices), image(3 * vertices);
  std::vector<Index> free;
  for (Index i = 0; i < 3 * vertices; ++i) {
    const auto fixed = static_cast<int>(w.body().attributes().fixed().get(i / 3, 0));
    if (w.body().attributes().mass().get(i / 3, 0) > 0 && !(fixed >> i % 3 & 1)) free.push_back(i);
  }
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index column = 0; column < size; ++column) {
    direction.assign(direction.size(), 0);
    image.assign(image.size(), 0);
    direction[free[column]] = 1;
    w.body().models().add_tangent(direction.data(), dt * dt / 4, dt / 2, 0, image.data());
    for (Eigen::Index row = 0; row < size; ++row)
      matrix(row, column) =
          -image[free[row]] / std::sqrt(w.body().attributes().mass().get(free[row] / 3, 0) *
                                        w.body().attributes().mass().get(free[column] / 3, 0));
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()[size - 1];
}

TEST_P(StepSearch, FindsTheLargestEigenvalueOfAnyBody) {
  const unsigned seed = std::random_device{}();
  const testing::ScopedTrace trace(__FILE__, __LINE__, "seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int round = 0; round < 4; ++round) {
    const Scene scene = beam(host(), GetParam().model, 5, 4, 10, GetParam().values);
    Diagnostics diagnostics;
    BuiltScene w(scene, diagnostics);
    w.dynamics().start();
    std::vector<Index> gone;
    for (Index e = 0; e < w.body().complex().element_count(); ++e)
      if (random() % 5 == 0) gone.push_back(e);
    w.body().pierce(gone);
    Column& position = w.body().attributes().position();
    for (Index v = 0; v < w.body().attributes().vertex_count(); ++v)
      for (int c = 0; c < 3 && w.body().complex().exists(0, v); ++c)
        position.set(v, c, position.get(v, c) + 2e-3 * number(random));
    w.dynamics().start(w.dynamics().time());
    // At the step found the eigenvalue is 1, to twice the tolerance of the step.
    const double largest = largest_eigenvalue(w, w.limits().stable_step(w.dynamics().time()));
    EXPECT_GT(largest, 0.965);
    EXPECT_LT(largest, 1.035);
  }
}

class Watch : public testing::Test {
 protected:
  Watch() : scene(beam(host(), "tm-faure", 8, 2, 10)), built(scene, diagnostics) {
    built.dynamics().start();
    bound = built.limits().bounds(0).dt;
    stable = built.limits().stable_step(built.dynamics().time());
  }
  /// A face on two sides of the body: a vertex of it splits. Returns the bound around it.
  double cut() {
    Dart inner = 0;
    while (!built.body().complex().can_cut(inner)) ++inner;
    const TopologyChange change = built.body().cut({inner});
    EXPECT_FALSE(change.splits[0].empty());
    std::vector<Index> vertices(change.stars[0].cells.begin(), change.stars[0].cells.end());
    bound = built.limits().bounds(0).dt;
    return built.limits().bounds_at(vertices, 0).dt;
  }
  Scene scene;
  Diagnostics diagnostics;
  BuiltScene built;
  double bound = 0, stable = 0;
};

TEST_F(Watch, AnEventLowersAutoToTheBoundAroundItUntilEventsAreOver) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_NEAR(watch.stable(), stable, 0.02 * stable);
  EXPECT_GT(watch.stable(), 1.1 * bound);
  const double first = cut();
  watch.after_event(10);
  EXPECT_NEAR(watch.stable(), std::min(stable, first), 1e-12 * stable);
  EXPECT_LT(watch.stable(), stable);
  const double lower = std::min(first, cut());
  watch.after_event(300);
  EXPECT_NEAR(watch.stable(), lower, 1e-12 * stable);
  watch.after_step(512);
  EXPECT_EQ(watch.stable(), bound) << "an event 212 steps ago: no search, but all vertices";
  watch.after_step(1024);
  EXPECT_NEAR(watch.stable(), built.limits().stable_step(built.dynamics().time()), 0.02 * stable);
}

TEST_F(Watch, AnEventThatChangesNoVertexLeavesTheStepAlone) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  const double before = watch.stable();
  built.limits().bounds_of_changes(0);
  watch.after_event(500);
  EXPECT_EQ(watch.stable(), before);
  watch.after_step(512);
  EXPECT_NEAR(watch.stable(), stable, 0.02 * stable) << "searched: no event lowered the step";
}

TEST_F(Watch, EventsInEveryStepDoNotKeepASearchAwayForever) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  const auto lower = [&](std::uint64_t step) {
    Dart inner = 0;
    while (!built.body().complex().can_cut(inner)) inner += 4;
    const double before = watch.stable();
    built.body().cut({inner});
    watch.after_event(step);
    return watch.stable() < before;
  };
  ASSERT_TRUE(lower(1));
  double searched = 0;
  for (std::uint64_t step = 512; step <= 4096; step += 512) {
    watch.after_step(step);
    if (step < 4096) {
      EXPECT_NEAR(watch.stable(), built.limits().bounds(0).dt, 1e-12 * stable) << step;
      Column& x =
          built.body().attributes().position();  // so that the next cut lowers the step again
      for (Index v = 0; v < x.size(); ++v) x.set(v, 0, 1.03 * x.get(v, 0));
      built.dynamics().start(built.dynamics().time());
      ASSERT_TRUE(lower(step + 511)) << step;
    } else {
      searched = watch.stable();
    }
  }
  EXPECT_NE(searched, built.limits().bounds(0).dt);
  EXPECT_NEAR(searched, built.limits().stable_step(built.dynamics().time()), 0.02 * searched);
}

TEST_F(Watch, AFixedStepBelowTheBoundIsNotSearched) {
  scene.solver.dt = 0.9 * bound;
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_EQ(watch.stable(), bound);
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST_F(Watch, AFixedStepBetweenTheBoundAndTheLimitIsSearchedAndAccepted) {
  scene.solver.dt = (bound + stable) / 2;
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_NEAR(watch.stable(), stable, 0.02 * stable);
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST_F(Watch, AFixedStepThatAnEventMakesTooLongIsWarnedOfOnce) {
  scene.solver.dt = 0.98 * stable;
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_TRUE(diagnostics.warnings().empty());
  for (Index v = 0; v < built.body().attributes().vertex_count();
       ++v)  // a stretched body is stiffer
    built.body().attributes().position().set(v, 0,
                                             1.5 * built.body().attributes().position().get(v, 0));
  built.dynamics().start(built.dynamics().time());
  ASSERT_LT(built.limits().stable_step(built.dynamics().time()), *scene.solver.dt);
  cut();
  watch.after_event(100);
  watch.after_step(101);
  EXPECT_TRUE(diagnostics.warnings().empty()) << "searched 101 steps ago";
  for (const std::uint64_t step : {512, 1024, 2048}) {
    watch.after_event(step);
    watch.after_step(step);
  }
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("/solver/dt"), std::string::npos);
}

}  // namespace
}  // namespace suture::test
