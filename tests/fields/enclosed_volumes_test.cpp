// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes of whole bodies and of cavities.
#include "kernel/forces/enclosed_volumes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

constexpr double kappa = 5e3;
const std::string block = R"({"box": {"size": [1, 1, 1], "cells": [4, 4, 4]}})";
const std::string everywhere = R"({"volume": 5e3, "where": "all"})";

/// An elastic block with E = 1000 Pa, nu = 0.
Scene solid(const std::string& mesh, const std::string& loads, const std::string& more,
            const std::string& solver = R"("static": {"frames": 1}, "end": 1)") {
  return field_scene(R"("mesh": )" + mesh +
                     R"(, "models": [{"model": "tm-faure", "parameters": {"E":
      1000, "nu": 0, "rho": 1}}], "loads": [)" +
                     loads + R"(], "solver": {)" + solver + "}, " + more);
}

/// What the term of volumes does in a body.
class Volumes {
 public:
  explicit Volumes(FieldRun& run) : body_(run.simulation.built().body()) {
    for (const auto& term : body_.terms())
      if (auto* found = dynamic_cast<EnclosedVolumes*>(term.get())) volumes_ = found;
  }
  std::vector<double> forces() {
    const Index count = body_.attributes().vertex_count();
    AlignedVector<double> rows(std::size_t{count} * 4);
    volumes_->add_forces(0, body_.attributes().kernel(0).cells.live(), rows.data());
    std::vector<double> forces;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (i % 4 < 3) forces.push_back(rows[i]);
    return forces;
  }
  std::vector<double> tangent(const std::vector<double>& way) {
    std::vector<double> out(way.size());
    volumes_->add_tangent(way.data(), 1, 0, 0, out.data());
    volumes_->add_skew_tangent(way.data(), 1, 0, out.data());
    return out;
  }
  void move(const std::vector<double>& way, double step) {
    for (std::size_t i = 0; i < way.size(); ++i) {
      Column& x = body_.attributes().position();
      const auto v = static_cast<Index>(i / 3);
      x.set(v, int(i % 3), x.get(v, int(i % 3)) + step * way[i]);
    }
  }
  /// Makes what `belongs` larger by this factor; sum x . f there, which is -3 V p.
  template <class Belongs>
  double virial_of(double factor, Belongs belongs) {
    Attributes& attributes = body_.attributes();
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        attributes.position().set(v, c, attributes.rest().get(v, c) * (belongs(v) ? factor : 1));
    const std::vector<double> f = forces();
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i)
      sum += f[i] * attributes.position().get(static_cast<Index>(i / 3), int(i % 3));
    return sum;
  }

 private:
  Body& body_;
  EnclosedVolumes* volumes_ = nullptr;
};

TEST(EnclosedVolumes, AreABulkModulusOfTheWholeBody) {
  // Pulled along x: tr sigma = 3 (K + kappa) e = t, and the shear modulus is E / 2.
  constexpr double t = 0.01, modulus = 1000;
  FieldRun run(solid(block, everywhere + R"(, {"traction": [0.01, 0, 0], "where": {"set": "x1"}})",
                     R"("constraints": [{"fix": "x", "where": {"set": "x0"}}, {"fix": "y", "where":
      {"set": "y0"}}, {"fix": "z", "where": {"set": "z0"}}])"));
  run.run_to(1);
  const double e = t / (3 * (modulus / 3 + kappa));
  Selection corner;
  corner.what = Selection::Nearest{Vec3{1, 1, 1}};
  const auto u = run.simulation.mean_displacement(corner);
  EXPECT_NEAR(u[0] / (e / 3 + 2 * t / (3 * modulus)), 1, 1e-4);
  EXPECT_NEAR(u[1] / (e / 3 - t / (3 * modulus)), 1, 1e-4);
}

TEST(EnclosedVolumes, HaveTheDerivativeOfTheirForces) {
  FieldRun run(solid(block, everywhere, R"("title": "")",
                     R"("integrator": "symplectic-euler", "dt": 1e-4, "end": 1)"));
  Volumes volumes(run);
  const std::size_t size = std::size_t{run.simulation.attributes().vertex_count()} * 3;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> between(-1, 1);
  std::vector<double> way(size), start(size);
  for (std::size_t i = 0; i < size; ++i) way[i] = between(random), start[i] = between(random);
  volumes.move(start, 0.03);
  const std::vector<double> expected = volumes.tangent(way);
  volumes.move(way, 1e-5);
  const std::vector<double> ahead = volumes.forces();
  volumes.move(way, -2e-5);
  const std::vector<double> back = volumes.forces();
  double largest = 0;
  for (const double x : expected) largest = std::max(largest, std::abs(x));
  for (std::size_t i = 0; i < size; ++i)
    EXPECT_NEAR((ahead[i] - back[i]) / 2e-5, expected[i], 1e-6 * largest);
}

TEST(EnclosedVolumes, AreKeptByEachPieceOfACutBody) {
  FieldRun run(solid(block, everywhere, R"("events": [{"at": 0, "cut": {"plane": {"point": [0.5, 0,
      0], "normal": [1, 0, 0]}}}])",
                     R"("integrator": "symplectic-euler", "dt": 1e-4, "end": 1)"));
  run.run_to(2e-4);
  Volumes volumes(run);
  const Body& body = run.simulation.built().body();
  const auto is_left = [&](Index v) {
    return body.complex().exists(0, v) && element_of(body.complex().dart_of(0, v)) % 4 < 2;
  };
  const double larger = 1.1 * 1.1 * 1.1;
  EXPECT_NEAR(volumes.virial_of(1.1, is_left), -3 * (larger * 0.5) * kappa * (larger - 1), 1e-8);
}

// A block of 3 x 3 x 3 elements without the one inside.
TEST(EnclosedVolumes, OfACavityGoWhenACutOpensIt) {
  Scene scene = solid(R"({"box": {"size": [1, 1, 1], "cells": [3, 3, 3]}})", R"({"volume": 5e3,
      "where": {"box": {"min": [0.3, 0.3, 0.3], "max": [0.7, 0.7, 0.7]}}})",
                      R"("events": [{"at": 3e-4, "cut": {"plane": {"point": [0.5, 0, 0], "normal":
      [1, 0.01, 0]}}}])",
                      R"("integrator": "symplectic-euler", "dt": 1e-4, "end": 1)");
  Mesh hollow = make_box(*scene.mesh.box);
  hollow.hexahedra.erase(hollow.hexahedra.begin() + 13);
  scene.mesh.box.reset();
  scene.mesh.given = std::make_shared<const Mesh>(std::move(hollow));
  FieldRun run(scene);
  const auto all = [](Index) { return true; };
  const double smaller = 0.9 * 0.9 * 0.9;
  // The volume is minus that of the cavity, whose pressure rises.
  EXPECT_NEAR(Volumes(run).virial_of(0.9, all), 3 * (smaller / 27) * kappa * (1 - smaller), 1e-8);
  Volumes(run).virial_of(1, all);
  run.run_to(5e-4);
  EXPECT_EQ(Volumes(run).virial_of(0.9, all), 0);
}

struct Refused {
  const char *load, *more, *solver, *message;
};

TEST(EnclosedVolumes, AreRefusedWhereTheyCannotBeKept) {
  const char *all = R"({"volume": 5e3, "where": "all"})", *whole = R"("title": "")",
             *still = R"("static": {"frames": 1}, "end": 1)";
  for (const Refused& scene :
       {Refused{R"({"volume": 5e3, "where": {"set": "x1"}})", whole, still,
                "/loads/0/where: the faces of a \"volume\" must enclose it, but only 16 of the 96"},
        Refused{all, R"("divisible": true)", still,
                "/loads/0/where: a \"volume\" needs whole faces of elements"},
        Refused{all, whole, R"("integrator": "xpbd", "dt": 1e-3, "end": 1)",
                "/loads/0/where: \"xpbd\" knows stiffness of models only"}}) {
    try {
      FieldRun run(solid(block, scene.load, scene.more, scene.solver));
      ADD_FAILURE() << scene.message;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(scene.message));
    }
  }
}

// The work of a volume that comes slowly is not the change of its energy.
TEST(EnclosedVolumes, AreInTheBalance) {
  Scene scene = solid(
      block,
      R"({"volume": 5e3, "where": "all", "ramp": 0.1}, {"traction": [20, 0, 0], "where": {"set": "x1"},
      "ramp": 0.05})",
      R"("constraints": [{"fix": "xyz", "where": {"set": "x0"}}])",
      R"("integrator": "velocity-verlet", "dt": 2e-4, "end": 0.2)");
  FieldRun run(scene);
  run.run_to(0.2);
  const EnergyBalance balance = run.simulation.built().dynamics().balance();
  EXPECT_LT(std::abs(balance.work("volume")), balance.work("loads"));
  EXPECT_GT(std::abs(balance.work("volume")), 1e-3 * balance.work("loads"));
  EXPECT_LT(std::abs(balance.balance), 1e-2 * std::abs(balance.work("volume")));
}

}  // namespace
}  // namespace suture::test
