// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parameters and gravity that a program changes while the run goes on, and states in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "kernel/base/error.hpp"
#include "kernel/forces/gravity.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/contact_scenes.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;

struct ChangedRun {
  explicit ChangedRun(const Scene& scene) : simulation(scene, host(), diagnostics) {}
  void steps(std::uint64_t count) { simulation.advance({{}, count}, nobody); }
  void cut() {
    simulation.apply(
        read_event(R"({"cut": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}})", "cut",
                   simulation.built().scene(), diagnostics),
        nobody);
  }
  Instance& instance() { return *simulation.attributes().instances()[0]; }
  void set(const char* text) {
    simulation.set_parameters(instance(), read_parameters(text, "parameters", instance().model(),
                                                          instance().parameters()));
  }
  std::vector<double> masses() {
    const Column& mass = simulation.attributes().mass();
    return {mass.rows(), mass.rows() + mass.size()};
  }
  std::vector<double> positions() { return position_rows(simulation); }

  Diagnostics diagnostics;
  Simulation simulation;
  Observer nobody;
};

Scene sagging(const char* model, std::map<std::string, double> values = {}) {
  values.try_emplace("E", 4e5);
  Scene scene = beam(host(), model, 10, 3, 9.8, values);
  scene.solver.end = 10;
  scene.solver.threads = 1;
  return scene;
}

TEST(Changes, GiveTheSumsOfAnotherScene) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    ChangedRun changed(sagging(model)), other(sagging(model, {{"E", 9e5}, {"rho", 700}}));
    changed.steps(10);
    const double before = changed.simulation.next_dt();
    changed.cut();
    changed.set(R"({"E": 9e5, "rho": 700})");
    other.cut();
    EXPECT_THAT(changed.masses(), testing::Pointwise(testing::DoubleNear(1e-12), other.masses()));
    EXPECT_NEAR(changed.simulation.next_dt() / before, std::sqrt(4e5 / 9e5 * 0.7), 0.05) << model;
  }
}

TEST(Changes, AreLoadedWithTheState) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    ChangedRun first(sagging(model)), second(sagging(model));
    first.steps(10);
    first.set(R"({"E": 9e5, "rho": 700})");
    first.simulation.set_gravity({0, 0, -3});
    first.cut();
    first.steps(5);
    second.simulation.load(first.simulation.save());
    EXPECT_EQ(second.simulation.built().gravity().value(), (Vec3{0, 0, -3}));
    for (int i = 0; i < 3; ++i) {
      first.steps(10);
      second.steps(10);
      EXPECT_EQ(first.positions(), second.positions()) << model;
    }
  }
}

TEST(Changes, ThatFailLeaveNoTrace) {
  ChangedRun refused(sagging("tm-faure")), plain(sagging("tm-faure"));
  refused.steps(10);
  plain.steps(10);
  const auto message = [&](const char* text) -> std::string {
    try {
      refused.set(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(R"({"element": "mean-gradient"})"), HasSubstr("when a scene is built"));
  EXPECT_THAT(message(R"({"E": 0})"), HasSubstr("/E: must be > 0 Pa"));
  EXPECT_THAT(message(R"({"e": 1})"), HasSubstr("did you mean"));
  EXPECT_THROW(refused.simulation.set_gravity({0, std::nan(""), 0}), InputError);
  refused.steps(10);
  plain.steps(10);
  EXPECT_EQ(refused.positions(), plain.positions());
}

/// With a model that fails at the new values, in the evaluation of the forces.
TEST(Changes, ThatTheForcesRefuseAreTakenBack) {
  ChangedRun run(sagging("tm-faure"));
  run.steps(10);
  const std::vector<double> before(run.instance().parameters().begin(),
                                   run.instance().parameters().end());
  EXPECT_THROW(run.set(R"({"E": 1.7e308, "nu": 0.499})"), Error);
  EXPECT_EQ(before, std::vector<double>(run.instance().parameters().begin(),
                                        run.instance().parameters().end()));
  run.steps(10);
}

}  // namespace
}  // namespace suture::test
