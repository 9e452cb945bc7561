// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/guard.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/results/evidence.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

/// A beam of two models, one on either half.
Scene two_halves(OnInversion left, OnInversion right, OnInversion solver = OnInversion::by_model) {
  Scene scene = beam(host(), "tm-faure", 8, 2, 0);
  scene.models.push_back(scene.models[0]);
  scene.models[0].region.what = Selection::InBox{{0, 0, 0}, {0.5, 1, 1}};
  scene.models[1].region.what = Selection::InBox{{0.5, 0, 0}, {1, 1, 1}};
  scene.models[0].name = "left";
  scene.models[1].name = "right";
  scene.models[0].on_inversion = left;
  scene.models[1].on_inversion = right;
  scene.solver.on_inversion = solver;
  return scene;
}

/// What a guard says after the corner of an end was pushed through its element.
struct Look {
  Look(const Scene& scene, double x) : built(scene, diagnostics) {
    built.dynamics().start();
    Guard guard(built, diagnostics);
    guard.start();
    built.dynamics().jump([&] { push(x); });
    try {
      guard.check(5, 0.25);
    } catch (const NumericalError& error) {
      stopped = error.what();
    }
    inverted = guard.inverted_elements();
  }
  void push(double x) {
    Attributes& attributes = built.body().attributes();
    for (Index v = 0; v < attributes.vertex_count(); ++v) {
      const Column& rest = attributes.rest();
      if (std::abs(rest.get(v, 0) - x) > 1e-9 || rest.get(v, 1) > 1e-9 || rest.get(v, 2) > 1e-9)
        continue;
      attributes.position().set(v, 0, x < 0.5 ? x + 0.2 : x - 0.2);
    }
  }
  Diagnostics diagnostics;
  BuiltScene built;
  std::string stopped;
  std::uint64_t inverted = 0;
};

TEST(OnInversion, IsThatOfTheModelBeforeThatOfTheSolver) {
  const Scene scene = two_halves(OnInversion::warn, OnInversion::by_model, OnInversion::stop);
  const Look left(scene, 0), right(scene, 1);
  EXPECT_EQ(left.stopped, "");
  ASSERT_EQ(left.diagnostics.warnings().size(), 1u);
  EXPECT_NE(left.diagnostics.warnings()[0].find("inverted"), std::string::npos);
  EXPECT_EQ(left.inverted, 1u);
  EXPECT_NE(right.stopped.find("inverted"), std::string::npos);
  EXPECT_NE(right.stopped.find("element 7"), std::string::npos) << right.stopped;
  EXPECT_NE(right.stopped.find("(0.9375, 0.0625, 0.0625) m"), std::string::npos) << right.stopped;
  const Scene other = two_halves(OnInversion::stop, OnInversion::by_model, OnInversion::warn);
  EXPECT_NE(Look(other, 0).stopped, "");
  EXPECT_EQ(Look(other, 1).stopped, "");
}

TEST(OnInversion, IsTheModelsOwnWhereTheSceneSaysNothing) {
  constexpr auto own = OnInversion::by_model;
  EXPECT_NE(Look(two_halves(own, own), 0).stopped, "") << "a solid stops";
  Scene springs = beam(host(), "mss-baudet", 8, 2, 0);
  const Look look(springs, 0);
  EXPECT_EQ(look.stopped, "") << "springs bear it";
  EXPECT_NE(look.diagnostics.warnings().back().find("the run continues"), std::string::npos);
}

TEST(Guard, FindsEnergiesThatAreNotFinite) {
  const Scene scene = beam(host(), "tm-faure", 2, 1, 0);
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  built.dynamics().start();
  Guard guard(built, diagnostics);
  guard.start();
  guard.check(1, 0);
  built.body().attributes().velocity().set(2, 0, 1e200);
  EXPECT_THROW(guard.check(2, 0), NotFinite);
}

TEST(Guard, CountsGrowthFromWhatWasForgiven) {
  const Scene scene = beam(host(), "tm-faure", 4, 1, 9.8);
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  built.dynamics().start();
  Guard guard(built, diagnostics);
  guard.start();
  const double dt = 0.5 * built.limits().stable_step(built.dynamics().time());
  double time = 0;
  const auto run = [&](int steps) {
    for (int i = 0; i < steps; ++i) built.dynamics().step(dt, time += dt);
    guard.check(static_cast<std::uint64_t>(time / dt), time);
  };
  run(50);
  EXPECT_LT(guard.growth(), 1e-3);
  Column& v = built.body().attributes().velocity();  // energy from nowhere
  for (Index i = 0; i < v.size(); ++i) v.set(i, 1, 1.5 * v.get(i, 1));
  run(2);
  const double grown = guard.growth();
  EXPECT_GT(grown, 0.1);
  guard.forgive_growth();
  EXPECT_EQ(guard.growth(), 0);
  for (Index i = 0; i < v.size(); ++i) v.set(i, 1, 0.5 * v.get(i, 1));
  run(2);
  EXPECT_EQ(guard.growth(), 0) << "energy that is lost is no growth";
}

// Evidence: both states with marks on the elements that failed.
TEST(Evidence, ShowsTheLastGoodAndTheFailedStateWithMarks) {
  const TemporaryFolder folder;
  const Scene scene = beam(host(), "tm-faure", 4, 1, 0);
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  built.dynamics().start();
  Column& x = built.body().attributes().position();
  const std::vector<double> rows(x.rows(), x.rows() + std::size_t{x.size()} * 4);
  const Hexahedron& first = built.body().complex().vertices_of(0);
  const Hexahedron& last = built.body().complex().vertices_of(3);
  x.set(first[0], 0, 0.4);  // inverted
  x.set(last[7], 1, std::nan(""));
  Evidence evidence(built, 0.5);
  std::copy(rows.begin(), rows.end(), x.rows());
  evidence.add_last_good(built, 0.25);
  const std::string text = evidence.write(std::make_shared<OutputFolder>(folder / "out"));
  EXPECT_NE(text.find("failed.pvd contains the last good state and this one"), std::string::npos)
      << text;
  const std::string pvd = read_text(folder / "out/failed.pvd");
  EXPECT_NE(pvd.find("timestep=\"0.25\""), std::string::npos) << pvd;
  EXPECT_NE(pvd.find("timestep=\"0.5\""), std::string::npos) << pvd;
  EXPECT_NE(pvd.find("failed_0001.vtu"), std::string::npos) << pvd;
}

}  // namespace
}  // namespace suture::test
