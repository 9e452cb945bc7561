// SPDX-License-Identifier: GPL-3.0-or-later
//
// Elements that invert: which of them end a run, and how the others find back.
#include "kernel/dynamics/inversion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/steps/guard.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

/// A cube of n x n x n elements of edge 1, nowhere held.
Scene cube(Index n, const std::string& model) {
  Scene scene = beam(host(), model, n, n, 0);
  scene.mesh.box = BoxOptions{{0, 0, 0}, {1. * n, 1. * n, 1. * n}, {n, n, n}, {1, 1, 1}};
  scene.constraints.clear();
  scene.solver.end = 1;
  return scene;
}

Vec3 point_of(const Column& column, Index v) {
  return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
}

void set(Column& column, Index v, const Vec3& to) {
  for (int c = 0; c < 3; ++c) column.set(v, c, to[static_cast<std::size_t>(c)]);
}

struct Built {
  explicit Built(const Scene& given)
      : scene(given), built(scene, diagnostics), guard(built, diagnostics) {
    built.dynamics().start();
    guard.start();
  }
  Attributes& attributes() { return built.body().attributes(); }
  Index vertex_at(const Vec3& rest) {
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      if (norm(minus(point_of(attributes().rest(), v), rest)) < 1e-9) return v;
    return none;
  }
  void move(const Vec3& rest, const Vec3& to) { set(attributes().position(), vertex_at(rest), to); }
  void check() { guard.check(64, 0.5); }
  Inversion judge() {
    return judge_inversion(built.body(), find_inverted(built.body(), {}),
                           built.stops_on_inversion());
  }

  Diagnostics diagnostics;
  Scene scene;
  BuiltScene built;
  Guard guard;
};

// ------------------------------------------------------------ what ends a run --

TEST(Inversion, AFoldedCornerOfALargeBodyIsReportedOnceAndDoesNotEndTheRun) {
  Built body(cube(5, "neo-hookean"));
  body.move({0, 0, 0}, {0.4, 0.4, 0.4});  // a corner Jacobian of 1 - 1.2
  ASSERT_EQ(body.judge().first, 0u);
  EXPECT_EQ(body.judge().fatal, none);
  EXPECT_TRUE(body.judge().turned.empty());
  body.check();
  body.check();
  ASSERT_EQ(body.diagnostics.warnings().size(), 1u);
  const std::string& text = body.diagnostics.warnings()[0];
  for (const char* words : {"1 element is inverted", "element 0 at (0.5, 0.5, 0.5) m", "continues",
                            "\"element\": \"trilinear\" of model 'neo-hookean'"})
    EXPECT_NE(text.find(words), std::string::npos) << text;
  EXPECT_EQ(body.guard.inverted_elements(), 1u);
}

TEST(Inversion, TheAdviceIsNotWhatTheSceneFollowsAlready) {
  Scene scene = cube(5, "neo-hookean");
  scene.models[0].parameters =
      parameters(*scene.models[0].model, {{"E", 1e4}, {"nu", 0.3}, {"rho", 1e3}, {"element", 0}});
  Built body(scene);
  body.move({0, 0, 0}, {0.4, 0.4, 0.4});
  body.check();
  ASSERT_EQ(body.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(body.diagnostics.warnings()[0].find("trilinear"), std::string::npos)
      << body.diagnostics.warnings()[0];
}

TEST(Inversion, AFoldedCornerOfASmallBodyEndsTheRun) {
  Built body(cube(3, "neo-hookean"));  // 27 elements
  body.move({0, 0, 0}, {0.4, 0.4, 0.4});
  EXPECT_EQ(body.judge().fatal, 0u);
  EXPECT_THROW(body.check(), NumericalError);
  EXPECT_EQ(body.guard.fatal_element(), 0u);
}

/// The first vertices of an edge of a cube of 1000 elements, moved inwards along the diagonal of a
/// section: corners fold at 0.5, Gauss points follow at 0.8.
Inversion fold_edge(Index vertices, double inwards) {
  Built body(cube(10, "neo-hookean"));
  for (Index i = 0; i < vertices; ++i) body.move({1. * i, 0, 0}, {1. * i, inwards, inwards});
  EXPECT_EQ(find_inverted(body.built.body(), {}).size(), vertices);
  return body.judge();
}

TEST(Inversion, MoreThanEightElementsThatTurnedTogetherEndTheRun) {
  const Inversion eight = fold_edge(few_turned, 1.4), nine = fold_edge(few_turned + 1, 1.4);
  EXPECT_GE(eight.turned.size(), few_turned - 1);
  EXPECT_EQ(eight.fatal, none);
  EXPECT_EQ(nine.turned.size(), few_turned + 1);
  EXPECT_EQ(nine.fatal, 0u);
}

TEST(Inversion, FoldedCornersSideBySideDoNot) {
  const Inversion nine = fold_edge(few_turned + 1, 0.6);
  EXPECT_EQ(nine.first, 0u);
  EXPECT_TRUE(nine.turned.empty());
  EXPECT_EQ(nine.fatal, none);
}

TEST(Inversion, ManyFoldedCornersEndTheRunTogether) {
  Built body(cube(4, "neo-hookean"));  // 64 elements
  body.move({0, 0, 0}, {0.4, 0.4, 0.4});
  EXPECT_EQ(body.judge().fatal, none);
  body.move({4, 4, 4}, {3.6, 3.6, 3.6});
  EXPECT_EQ(body.judge().fatal, 0u);
}

}  // namespace
}  // namespace suture::test
