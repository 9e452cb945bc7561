// SPDX-License-Identifier: GPL-3.0-or-later
//
// Models with a state whose force depends on dt, in implicit steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernel/base/aligned.hpp"
#include "kernel/build/built_scene.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test::history_test {
namespace {

constexpr double tau = 0.1;

Scene relaxing_beam(const char* integrator) {
  Scene scene = beam(host(), "tm-faure", 4, 2, 2.45);
  ModelUse use;
  use.name = "maxwell";
  use.model = &host().model("maxwell");
  use.parameters = parameters(*use.model, {{"k", 100}, {"tau", tau}});
  scene.models.push_back(use);
  scene.solver.integrator = integrator;
  scene.solver.dt = tau;
  scene.solver.end = 1;
  scene.solver.step_tolerance = 1e-10;
  return scene;
}

/// The same of a law with a state.
Scene viscous_beam() {
  Scene scene = relaxing_beam("static");
  ModelUse& use = scene.models[0];
  scene.models.pop_back();
  use.name = "visco";
  use.model = &host().model("visco");
  use.parameters = parameters(
      *use.model, {{"K", 1e5}, {"n", 0.3}, {"lambda", 2e5}, {"rho", 1000}, {"tau", tau}});
  return scene;
}

class History : public testing::Test {
 protected:
  explicit History(const Scene& beam = relaxing_beam("static"))
      : scene(beam), built(scene, diagnostics) {
    built.dynamics().start();
  }
  Attributes& attributes() { return built.body().attributes(); }
  std::size_t size() { return std::size_t{attributes().vertex_count()} * 3; }
  /// Forces of the models in a step of length dt, with all positions moved by h d.
  std::vector<double> forces(double dt, const std::vector<double>& d, double h) {
    Column& x = attributes().position();
    const auto move = [&](double by) {
      for (std::size_t i = 0; i < d.size(); ++i) x.rows()[i / 3 * 4 + i % 3] += by * d[i];
    };
    AlignedVector<double> rows(size() / 3 * 4, 0.0);
    move(h);
    built.body().models().add_forces(0, dt, ForceLoop::Part::all, rows.data());
    move(-h);
    std::vector<double> result(d.size());
    for (std::size_t i = 0; i < d.size(); ++i) result[i] = rows[i / 3 * 4 + i % 3];
    return result;
  }
  std::vector<double> some_direction() {
    std::vector<double> d(size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(1.0 + 2.0 * static_cast<double>(i));
    return d;
  }
  /// (f(x + h d) - f(x - h d)) / 2h
  std::vector<double> difference(double dt, const std::vector<double>& d) {
    constexpr double h = 1e-6;
    std::vector<double> slope = forces(dt, d, h);
    const std::vector<double> before = forces(dt, d, -h);
    for (std::size_t i = 0; i < d.size(); ++i) slope[i] = (slope[i] - before[i]) / (2 * h);
    return slope;
  }
  void expect_tangents_of_the_step();
  void expect_equilibria();

  Scene scene;
  Diagnostics diagnostics;
  BuiltScene built;
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
    scale = std::max(scale, std::abs(b[i]));
  }
  return largest / scale;
}

void History::expect_tangents_of_the_step() {
  const std::vector<double> d = some_direction();
  EXPECT_GT(largest_difference(difference(0, d), difference(tau, d)), 1e-4) << "dt matters";
  for (const double dt : {0.0, tau}) {
    const std::vector<double> slope = difference(dt, d);
    std::vector<double> product(size());
    built.body().models().add_tangent(d.data(), 1, 0, {0, dt}, product.data());
    EXPECT_LT(largest_difference(product, slope), 1e-7) << dt;
    std::vector<double> assembled(size());
    built.body().models().for_each_tangent(1, 0, {0, dt}, [&](const CellTangents& t) {
      const Index n = 3 * t.nodes;
      for (Index cell = 0; cell < t.cells; ++cell)
        for (Index i = 0; i < n * n; ++i) {
          const auto at = [&](Index k) {
            return std::size_t{t.vertices[cell * t.nodes + k / 3]} * 3 + k % 3;
          };
          assembled[at(i % n)] += t.values[std::size_t{i} * 8 + cell] * d[at(i / n)];
        }
    });
    EXPECT_LT(largest_difference(assembled, slope), 1e-7) << dt;
  }
}

TEST_F(History, TangentsAreThoseOfTheStep) { expect_tangents_of_the_step(); }

// A step that evaluated the forces at its end with dt once more would relax them twice.
void History::expect_equilibria() {
  double unbalanced = 0, weight = 0;
  for (int step = 1; step <= 3; ++step) built.dynamics().step(tau, tau * step);
  built.dynamics().synchronise();
  for (Index v = 0; v < attributes().vertex_count(); ++v) {
    const double own = 2.45 * attributes().mass().get(v, 0);
    weight = std::max(weight, own);
    if (attributes().fixed().get(v, 0) == 0)
      unbalanced = std::max(unbalanced, std::abs(attributes().force().get(v, 1) - own));
  }
  EXPECT_LT(unbalanced, 1e-6 * weight);
}

TEST_F(History, AnEquilibriumIsOneAfterTheStatesAreAccepted) { expect_equilibria(); }

class ViscousHistory : public History {
 protected:
  ViscousHistory() : History(viscous_beam()) {}
};

TEST_F(ViscousHistory, TangentsAreThoseOfTheStep) { expect_tangents_of_the_step(); }
TEST_F(ViscousHistory, AnEquilibriumIsOneAfterTheStatesAreAccepted) { expect_equilibria(); }

class NewmarkHistory : public History {
 protected:
  NewmarkHistory() : History(relaxing_beam("newmark")) {}
  double acceleration(Index v) {
    return attributes().force().get(v, 1) / attributes().mass().get(v, 0) - 2.45;
  }
};

// v' = v + h (a + a') / 2
TEST_F(NewmarkHistory, TheNextStepBeginsWithTheAccelerationThatThisOneEndedWith) {
  const Index tip = attributes().vertex_count() - 1;
  built.dynamics().step(tau, tau);
  built.dynamics().synchronise();
  const double a = acceleration(tip), v = attributes().velocity().get(tip, 1);
  built.dynamics().step(tau / 4, 1.25 * tau);
  built.dynamics().synchronise();
  const double change = tau / 4 * (a + acceleration(tip)) / 2;
  EXPECT_NEAR(attributes().velocity().get(tip, 1) - v, change, 1e-6 * std::abs(change));
}

// The state is that of the end of each step: the beam creeps as it does in solved steps.
TEST_F(History, PositionBasedStepsCreepAlike) {
  const auto tip_after = [](const char* integrator, double end) {
    Scene creeping = viscous_beam();
    creeping.solver.integrator = integrator;
    creeping.solver.dt = 1e-3;
    creeping.solver.end = end;
    creeping.solver.damping = 20;
    TestSimulation simulation(creeping);
    simulation.run();
    const Column &x = simulation.attributes().position(), &rest = simulation.attributes().rest();
    double lowest = 0;
    for (Index v = 0; v < simulation.attributes().vertex_count(); ++v)
      lowest = std::min(lowest, x.get(v, 1) - rest.get(v, 1));
    return lowest;
  };
  const double solved = tip_after("implicit-euler", 1);
  EXPECT_NEAR(tip_after("xpbd", 1), solved, 0.01 * std::abs(solved));
  EXPECT_LT(solved, 1.1 * tip_after("implicit-euler", 0.5)) << "it creeps";
}

}  // namespace
}  // namespace suture::test::history_test
