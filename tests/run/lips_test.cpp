// SPDX-License-Identifier: GPL-3.0-or-later
//
// Models between two regions beside closed forms: glue that breaks, ties, sliding faces.
#include "kernel/attributes/lips.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/run/equilibrium.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

using Eigen::Vector3d;
using Values = std::map<std::string, double>;

// A bar along x of two halves.
constexpr double length = 0.1, side = 0.02, area = side * side, young = 1e6;

Selection half(double sign) {
  Selection selection;
  selection.what = Selection::HalfSpace{{length / 2, 0, 0}, {sign, 0, 0}};
  return selection;
}

/// The halves of a bar without contraction, and what is between them.
Scene halves(const std::string& model, const Values& values, double E = young) {
  Scene scene =
      block(host(), "hooke", {length, side, side}, {4, 2, 2}, {{"E", E}, {"nu", 0}, {"rho", 1000}});
  ModelUse use;
  use.name = model;
  use.model = &host().model(model);
  use.parameters = parameters(*use.model, values);
  use.between = {half(-1), half(1)};
  scene.models.push_back(use);
  scene.solver.step_tolerance = 1e-9;
  return scene;
}

const Selection left = at({0, any, any}), right = at({length, any, any});

struct Glue {
  double stiffness = 1e9, strength = 1e4, toughness = 20, shear_strength = 6e3,
         shear_toughness = 30, mixing = 1.7;
  Values values() const {
    return {{"stiffness", stiffness},
            {"strength", strength},
            {"toughness", toughness},
            {"shear_strength", shear_strength},
            {"shear_toughness", shear_toughness},
            {"mixing", mixing}};
  }
  /// Traction over separation along a direction at this angle to the normal: a triangle.
  struct Triangle {
    double begin, end, top;
    double operator()(double l) const {
      if (l < begin) return top * l / begin;
      return std::max(0.0, top * (end - l) / (end - begin));
    }
  };
  Triangle at_angle(double angle) const {
    const double B = std::pow(std::sin(angle), 2 * mixing), a = strength / stiffness,
                 b = shear_strength / stiffness, begin = std::sqrt(a * a + (b * b - a * a) * B),
                 G = toughness + (shear_toughness - toughness) * B;
    return {begin, 2 * G / (stiffness * begin), stiffness * begin};
  }
};

TEST(ClosedFormsBetweenRegions, GluedBarSoftensAndTakesTheToughness) {
  const Glue glue;
  Scene scene = halves("cohesive", glue.values());
  constexpr double pulled = 6e-3;
  hold(scene, left, 7);
  hold(scene, right, 7, {pulled, 0, 0});
  Equilibrium bar(scene, 0);
  const Glue::Triangle law = glue.at_angle(0);
  constexpr int steps = 100;
  double work = 0, before = 0, largest = 0;
  for (int i = 1; i <= steps; ++i) {
    bar.proceed(static_cast<double>(i) / steps);
    const double stress = bar.reaction(right)[0] / area, at = pulled * i / steps;
    // In series: U = s L / E + l(s).
    double low = 0, high = at;
    for (int k = 0; k < 60; ++k) {
      const double l = (low + high) / 2;
      (law(l) * length / young + l < at ? low : high) = l;
    }
    EXPECT_NEAR(stress, law(low), 0.01 * glue.strength) << at;
    work += (stress + before) / 2 * pulled / steps * area;
    before = stress;
    largest = std::max(largest, stress);
  }
  EXPECT_NEAR(largest, glue.strength, 0.02 * glue.strength);
  EXPECT_NEAR(work, glue.toughness * area, 0.01 * glue.toughness * area);
  EXPECT_LT(std::abs(before), 1e-6 * glue.strength);
}

// Rigid halves, so that the jump is what they are moved by.
TEST(ClosedFormsBetweenRegions, GlueHasTheTrianglesOfMixedModes) {
  const Glue glue;
  for (const double degrees : {0.0, 30.0, 60.0, 90.0}) {
    const double angle = degrees * M_PI / 180;
    const Glue::Triangle law = glue.at_angle(angle);
    const double moved = 1.1 * law.end;
    Scene scene = halves("cohesive", glue.values(), 1e12);
    hold(scene, left, 7);
    hold(scene, right, 7, {moved * std::cos(angle), moved * std::sin(angle), 0});
    Equilibrium bar(scene, 0);
    for (int i = 1; i <= 12; ++i) {
      bar.proceed(i / 12.0);
      const Vector3d pull = bar.reaction(right) / area;
      const double expected = law(moved * i / 12);
      EXPECT_NEAR(pull[0], expected * std::cos(angle), 2e-3 * law.top) << degrees << ", " << i;
      EXPECT_NEAR(pull[1], expected * std::sin(angle), 2e-3 * law.top) << degrees << ", " << i;
    }
  }
}

TEST(ClosedFormsBetweenRegions, GlueThatBreaksInFlightDissipatesItsToughness) {
  const Glue glue{.toughness = 5};
  Scene scene = halves("cohesive", glue.values());
  scene.solver.integrator = "velocity-verlet";
  scene.solver.threads = 1;
  hold(scene, left, 7);
  hold(scene, right, 7, {4e-3, 0, 0});
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  Dynamics& dynamics = built.dynamics();
  dynamics.start();
  dynamics.balance();
  const double dt = 0.5 * built.limits().stable_step(0);
  for (std::uint64_t i = 1; static_cast<double>(i) * dt < 1; ++i)
    dynamics.step(dt, static_cast<double>(i) * dt);
  const EnergyBalance b = dynamics.balance();
  EXPECT_NEAR(b.dissipated, glue.toughness * area, 0.02 * glue.toughness * area);
  EXPECT_LT(std::abs(b.balance), 1e-3 * b.exchanged);
}

// The piece at the end is held by the tie alone.
TEST(ClosedFormsBetweenRegions, TiedBarIsLongerByTheComplianceOfTheTie) {
  constexpr double stiffness = 1e8, stress = 1e3;
  Scene scene = halves("tie", {{"stiffness", stiffness}});
  hold(scene, left, 7);
  load(scene, right, {stress, 0, 0});
  const double expected = stress * length / young + stress / stiffness;
  EXPECT_NEAR(Equilibrium(scene).displacement(right)[0], expected, 1e-6 * expected);
}

// A stiff tie joins what was one, for the solvers too: a cantilever bends as without it.
TEST(ClosedFormsBetweenRegions, StiffTieBendsAsTheWholeBar) {
  Scene scene = halves("tie", {{"stiffness", 1e4 * young / side}});
  hold(scene, left, 7);
  load(scene, right, {0, 20, 0});
  const double tied = Equilibrium(scene).displacement(right)[1];
  scene.models.pop_back();
  const double whole = Equilibrium(scene).displacement(right)[1];
  EXPECT_NEAR(tied, whole, 1e-3 * whole);
}

TEST(ClosedFormsBetweenRegions, SlidingFacesHoldTheNormalAlone) {
  constexpr double stiffness = 1e9, pulled = 1e-4, slid = 4e-5;
  Scene scene = halves("tie", {{"stiffness", stiffness}, {"slides", 1}});
  hold(scene, left, 7);
  hold(scene, right, 7, {pulled, slid, 0});
  Equilibrium bar(scene, 4);
  const double stress = pulled / (length / young + 1 / stiffness);
  const Vector3d pull = bar.reaction(right) / area;
  EXPECT_NEAR(pull[0], stress, 1e-3 * stress);
  EXPECT_LT(std::abs(pull[1]), 0.05 * young / 2 * slid / length);  // of what a tie transmits
}

TEST(ClosedFormsBetweenRegions, CutsBesideLipsAndSewnLipsAreFollowed) {
  Scene scene = halves("tie", {{"stiffness", 1e9}});
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  Body& body = built.body();
  const auto& lips = body.attributes().instances()[1]->lips;
  ASSERT_EQ(lips.size(), 4u);
  // The right half moves by 1 mm: energy k/2 u^2 on what is held of the area.
  const auto energy = [&] {
    Column &x = body.attributes().position(), &X = body.attributes().rest();
    std::vector<bool> is_right(x.size());
    for (const Index e : built.selector().elements(half(1)))
      for (const Index v : body.complex().vertices_of(e)) is_right[v] = true;
    for (Index v = 0; v < x.size(); ++v) x.set(v, 0, X.get(v, 0) + (is_right[v] ? 1e-3 : 0));
    return body.energy(0) / (1e9 / 2 * 1e-6 * area);
  };
  EXPECT_NEAR(energy(), 1, 1e-9);
  // A cut across all lips.
  std::vector<Dart> faces;
  const CellComplex& complex = body.complex();
  for (Index e = 0; e < complex.element_count(); ++e)
    for (const Dart d : sides_of(e))
      if (complex.beta3(d) > d && complex.can_cut(d)) faces.push_back(d);
  body.cut(faces);
  EXPECT_NEAR(energy(), 1, 1e-9);
  body.pierce({element_of(lips[1].other)});
  EXPECT_NEAR(energy(), 0.75, 1e-9);
  const Column& X = body.attributes().rest();
  for (Index v = 0; v < X.size(); ++v)
    for (int c = 0; c < 3; ++c) body.attributes().position().set(v, c, X.get(v, c));
  body.sew({lips[0]});
  EXPECT_EQ(lips_at(*body.attributes().instances()[1], complex,
                    complex.faces_of(element_of(lips[0].one))[local_face(lips[0].one)]),
            nullptr);
}

}  // namespace
}  // namespace suture::test
