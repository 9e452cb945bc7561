// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a scene does not need is skipped, `explain` lists it, and a run that skips nothing gives the
// same results. Cells of 1/8 m have bitwise equal shapes, and so have the columns that are stored
// once; PiecesThatDifferByRounding uses other cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

struct Result {
  std::vector<double> position, velocity;
  std::vector<Decision> decisions;

  const Decision& about(const std::string& subject) const {
    const auto found = std::ranges::find(decisions, subject, &Decision::subject);
    if (found == decisions.end()) throw std::logic_error("no decision on " + subject);
    return *found;
  }
};

std::vector<double> rows(const Column& column) {
  const std::size_t count = std::size_t{column.size()} * static_cast<std::size_t>(column.stride());
  return {column.rows(), column.rows() + count};
}

Result run(const Scene& scene, bool skip) {
  TestSimulation simulation(scene, skip);
  simulation.run();
  return {rows(simulation.attributes().position()), rows(simulation.attributes().velocity()),
          simulation.decisions()};
}

/// The beam of the paper in 16 x 4 x 4 cubes for 40 steps, cut after 20 of them.
Scene short_beam(const std::string& model, const std::map<std::string, double>& values = {}) {
  Scene scene = beam(host(), model, 8, 2, 9.8, values);
  scene.solver.dt = 1e-4;
  scene.solver.end = 40e-4;
  Event cut;
  cut.at = 20e-4;
  cut.what = CutPlane{{0.6, 0.1, 0}, {1, 0.3, 0}};
  scene.events.push_back(cut);
  return scene;
}

/// Runs both; the subject is skipped in the first and done in the second, with the
/// same bits.
void expect_skip(const Scene& scene, const std::string& subject) {
  const Result less = run(scene, true), all = run(scene, false);
  EXPECT_TRUE(less.about(subject).skipped) << less.about(subject).reason;
  EXPECT_FALSE(less.about(subject).reason.empty());
  const auto is_skipped = [&](const Decision& d) { return d.subject == subject && d.skipped; };
  EXPECT_TRUE(std::ranges::none_of(all.decisions, is_skipped)) << subject;
  EXPECT_TRUE(less.position == all.position) << subject;
  EXPECT_TRUE(less.velocity == all.velocity) << subject;
  const auto moved = std::ranges::count_if(less.velocity, [](double v) { return v != 0; });
  EXPECT_GT(moved, 100) << "something must have moved";
}

TEST(Skip, EdgeAndFaceIdsThatNobodyWorksOn) {
  expect_skip(short_beam("tm-faure"), "edge ids");
  expect_skip(short_beam("tm-faure"), "face ids");
  expect_skip(short_beam("mss-baudet"), "face ids");
  EXPECT_FALSE(run(short_beam("mss-baudet"), true).about("edge ids").skipped);
}

TEST(Skip, WhatIsTheSameEverywhereIsStoredOnce) {
  expect_skip(short_beam("tm-faure"), "column tm-faure/inverse_jacobian");
  expect_skip(short_beam("mss-baudet"), "column mss-baudet/inner_stiffness");
}

// Cells of 1/10 m have inverse Jacobians that differ by 1e-13 of their size; one
// of them stands for all. Within 1e-12 of the largest displacement.
TEST(Skip, PiecesThatDifferByRounding) {
  Scene scene = short_beam("tm-faure");
  scene.mesh.box->cells = {10, 3, 3};
  const Result less = run(scene, true), all = run(scene, false);
  EXPECT_TRUE(less.about("column tm-faure/inverse_jacobian").skipped);
  EXPECT_FALSE(all.about("column tm-faure/inverse_jacobian").skipped);
  ASSERT_EQ(less.position.size(), all.position.size());
  double largest = 0, speed = 0, difference = 0;
  for (std::size_t i = 0; i < all.velocity.size(); ++i) {
    speed = std::max(speed, std::abs(all.velocity[i]));
    difference = std::max(difference, std::abs(all.velocity[i] - less.velocity[i]));
    largest = std::max(largest, std::abs(all.position[i] - less.position[i]));
  }
  EXPECT_GT(speed, 1e-3);
  EXPECT_LT(difference, 1e-10 * speed);
  EXPECT_LT(largest, 1e-12 * 1e-2);
}

TEST(Skip, DampingAndVelocitiesWithoutViscosity) {
  const Scene scene = short_beam("mss-baudet");
  expect_skip(scene, "functor mss-baudet/edge springs with viscosity");
  expect_skip(scene, "functor mss-baudet/inner springs with viscosity and correction");
  expect_skip(scene, "velocities for functor mss-baudet/edge springs");
  const Result viscous = run(short_beam("mss-baudet", {{"viscosity", 1}}), true);
  EXPECT_FALSE(viscous.about("functor mss-baudet/edge springs with viscosity").skipped);
  const Result plain = run(scene, true);
  EXPECT_FALSE(viscous.velocity == plain.velocity) << "viscosity matters where it is asked for";
}

TEST(Skip, CorrectionForcesAndWhatTheyRead) {
  const Scene scene = short_beam("mss-baudet", {{"viscosity", 1}});
  expect_skip(scene, "functor mss-baudet/inner springs with viscosity and correction");
  expect_skip(scene, "column mss-baudet/correction_stiffness");
  expect_skip(scene, "column mss-baudet/box");
  const Result corrected =
      run(short_beam("mss-baudet", {{"correction", 1}, {"viscosity", 1}}), true);
  EXPECT_EQ(corrected.about("column mss-baudet/box").reason.find("no functor"), std::string::npos);
}

TEST(Skip, ThreadsForALoopThatIsSmall) {
  Scene scene = short_beam("tm-faure");
  scene.solver.threads = 2;
  expect_skip(scene, "threads");
}

/// Half of a beam between fixed nodes: a bone.
Scene beam_with_bone(const std::string& model) {
  Scene scene = short_beam(model);
  scene.mesh.box->cells = {16, 4, 4};
  scene.constraints[0].where.what = Selection::InBox{{-1, -1, -1}, {0.5, 1, 1}};
  return scene;
}

constexpr const char* still = "cells between fixed vertices";

class StillCells : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Skip, StillCells, testing::Values("tm-faure", "mss-baudet"),
                         [](const auto& test) { return std::string(test.param, 2); });

TEST_P(StillCells, AreSkipped) {
  expect_skip(beam_with_bone(GetParam()), still);
  Scene cut = beam_with_bone(GetParam());
  cut.events[0].what = CutPlane{{0.25, 0.1, 0}, {1, 0.3, 0.2}};  // through the bone
  expect_skip(cut, still);
  const Decision decision = run(cut, true).about(still);
  EXPECT_GE(std::stoi(decision.reason), 96) << decision.reason;
}

TEST_P(StillCells, AreComputedIfSomebodyLooks) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("suture-skip-" + std::to_string(::getpid()));
  const auto computed = [&](const auto& change) {
    Scene scene = beam_with_bone(GetParam());
    scene.output.directory = folder;
    change(scene);
    const Decision decision = run(scene, true).about(still);
    EXPECT_FALSE(decision.skipped) << decision.reason;
    EXPECT_NE(decision.reason.find("computed"), std::string::npos) << decision.reason;
  };
  const auto shows = [](const std::string& field) {
    return [field](Scene& s) {
      s.output.enabled = true;
      s.output.fields = {field};
    };
  };
  computed(shows("reaction"));
  computed(shows("force"));
  if (GetParam() == std::string("tm-faure")) computed(shows("stress"));
  computed([](Scene& s) {
    s.output.enabled = true;
    s.output.energies_every = 1;
  });
  computed([](Scene& s) {
    s.output.enabled = true;
    s.output.probes_every = 1;
    s.output.probes.push_back({"tip", beam_tip(4)});
  });
  std::filesystem::remove_all(folder);
}

TEST_P(StillCells, AreComputedIfTheyAreMoved) {
  Scene scene = beam_with_bone(GetParam());
  scene.constraints[0].moves = true;
  scene.constraints[0].translation = {0.01, 0, 0};
  scene.constraints[0].ramp = {0, 1e-3, true};
  EXPECT_FALSE(run(scene, true).about(still).skipped);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Skip, FieldsThatAreNotAskedFor) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("suture-fields-" + std::to_string(::getpid()));
  std::string frames[2];
  for (const bool skip : {true, false}) {
    Scene scene = short_beam("tm-faure");
    scene.output.enabled = true;
    scene.output.directory = folder;
    scene.output.fields = {"displacement"};
    scene.solver.threads = 1;  // frames name it
    const Decision decision = run(scene, skip).about("other fields");
    EXPECT_EQ(decision.skipped, skip);
    EXPECT_NE(decision.reason.find("stress"), std::string::npos) << decision.reason;
    EXPECT_NE(decision.reason.find("velocity"), std::string::npos) << decision.reason;
    frames[skip] = bytes_of(folder / "frame_0001.vtu");
    std::filesystem::remove_all(folder);
  }
  EXPECT_GT(frames[0].size(), 1000u);
  EXPECT_TRUE(frames[0] == frames[1]);
}

}  // namespace
}  // namespace suture::test
