// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ledger for bodies of both models: its balance is small, and operations do not change it.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/build/built_scene.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

using Integrator = std::string;
const Integrator integrators[] = {"symplectic-euler", "velocity-verlet"};

Selection named(const char* set) {
  Selection selection;
  selection.what = Selection::Named{set};
  return selection;
}

/// A beam that is bent, pulled and pressed at once.
Scene loaded_beam(const char* model, const Integrator& integrator, Index nx = 8, Index n = 2) {
  Scene scene = beam(host(), model, nx, n, 4);
  scene.gravity_ramp = {0, 0.1, true};
  scene.solver.integrator = integrator;
  Constraint pull;
  pull.where = named("x1");
  pull.moves = true;
  pull.translation = {0.02, 0.01, 0};
  pull.ramp = {0, 0.15, true};
  scene.constraints.push_back(pull);
  Load press;
  press.kind = Load::Kind::pressure;
  press.pressure = 800;
  press.where = named("y1");
  press.ramp = {0, 0.1, true};
  scene.loads.push_back(press);
  Load drag;
  drag.kind = Load::Kind::traction;
  drag.value = {0, 0, 500};
  drag.where = named("z1");
  drag.ramp = {0, 0.1, true};
  scene.loads.push_back(drag);
  return scene;
}

struct Largest {
  double balance = 0, exchanged = 0;
};

/// The largest balance of a run for 0.4 s at this safety.
Largest largest_balance(const Scene& scene, double safety) {
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  Dynamics& dynamics = built.dynamics();
  dynamics.start();
  dynamics.balance();
  const double dt = safety * built.limits().stable_step(0);
  Largest largest;
  for (std::uint64_t i = 1; static_cast<double>(i) * dt < 0.4; ++i) {
    dynamics.step(dt, static_cast<double>(i) * dt);
    if (i % 4 != 0) continue;
    const EnergyBalance b = dynamics.balance();
    largest.balance = std::max(largest.balance, std::abs(b.balance));
    largest.exchanged = b.exchanged;
  }
  return largest;
}

/// The same with a model that has a state, and loses a good part of the energy to it.
Scene loaded_beam_with_state(const std::string& model, const Integrator& integrator) {
  Scene scene = loaded_beam("tm-faure", integrator);
  ModelUse& use = scene.models[0];
  use.name = model;
  use.model = &host().model(model);
  const bool springs = model == "damage-springs";
  use.parameters =
      springs ? parameters(*use.model, {{"E", 4e5}, {"rho", 1000}, {"e0", 0.005}, {"e1", 0.3}})
              : parameters(*use.model, {{"K", 2e5}, {"n", 0.3}, {"lambda", 2e5}, {"rho", 1000}});
  return scene;
}

TEST(Balance, CountsWhatStatesTakeAsDissipated) {
  for (const Integrator& integrator : integrators)
    for (const char* model : {"visco", "damage-springs"}) {
      const Scene scene = loaded_beam_with_state(model, integrator);
      Diagnostics diagnostics;
      BuiltScene built(scene, diagnostics);
      Dynamics& dynamics = built.dynamics();
      dynamics.start();
      dynamics.balance();
      const double dt = 0.4 * built.limits().stable_step(0);
      Largest largest;
      double dissipated = 0, returned = 0;
      for (std::uint64_t i = 1; static_cast<double>(i) * dt < 0.4; ++i) {
        dynamics.step(dt, static_cast<double>(i) * dt);
        if (i % 16 != 0) continue;
        const EnergyBalance b = dynamics.balance();
        largest.balance = std::max(largest.balance, std::abs(b.balance));
        largest.exchanged = b.exchanged;
        returned = std::max(returned, dissipated - b.dissipated);
        dissipated = b.dissipated;
      }
      EXPECT_LT(largest.balance, 1e-3 * largest.exchanged) << model << ", " << integrator;
      EXPECT_LT(returned, 1e-3 * largest.exchanged) << model << ", " << integrator;
      EXPECT_GT(dissipated, 0.05) << "J, " << model;
    }
}

TEST(Balance, IsBelowAThousandthAndFallsWithTheSquareOfTheStep) {
  for (const Integrator& integrator : integrators) {
    const Scene scene = loaded_beam("tm-faure", integrator);
    double last = 0;
    for (const double safety : {0.8, 0.4, 0.2}) {
      const Largest now = largest_balance(scene, safety);
      ASSERT_GT(now.exchanged, 0.1) << "J";
      EXPECT_LT(now.balance, 1e-3 * now.exchanged) << safety;
      if (last > 0) {
        EXPECT_GT(last / now.balance, 3) << safety;
        EXPECT_LT(last / now.balance, 5.5) << safety;
      }
      last = now.balance;
    }
  }
}

TEST(Balance, IsSmallForSpringsAndOtherLaws) {
  for (const Integrator& integrator : integrators) {
    const Largest springs = largest_balance(loaded_beam("mss-baudet", integrator), 0.8);
    EXPECT_LT(springs.balance, 3e-3 * springs.exchanged);
    Scene damped = loaded_beam("tm-faure", integrator);
    damped.solver.damping = 3;
    const Largest mass = largest_balance(damped, 0.8);
    EXPECT_LT(mass.balance, 2e-3 * mass.exchanged);
    Scene viscous = loaded_beam("mss-baudet", integrator);
    viscous.models[0].parameters = parameters(
        *viscous.models[0].model, {{"E", 400e3}, {"nu", 0.3}, {"rho", 1000}, {"viscosity", 5}});
    const Largest dashpots = largest_balance(viscous, 0.5);
    EXPECT_LT(dashpots.balance, 1e-3 * dashpots.exchanged);
  }
}

// ------------------------------------------------------------------ operations --

class Jumps : public testing::TestWithParam<std::tuple<const char*, Integrator>> {
 protected:
  Jumps()
      : scene(loaded_beam(std::get<0>(GetParam()), std::get<1>(GetParam()))),
        built(scene, diagnostics) {
    dynamics().start();
    dynamics().balance();
    dt = 0.5 * built.limits().bounds(0).dt;
    run(0.05);
  }
  Dynamics& dynamics() { return built.dynamics(); }
  void run(double seconds) {
    const double begin = dynamics().time();
    for (int i = 1; i * dt < seconds; ++i) dynamics().step(dt, begin + i * dt);
  }
  /// Faces across x = `where` between elements that are there.
  std::vector<Dart> section(double where) {
    std::vector<Dart> faces;
    for (Dart d = 8; d < 24 * built.body().complex().element_count(); d += 24)
      if (built.body().complex().exists(3, d / 24) && built.body().complex().can_cut(d) &&
          std::abs(built.body().attributes().rest().get(built.body().complex().origin(d), 0) -
                   where) < 1e-9)
        faces.push_back(d);
    return faces;
  }
  template <class Operation>
  void expect_no_jump(Operation operation, bool changes_energy) {
    const EnergyBalance before = dynamics().balance();
    operation();
    const EnergyBalance after = dynamics().balance();
    EXPECT_NEAR(after.balance, before.balance, 1e-10 * after.exchanged);
    const double given = after.kinetic + after.elastic - before.kinetic - before.elastic;
    EXPECT_NEAR(after.events - before.events, given, 1e-10 * after.exchanged);
    if (changes_energy) {
      EXPECT_GT(std::abs(given), 1e-6 * after.exchanged);
    } else {
      EXPECT_EQ(after.events, before.events);
      EXPECT_NEAR(given, 0, 1e-10 * after.exchanged);
    }
    for (const auto line :
         {&EnergyBalance::prescribed, &EnergyBalance::models, &EnergyBalance::dissipated})
      EXPECT_NEAR(after.*line, before.*line, 1e-10 * after.exchanged);
    for (const char* term : {"gravity", "loads", "pressure"})
      EXPECT_NEAR(after.work(term), before.work(term), 1e-10 * after.exchanged) << term;
    run(0.03);
    const EnergyBalance later = dynamics().balance();
    EXPECT_LT(later.balance - before.balance, 5e-3 * later.exchanged) << "it goes on rightly";
    // A jolt leaves the remainder of the trapezoid, h^2/8 sum F^2/m, as it relaxes.
    EXPECT_GT(later.balance - before.balance, (changes_energy ? -0.1 : -5e-3) * later.exchanged);
  }
  Scene scene;
  Diagnostics diagnostics;
  BuiltScene built;
  double dt = 0;
};
INSTANTIATE_TEST_SUITE_P(Both, Jumps,
                         testing::Combine(testing::Values("tm-faure", "mss-baudet"),
                                          testing::ValuesIn(integrators)),
                         [](const auto& both) {
                           return std::string(std::get<0>(both.param), 2) +
                                  (std::get<1>(both.param) == "velocity-verlet" ? "verlet"
                                                                                : "euler");
                         });

TEST_P(Jumps, ACutTakesNoEnergy) {
  const std::vector<Dart> faces = section(0.5);
  ASSERT_EQ(faces.size(), 4u);
  expect_no_jump([&] { built.body().cut({faces.begin(), faces.begin() + 2}); }, false);
  expect_no_jump([&] { built.body().cut({faces.begin() + 2, faces.end()}); }, false);
}

TEST_P(Jumps, ACutThroughADrivenSideTakesNoEnergy) {
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * built.body().complex().element_count(); d += 4)
    if (d % 24 == 12 && built.body().complex().can_cut(d)) faces.push_back(d);  // y1 sides
  ASSERT_EQ(faces.size(), 16u);
  expect_no_jump([&] { built.body().cut(faces); }, false);
}

TEST_P(Jumps, WhatElementsTakeAwayIsBooked) {
  expect_no_jump([&] { built.body().pierce({3, 11}); }, true);
  expect_no_jump([&] { built.body().pierce({7}); }, true);  // held by the motion of x1, and loaded
}

TEST_P(Jumps, WhatSewingTakesIsBooked) {
  const std::vector<Dart> faces = section(0.5);
  std::vector<Seam> seams;
  for (const Dart d : faces) seams.push_back({d, built.body().complex().beta3(d)});
  built.body().cut(faces);
  run(0.05);
  expect_no_jump([&] { built.body().sew(seams); }, true);
}

TEST_P(Jumps, APushOfTheBodyIsBooked) {
  std::vector<Vec3> shape(built.body().attributes().vertex_count());
  for (Index v = 0; v < built.body().attributes().vertex_count(); ++v) {
    const double x = built.body().attributes().rest().get(v, 0);
    if (x > 1e-9 && x < 1 - 1e-9) shape[v] = {0, 0, 1};
  }
  Column& x = built.body().attributes().position();
  const auto push = [&] {
    for (Index v = 0; v < shape.size(); ++v)
      for (int c = 0; c < 3; ++c)
        x.set(v, c, x.get(v, c) + 5e-3 * shape[v][static_cast<std::size_t>(c)]);
  };
  expect_no_jump([&] { dynamics().jump(push); }, true);
}

}  // namespace
}  // namespace suture::test
