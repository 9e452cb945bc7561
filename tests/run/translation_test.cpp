// SPDX-License-Identifier: GPL-3.0-or-later
//
// Results do not depend on the position of a scene: one with every kind of coordinate, near 0 and
// 10,000 km away. The coordinates are moved in the text of the scene, so that any coordinate that
// the kernel overlooks is noticed.
#include "tests/run/translation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "kernel/base/error.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

/// A bar of 8 x 2 x 2 cubes of 1/8 m with its lower corner at the shift, and one thing of
/// each kind that has a coordinate.
std::string every_coordinate(const Vec3& shift, const std::string& mesh,
                             const std::string& events) {
  const auto p = [&](double x, double y, double z) { return at({x, y, z}, shift); };
  return R"({"suture": 1, "mesh": )" + mesh + R"(,
  "models": [
    {"model": "tm-faure", "region": {"half_space": {"point": )" +
         p(0.5, 0, 0) +
         R"(, "normal": [-1, 0, 0]}}, "parameters": {"E": 2e5, "nu": 0.3, "rho": 1000}},
    {"model": "mss-baudet", "region": {"box": {"min": )" +
         p(0.5, 0, 0) + ", \"max\": " + p(1, 1, 1) +
         R"(}}, "parameters": {"E": 2e5, "nu": 0.25, "rho": 1000}}],
  "gravity": [0, -1, 0],
  "constraints": [
    {"fix": "xyz", "where": {"plane": {"point": )" +
         p(0, 0, 0) + R"(, "normal": [1, 0, 0]}}},
    {"move": {"rotation": {"axis": [1, 0, 0], "angle": 20, "centre": )" +
         p(1, 0.125, 0.125) +
         R"(}, "translation": [0.02, 0, 0]}, "ramp": 0.05,
     "where": {"plane": {"point": )" +
         p(1, 0, 0) + R"(, "normal": [2, 0, 0], "tolerance": 0}}}],
  "loads": [
    {"force": [0, 0, 5], "where": {"nearest": )" +
         p(0.55, 0.11, 0.3) + R"(}},
    {"pressure": 100, "where": {"sphere": {"centre": )" +
         p(0.25, 0, 0.125) + R"(, "radius": 0.25}}}],
  "solver": {"end": 0.1, "dt": 2e-4, "damping": 5},
  "events": [)" +
         events + R"(],
  "output": {"fields": ["element_id"],
    "probes": {"every_steps": 50, "at": [
      {"name": "tie", "point": )" +
         p(0.3125, 0.0625, 0.0625) + R"(},
      {"name": "box", "where": {"box": {"min": )" +
         p(0.25, 0, 0) + ", \"max\": " + p(0.5, 0.25, 0) +
         R"(}}, "fields": ["displacement", "reaction", "node_id"], "of": "sum"}]}}})";
}

std::string box_at(const Vec3& shift) {
  return R"({"box": {"size": [1, 0.25, 0.25], "cells": [8, 2, 2], "origin": )" + at({}, shift) +
         "}}";
}

/// Each with the words that a run with it says.
struct Happening {
  std::string what;
  std::string says;
};

std::vector<Happening> happenings(const Vec3& shift, const std::filesystem::path& blade) {
  const auto p = [&](double x, double y, double z) { return at({x, y, z}, shift); };
  const std::string half = R"({"at": 0.01, "cut": {"plane": {"point": )" + p(0.375, 0, 0) +
                           R"(, "normal": [1, 0, 0]}}})";
  return {
      {half, "cut 4 faces"},
      // A centroid on the plane counts as positive.
      {R"({"at": 0, "cut": {"plane": {"point": )" + p(0.3125, 0, 0) + R"(, "normal": [1, 0, 0]}}})",
       "cut 4 faces"},
      {R"({"at": 0, "cut": {"plane": {"point": )" + p(0.375, 0.0625, 0.0625) +
           R"(, "normal": [1, 0, 0], "radius": 0.125}}})",
       "cut 3 faces"},
      {R"({"at": 0.01, "cut": {"plane": {"polygon": [)" + p(0.375, -1, -1) + ", " +
           p(0.375, 0.125, -1) + ", " + p(0.375, 0.125, 1) + ", " + p(0.375, -1, 1) + "]}}}",
       "cut 2 faces"},
      {R"({"at": 0.01, "cut": {"surface": {"file": ")" + blade.string() + R"(", "translation": )" +
           p(0.375, 0, 0) + "}}}",
       "cut 4 faces"},
      {R"({"cut": {"blade": {"path": [{"at": 0.02, "points": [)" + p(0.385, -0.1, -1) + ", " +
           p(0.385, -0.1, 1) + R"(]}, {"at": 0.05, "points": [)" + p(0.385, 0.4, -1) + ", " +
           p(0.385, 0.4, 1) + "]}]}}}",
       "cut 2 faces"},
      {R"({"at": 0.01, "pierce": {"where": {"sphere": {"centre": )" + p(0.5625, 0, 0) +
           R"(, "radius": 0.1}}}})",
       "removed 1 element"},
      {R"({"at": 0.01, "pierce": {"path": [)" + p(0.3125, -1, 0.0625) + ", " +
           p(0.3125, 1, 0.0625) + R"(], "radius": 0.0625}})",
       "removed 2 elements"},
      {half + R"(, {"at": 0.02, "suture": {"where": {"half_space": {"point": )" + p(0, 0.125, 0) +
           R"(, "normal": [0, 1, 0]}}}})",
       "sewed 2 faces"},
      {half + R"(, {"at": 0.01, "suture": {"gap": 0.01, "between": [{"box": {"min": )" +
           p(0, 0, 0) + ", \"max\": " + p(0.375, 1, 1) + R"(}}, {"box": {"min": )" +
           p(0.375, 0, 0) + ", \"max\": " + p(1, 0.125, 1) + "}}]}}",
       "sewed 2 faces"},
      {half + R"(, {"at": 0.05, "remove_islands": {"outside": {"box": {"min": )" + p(0.8, -1, -1) +
           ", \"max\": " + p(2, 2, 2) + "}}}}",
       "removed 12 elements"},
      {R"({"every": 1, "tear": {"by": "elongation", "above": 0.01, "most": 1,
           "where": {"box": {"min": )" +
           p(0.375, 0, 0) + ", \"max\": " + p(0.625, 1, 1) + "}}}}",
       "tore "},
      {R"({"when": {"where": {"nearest": )" + p(1, 0, 0) +
           R"(}, "of": "position", "component": "x", "above": )" +
           std::to_string(1.0078125 + shift[0]) + R"(}, "cut": {"faces": [[2, 3]]}})",
       "cut 1 face"},
      {R"({"when": {"where": {"nearest": )" + p(1, 0, 0) +
           R"(}, "of": "displacement", "component": "x", "above": 0.01}, "cut": {"faces": [[2, 3]]}})",
       "cut 1 face"}};
}

/// A blade in the plane x = 0, as a file.
std::filesystem::path write_blade(const TemporaryFolder& folder) {
  return folder.write("blade.off", "OFF\n3 1 0\n0 -9 -9\n0 9 -9\n0 0 9\n3 0 1 2\n");
}

TranslatedRun run_text(const std::string& text, const std::filesystem::path& output) {
  static const ModelLookup lookup{
      [](std::string_view id) -> const suture_model& { return host().model(id); },
      [](const std::filesystem::path&) {}};
  Diagnostics diagnostics;
  const std::string directory = "/output/directory=\"" + output.string() + '"';
  return TranslatedRun(read_scene_text(text, "s.json", {directory}, lookup, diagnostics));
}

bool says(const TranslatedRun& result, const std::string& words) {
  return std::ranges::any_of(result.events, [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

// Only the centre of the rotation enters the arithmetic by its coordinates: to its rounding.
TEST(Translation, OfEveryCoordinateChangesNothing) {
  TemporaryFolder folder;
  const std::filesystem::path blade = write_blade(folder);
  for (const Vec3& shift : {exact_shift, far_away}) {
    const auto near = happenings({}, blade), far = happenings(shift, blade);
    for (std::size_t i = 0; i < near.size(); ++i) {
      SCOPED_TRACE(far[i].what);
      const auto run = [&](const Vec3& by, const Happening& happening, const char* name) {
        return run_text(every_coordinate(by, box_at(by), happening.what), folder / name);
      };
      const TranslatedRun here = run({}, near[i], "near");
      EXPECT_TRUE(says(here, near[i].says)) << testing::PrintToString(here.events);
      expect_same(here, run(shift, far[i], "far"), shift == exact_shift ? 0 : 1e-6);
      const CsvTable a(folder / "near/probes.csv"), b(folder / "far/probes.csv");
      EXPECT_EQ(a.last("box node_id"), b.last("box node_id"));
      expect_near(a.last("tie position x [m]") + shift[0], b.last("tie position x [m]"), 4e-9,
                  "the position of a node that is as near as seven others");
      expect_near(a.last("tie displacement y [m]"), b.last("tie displacement y [m]"), 1e-8,
                  "its displacement");
    }
  }
}

// A mesh file: its lower corner is the origin. Nodes at multiples of 1/8 m move exactly.
TEST(Translation, OfAMeshFileChangesNothing) {
  TemporaryFolder folder;
  std::vector<TranslatedRun> results;
  for (const Vec3& shift : {Vec3{}, exact_shift}) {
    Diagnostics diagnostics;
    Mesh mesh = make_box({.origin = shift, .size = {1, 0.25, 0.25}, .cells = {8, 2, 2}});
    mesh.points.push_back({-1e9, 0, 0});  // that no element uses
    write_mesh(folder / "bar.vtu", mesh, diagnostics);
    const std::string source = R"({"file": ")" + (folder / "bar.vtu").string() + "\"}";
    results.push_back(
        run_text(every_coordinate(shift, source, happenings(shift, "")[0].what), folder / "out"));
    // Frames show the body where the file has it.
    const Mesh frame = read_mesh(folder / "out/frame_0000.vtu", 1, diagnostics);
    Vec3 low = frame.points[0];
    for (const Vec3& point : frame.points)
      for (std::size_t c = 0; c < 3; ++c) low[c] = std::min(low[c], point[c]);
    EXPECT_EQ(low, shift);
  }
  expect_same(results[0], results[1], 0);
}

// How far a node is from the scene's zero: 10,000 km along x, that is its x.
TEST(Translation, OfTheMagnitudeOfAPosition) {
  TemporaryFolder folder;
  const auto run = [&](const Vec3& shift, const char* component) {
    char bound[40];
    std::snprintf(bound, sizeof bound, "%.17g", 1.0078125 + shift[0]);
    const std::string event = R"({"when": {"where": {"nearest": )" + at({1, 0, 0}, shift) +
                              R"(}, "of": "position", "component": ")" + component +
                              R"(", "above": )" + bound + R"(}, "cut": {"faces": [[2, 3]]}})";
    return run_text(every_coordinate(shift, box_at(shift), event), folder / component);
  };
  const TranslatedRun near = run({}, "x");
  EXPECT_TRUE(says(near, "cut 1 face"));
  expect_same(near, run({1 << 23, 0, 0}, "magnitude"), 0);
}

// From C++, too, coordinates are those of the scene.
TEST(Translation, OfWhatAProgramAsks) {
  std::vector<Vec3> moved;
  for (const Vec3& shift : {Vec3{}, exact_shift}) {
    Scene scene = beam(host(), "tm-faure", 8, 2, 9.8);
    scene.mesh.box->origin = shift;
    scene.solver.dt = 1e-3;
    scene.solver.end = 0.05;
    TestSimulation simulation(scene);
    MessageList heard;
    simulation.run_to(0.01, heard);
    Event cut;
    cut.what = CutPlane{{0.5 + shift[0], shift[1], shift[2]}, {1, 0, 0}};
    cut.path = "/event";
    simulation.apply(cut, heard);
    simulation.run(heard);
    ASSERT_EQ(heard.lines.size(), 1u);
    EXPECT_NE(heard.lines[0].find("cut 4 faces"), std::string::npos) << heard.lines[0];
    Selection tip;
    tip.what = Selection::Nearest{{1 + shift[0], shift[1], shift[2]}};
    moved.push_back(simulation.mean_displacement(tip));
    EXPECT_EQ(simulation.origin(), shift);
    EXPECT_EQ(simulation.attributes().rest().get(0, 0), 0);
  }
  EXPECT_LT(moved[0][1], -1e-3);
  EXPECT_EQ(moved[0], moved[1]);
}

// Messages show places as the scene has them, with digits that show the size.
TEST(Translation, OfWhatMessagesShow) {
  Scene scene = beam(host(), "tm-faure", 8, 2, 9.8);
  scene.mesh.box->origin = far_away;
  scene.constraints[0].where.what = Selection::Sphere{{0, 0, 0}, 1};
  scene.constraints[0].where.path = "/constraints/0/where";
  Diagnostics diagnostics;
  try {
    Simulation simulation(scene, host(), diagnostics);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "/constraints/0/where: the selection contains no node; the nodes lie in "
                 "[10000000, -3000000, 100000] to [10000001, -2999999.75, 100000.25] m");
  }
}

TEST(Translation, OfTheWarningOfABladeThatMisses) {
  TemporaryFolder folder;
  const std::string blade = write_blade(folder).string();
  const TranslatedRun run =
      run_text(every_coordinate(far_away, box_at(far_away),
                                R"({"at": 0.01, "cut": {"surface": {"file": ")" + blade +
                                    R"(", "translation": [0, 0, 0]}}})"),
               folder / "out");
  ASSERT_EQ(run.warnings.size(), 1u);
  EXPECT_NE(
      run.warnings[0].find(
          "it lies outside the body; blade [0, -9, -9] to [0, 9, 9] m, body [10000000, -3000000.0"),
      std::string::npos)
      << run.warnings[0];
}

}  // namespace
}  // namespace suture::test
