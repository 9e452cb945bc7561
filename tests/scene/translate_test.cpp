// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is moved, and by how much bounds are extended. tests/run/translation_test.cpp checks by
// running scenes that no coordinate is overlooked.
#include "kernel/build/translate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/scene/fake_model.hpp"

namespace suture::testing {
namespace {

const BodyFrame at_zero{{}, 2};
const BodyFrame far_away{{1 << 23, -4, 0.5}, 2};

template <class Kind>
Kind in_far_frame(Kind kind) {
  Selection selection;
  selection.what = std::move(kind);
  return std::get<Kind>(in_frame(std::move(selection), far_away).what);
}

TEST(Translate, RoundingIsThatOfCoordinatesNearTheBody) {
  EXPECT_EQ(at_zero.rounding(), 0);
  EXPECT_GT(far_away.rounding(), std::nextafter(1 << 23, 1e9) - (1 << 23));
  EXPECT_LT(far_away.rounding(), 1e-8);
}

TEST(Translate, AtZeroChangesNothing) {
  Selection plane;
  plane.what = Selection::Plane{{-0.0, 1, 2}, {1, 0, 0}, -1};
  const auto same = std::get<Selection::Plane>(in_frame(plane, at_zero).what);
  EXPECT_TRUE(std::signbit(same.point[0]));
  EXPECT_EQ(same.tolerance, -1) << "the default stays the default";
  EXPECT_EQ(at_zero.in_scene({-0.0, 1, 2}), (Vec3{-0.0, 1, 2}));
  EXPECT_TRUE(std::signbit(at_zero.in_scene({-0.0, 1, 2})[0]));
}

TEST(Translate, BoundsReachFurtherByTheRounding) {
  const double r = far_away.rounding();
  const auto box = in_far_frame(Selection::InBox{{(1 << 23) + 1, -4, 0}, {(1 << 23) + 2, -3, 1}});
  EXPECT_EQ(box.min, (Vec3{1 - r, -r, -0.5 - r}));
  EXPECT_EQ(box.max, (Vec3{2 + r, 1 + r, 0.5 + r}));
  const auto sphere = in_far_frame(Selection::Sphere{{1 << 23, -4, 0.5}, 3});
  EXPECT_EQ(sphere.centre, Vec3{});
  EXPECT_EQ(sphere.radius, 3 + r);
  const auto half = in_far_frame(Selection::HalfSpace{{1 << 23, -4, 0.5}, {0, 2, 0}});
  EXPECT_EQ(half.point, (Vec3{0, -r, 0}));
  const auto usual = in_far_frame(Selection::Plane{{1 << 23, -4, 0.5}, {0, 2, 0}, -1});
  EXPECT_DOUBLE_EQ(usual.tolerance, Selection::default_tolerance * 2 + r);
  EXPECT_EQ(usual.point, Vec3{});
  const auto exact = in_far_frame(Selection::Plane{{1 << 23, -4, 0.5}, {0, 2, 0}, 0});
  EXPECT_EQ(exact.tolerance, r);
  EXPECT_EQ(in_far_frame(Selection::Nearest{{1 << 23, 0, 0}}).tie, r);
}

TEST(Translate, ConditionsOnPositionsAndNoOthers) {
  Event event;
  event.what = CutFaces{};
  event.when.emplace();
  event.when->of = Condition::Of::position;
  event.when->component = 0;
  event.when->bound = (1 << 23) + 1;
  EXPECT_EQ(in_frame(event, far_away).when->bound, 1);
  event.when->component = 3;
  event.when->bound = 7;
  EXPECT_EQ(in_frame(event, far_away).when->bound, 7);
  EXPECT_EQ(in_frame(event, far_away).when->zero, (Vec3{-(1 << 23), 4, -0.5}));
  event.when->of = Condition::Of::displacement;
  event.when->component = 0;
  EXPECT_EQ(in_frame(event, far_away).when->bound, 7);
  EXPECT_EQ(in_frame(event, far_away).when->zero, Vec3{});
}

TEST(Translate, TheMeshAndTheCentreOfARotationButNoDirection) {
  const Scene scene = in_frame(read(R"({"suture": 1,
        "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2], "origin": [8388608, -4, 0.5]}},
        "models": [{"model": "jelly", "parameters": {"E": 1}}],
        "constraints": [
          {"move": {"translation": [1, 2, 3], "rotation": {"axis": [0, 0, 1], "angle": 9,
           "centre": [8388609, -4, 0]}}, "ramp": 1, "where": {"set": "x1"}},
          {"move": {"translation": [1, 2, 3]}, "ramp": 1, "where": {"set": "x0"}}],
        "solver": {"end": 1}})"),
                               far_away);
  EXPECT_EQ(scene.mesh.box->origin, Vec3{});
  EXPECT_EQ(scene.constraints[0].centre, (Vec3{1, 0, -0.5}));
  EXPECT_EQ(scene.constraints[0].axis, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.constraints[0].translation, (Vec3{1, 2, 3}));
  EXPECT_EQ(scene.constraints[1].centre, Vec3{}) << "without a rotation it rounds for nothing";
}

}  // namespace
}  // namespace suture::testing
