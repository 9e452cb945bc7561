// SPDX-License-Identifier: GPL-3.0-or-later
//
// Unconstrained bodies.
#include "kernel/steps/free_bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/free_motions.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

Constraint hold(const Selection& where, std::uint8_t components) {
  Constraint constraint;
  constraint.where = where;
  constraint.components = components;
  return constraint;
}

Selection nearest(const Vec3& point) {
  Selection selection;
  selection.what = Selection::Nearest{point};
  return selection;
}

Selection side(const char* name) {
  Selection selection;
  selection.what = Selection::Named{name};
  return selection;
}

Scene held_by(const std::vector<Constraint>& constraints, double gravity = 1) {
  Scene scene = beam(host(), "tm-faure", 8, 2, gravity);
  scene.constraints = constraints;
  scene.solver.until_rest = true;
  scene.solver.automatic_damping = true;
  return scene;
}

/// How the pieces of a scene can move; one after the other.
std::string motions(const Scene& scene, bool cut = false) {
  Diagnostics diagnostics;
  BuiltScene w(scene, diagnostics);
  w.dynamics().start();
  if (cut) {
    Selection all;
    std::vector<Dart> faces;
    for (Dart d = 0; d < 24 * w.body().complex().element_count(); d += 4) {
      const Index e = d / 24,
                  other = w.body().complex().can_cut(d) ? w.body().complex().beta3(d) / 24 : none;
      if (other == none || e > other) continue;
      const auto x = [&](Index i) { return w.body().imported().user_element[i] % 8; };
      if ((x(e) < 5) != (x(other) < 5)) faces.push_back(d);
    }
    w.body().cut(faces);
  }
  const std::vector<double> none_at_all(4 * std::size_t{w.body().attributes().vertex_count()});
  std::string text;
  for (const FreePiece& piece :
       find_free_pieces(w.body().complex(), w.body().attributes(), none_at_all))
    text += (text.empty() ? "" : "; ") + std::to_string(piece.elements) + " from " +
            std::to_string(piece.first_element) + ": " + piece.motions();
  return text;
}

TEST(FreeBodies, TheirMotionsAreTheNullSpaceOfTheConstraints) {
  const auto all = std::uint8_t{7};
  EXPECT_EQ(motions(held_by({hold(side("x0"), all)})), "");
  EXPECT_EQ(motions(held_by({})), "32 from 0: move and turn in every direction");
  EXPECT_EQ(motions(held_by({hold(nearest({0, 0, 0}), all)})), "32 from 0: turn about every axis");
  EXPECT_EQ(motions(held_by({hold(nearest({0, 0, 0}), all), hold(nearest({0, 0, 0.25}), all)})),
            "32 from 0: turn about z");
  EXPECT_EQ(motions(held_by({hold(nearest({0, 0, 0}), all), hold(nearest({0, 0.25, 0.25}), all)})),
            "32 from 0: turn about (0, 0.707, 0.707)");
  EXPECT_EQ(motions(held_by({hold(side("y0"), 2)})),
            "32 from 0: move along x and z and turn about y");
  EXPECT_EQ(motions(held_by({hold(side("y0"), 2), hold(side("x0"), 1)})),
            "32 from 0: move along z");
  EXPECT_EQ(motions(held_by({hold(side("y0"), 2), hold(side("x0"), 1), hold(side("z0"), 4)})), "");
}

TEST(FreeBodies, APieceThatWasCutOffIsOne) {
  EXPECT_EQ(motions(held_by({hold(side("x0"), 7)}), true),
            "12 from 5: move and turn in every direction");
}

std::string outcome(const Scene& scene) {
  Diagnostics diagnostics;
  Observer nobody;
  std::string text;
  try {
    Simulation simulation(scene, host(), diagnostics);
    simulation.run(nobody);
  } catch (const InputError& error) {
    return std::string("refused ") + error.what();
  } catch (const NumericalError& error) {
    return std::string("stopped ") + error.what();
  }
  for (const auto& warning : diagnostics.warnings()) text += warning;
  return "ran " + text;
}

TEST(FreeBodies, WhatLoadsPushIsRefusedUnlessThereIsAnEnd) {
  Scene scene = held_by({hold(side("x0"), 1)});
  const std::string refused = outcome(scene);
  EXPECT_EQ(refused.find("refused /constraints: a piece of 32 elements (the first: element 0) is "
                         "free to move along y and z and turn about x"),
            0u)
      << refused;
  EXPECT_NE(refused.find("/solver/end"), std::string::npos);
  scene.solver.end = 0.01;
  EXPECT_EQ(outcome(scene).find("ran"), 0u);
  scene.solver.end.reset();
  scene.gravity = {1, 0, 0};
  EXPECT_EQ(outcome(scene).find("ran /constraints:"), 0u) << "only warned of: " << outcome(scene);
}

TEST(FreeBodies, WhatIsCutOffAndFallsEndsTheSearch) {
  Scene scene = held_by({hold(side("x0"), 7)});
  Event event;
  event.at = 0.1;
  event.what = CutPlane{{0.51, 0, 0}, {1, 0, 0}};
  scene.events.push_back(event);
  const std::string text = outcome(scene);
  EXPECT_EQ(text.find("stopped the body cannot come to rest: a piece of 16 elements (the first: "
                      "element 4) is free"),
            0u)
      << text;
}

}  // namespace
}  // namespace suture::test
