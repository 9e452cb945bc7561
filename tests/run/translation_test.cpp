// SPDX-License-Identifier: GPL-3.0-or-later
//
// Results do not depend on the position of a scene: the example scenes, and one with every kind of
// coordinate, near 0 and 10,000 km away. The coordinates are moved in the text of the scenes, so
// that any coordinate that the kernel overlooks is noticed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <regex>

#include "kernel/base/error.hpp"
#include "kernel/events/pierce_path.hpp"
#include "kernel/events/plane_patch.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/scene/built_scene.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/csv_table.hpp"

namespace suture::test {
namespace {

PluginHost& host() {
  static PluginHost plugins;
  return plugins;
}

constexpr Vec3 far_away{1e7, -3e6, 1e5};
// Coordinates of multiples of 1/1024 m are exact here, too.
constexpr Vec3 exact_shift{1 << 23, -(1 << 22), 1 << 17};

/// "[x, y, z]" of a point of the scene after a shift.
std::string at(const Vec3& point, const Vec3& shift) {
  char text[120];
  std::snprintf(text, sizeof text, "[%.17g, %.17g, %.17g]", point[0] + shift[0],
                point[1] + shift[1], point[2] + shift[2]);
  return text;
}

struct Listener : Observer {
  std::vector<std::string> lines;
  void on_message(const std::string& line) override { lines.push_back(line); }
};

struct Result {
  RunSummary summary;
  std::vector<std::string> events;
  std::vector<std::string> warnings;
  std::vector<double> displacement, velocity;
  Energies energies;
  double largest = 0;  ///< displacement, m

  explicit Result(const Scene& scene) {
    Diagnostics diagnostics;
    Simulation simulation(scene, host(), diagnostics);
    Listener heard;
    summary = simulation.run(heard);
    events = heard.lines;
    warnings = diagnostics.warnings();
    Attributes& a = simulation.attributes();
    for (Index v = 0; v < a.vertex_count(); ++v) {
      if (!simulation.complex().exists(0, v)) continue;
      for (int c = 0; c < 3; ++c) {
        displacement.push_back(a.position().get(v, c) - a.rest().get(v, c));
        velocity.push_back(a.velocity().get(v, c));
        largest = std::max(largest, std::abs(displacement.back()));
      }
    }
    energies = simulation.energies();
  }
};

/// Messages without the places in them, "(1, 2, 3) m", which are those of the scene.
std::vector<std::string> without_places(std::vector<std::string> lines) {
  static const std::regex place("\\([^()]*\\) m");
  for (std::string& line : lines) line = std::regex_replace(line, place, "(place)");
  return lines;
}

/// The same steps, events and islands; displacements within `tolerance` of the largest,
/// and for 0 the same bits of everything.
void expect_same(const Result& near, const Result& far, double tolerance) {
  EXPECT_EQ(near.summary.steps, far.summary.steps);
  EXPECT_EQ(near.summary.outcome, far.summary.outcome);
  EXPECT_EQ(near.summary.faces_cut, far.summary.faces_cut);
  EXPECT_EQ(near.summary.faces_torn, far.summary.faces_torn);
  EXPECT_EQ(near.summary.faces_sewn, far.summary.faces_sewn);
  EXPECT_EQ(near.summary.elements_removed, far.summary.elements_removed);
  EXPECT_EQ(without_places(near.events), without_places(far.events));
  EXPECT_EQ(near.warnings, far.warnings);
  EXPECT_GT(near.largest, 1e-3) << "something must have moved";
  ASSERT_EQ(near.displacement.size(), far.displacement.size());
  double difference = 0;
  for (std::size_t i = 0; i < near.displacement.size(); ++i)
    difference = std::max(difference, std::abs(near.displacement[i] - far.displacement[i]));
  EXPECT_LE(difference, tolerance * near.largest);
  EXPECT_NEAR(near.energies.kinetic, far.energies.kinetic, tolerance * near.energies.kinetic);
  EXPECT_NEAR(near.energies.elastic, far.energies.elastic, tolerance * near.energies.elastic);
  if (tolerance == 0) {
    EXPECT_TRUE(near.velocity == far.velocity);
  }
}

/// Both NaN is near.
void expect_near(double a, double b, double tolerance, const std::string& what) {
  EXPECT_EQ(std::isnan(a), std::isnan(b)) << what;
  if (!std::isnan(a)) {
    EXPECT_NEAR(a, b, tolerance) << what;
  }
}

// ------------------------------------------------------------ shipped scenes --

struct Shipped {
  const char* name;
  std::vector<std::pair<const char*, Vec3>> coordinates;  ///< all, but for the mesh
  std::vector<std::string> sets{};                        ///< to be quick
  const char* mesh = "box";
};

void PrintTo(const Shipped& shipped, std::ostream* stream) { *stream << shipped.name; }

class ShippedScenes : public testing::TestWithParam<Shipped> {};

const char* const plane = "/events/0/cut/plane/point";

INSTANTIATE_TEST_SUITE_P(
    Translation, ShippedScenes,
    testing::Values(Shipped{"blade-sweep",
                            {{"/events/0/cut/blade/path/0/points/0", {-0.01, 0.045, -0.01}},
                             {"/events/0/cut/blade/path/0/points/1", {-0.01, 0.045, 0.07}},
                             {"/events/0/cut/blade/path/1/points/0", {0.08, 0.035, -0.01}},
                             {"/events/0/cut/blade/path/1/points/1", {0.08, 0.035, 0.07}}},
                            {"/mesh/box/cells=[9,9,3]"}},
                    Shipped{
                        "cut-beam",
                        {{plane, {0.5, 0, 0}}, {"/output/probes/at/0/point", {0.5, 0.125, 0.125}}},
                        {"/mesh/box/cells=[20,5,5]", "/solver/end=0.4"}},
                    Shipped{"letters",
                            {{plane, {1.2, 0.32, 0}}, {"/events/1/cut/plane/point", {0.2, 0.3, 0}}},
                            {"/solver/end=0.4", "/events/0/at=0.1", "/events/1/at=0.2"},
                            "voxels"},
                    Shipped{"notched-strip",
                            {{"/events/0/cut/plane/polygon/0", {0.1, 0.04, -1}},
                             {"/events/0/cut/plane/polygon/1", {0.1, 0.07, -1}},
                             {"/events/0/cut/plane/polygon/2", {0.1, 0.07, 1}},
                             {"/events/0/cut/plane/polygon/3", {0.1, 0.04, 1}}}},
                    Shipped{"paper-beam-mss", {}, {"/mesh/box/cells=[12,3,3]", "/solver/end=0.3"}},
                    Shipped{"paper-beam-mss-tenth", {}, {"/mesh/box/cells=[12,3,3]"}},
                    Shipped{"paper-beam-tm",
                            {{"/output/probes/at/0/point", {1, 0.125, 0.125}}},
                            {"/mesh/box/cells=[12,4,4]"}},
                    Shipped{"pierce-and-suture",
                            {{"/events/0/pierce/path/0", {0.08, -1, 0.1}},
                             {"/events/0/pierce/path/1", {0.08, 1, 0.1}},
                             {"/events/1/cut/plane/polygon/0", {0.15, -1, 0.05}},
                             {"/events/1/cut/plane/polygon/1", {0.15, -1, 0.15}},
                             {"/events/1/cut/plane/polygon/2", {0.15, 1, 0.15}},
                             {"/events/1/cut/plane/polygon/3", {0.15, 1, 0.05}},
                             {"/events/2/when/where/nearest", {0.15, 0, 0.1}}}}),
    [](const auto& test) {
      std::string name = test.param.name;
      std::ranges::replace(name, '-', '_');
      return name;
    });

// A shape of cubes has the same nodes wherever it is, and these coordinates only select:
// the bits are the same.
TEST_P(ShippedScenes, HaveTheSameBitsFarAway) {
  const Shipped& shipped = GetParam();
  TemporaryFolder folder;
  const auto run = [&](const Vec3& shift, const std::string& name) {
    std::vector<std::string> sets = shipped.sets;
    sets.push_back("/output/directory=\"" + (folder / name).string() + '"');
    if (shift != Vec3{}) {
      sets.push_back(std::string("/mesh/") + shipped.mesh + "/origin=" + at({}, shift));
      for (const auto& [pointer, point] : shipped.coordinates)
        sets.push_back(pointer + ("=" + at(point, shift)));
    }
    const std::filesystem::path file =
        std::filesystem::path(SUTURE_SCENES) / (std::string(shipped.name) + ".json");
    Diagnostics diagnostics;
    Scene scene = read_scene(file, sets, host(), diagnostics);
    scene.output.every = 0;  // the first and the last frame will do
    return Result(scene);
  };
  const Result near = run({}, "near");
  expect_same(near, run(far_away, "far"), 0);
  if (!std::filesystem::exists(folder / "near/probes.csv")) return;
  const CsvTable a(folder / "near/probes.csv"), b(folder / "far/probes.csv");
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c) {
    const std::size_t place = a.columns[c].find(" position ");
    const bool shifted = place != std::string::npos;  // and rounded where the scene has it
    const double shift =
        shifted ? far_away[static_cast<std::size_t>(a.columns[c][place + 10] - 'x')] : 0;
    for (std::size_t row = 0; row < a.rows.size(); ++row)
      expect_near(a.rows[row][c] + shift, b.rows[row][c], shifted ? 4e-9 : 0, a.columns[c]);
  }
}

// ----------------------------------------------------------- every coordinate --

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

Result run_text(const std::string& text, const std::filesystem::path& output) {
  static const ModelLookup lookup{
      [](std::string_view id) -> const suture_model& { return host().model(id); },
      [](const std::filesystem::path&) {}};
  Diagnostics diagnostics;
  const std::string directory = "/output/directory=\"" + output.string() + '"';
  return Result(read_scene_text(text, "s.json", {directory}, lookup, diagnostics));
}

bool says(const Result& result, const std::string& words) {
  return std::ranges::any_of(result.events, [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

// Of coordinates only the centre of the rotation enters the arithmetic: to its rounding.
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
      const Result here = run({}, near[i], "near");
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
  std::vector<Result> results;
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
  const Result near = run({}, "x");
  EXPECT_TRUE(says(near, "cut 1 face"));
  expect_same(near, run({1 << 23, 0, 0}, "magnitude"), 0);
}

/// A bar of 8 x 2 x 2 cubes of 0.1 m far away, where 0.1 m is not what it says: what lies
/// on a bound is inside all the same, as in exact arithmetic.
class OnTheBound : public testing::TestWithParam<int> {
 protected:
  OnTheBound() {
    scene_.mesh.box = BoxOptions{far_away, {0.8, 0.2, 0.2}, {8, 2, 2}, {1, 1, 1}};
    scene_.constraints.clear();
    built_.emplace(scene_, diagnostics_);
  }
  static Vec3 p(double x, double y, double z) {
    return {x + far_away[0], y + far_away[1], z + far_away[2]};
  }
  std::vector<Index> vertices(decltype(Selection::what) what) const {
    Selection selection;
    selection.what = std::move(what);
    return built_->selector().vertices(in_frame(selection, built_->frame()));
  }
  template <class Kind>
  Kind local(Kind kind) const {
    Event event;
    event.what = std::move(kind);
    return std::get<Kind>(in_frame(std::move(event), built_->frame()).what);
  }

  const double k_ = GetParam(), x_ = 0.1 * k_;
  Scene scene_ = beam(host(), "tm-faure", 8, 2, 0);
  Diagnostics diagnostics_;
  std::optional<BuiltScene> built_;
};

INSTANTIATE_TEST_SUITE_P(Translation, OnTheBound, testing::Range(1, 8));

TEST_P(OnTheBound, NodesAreSelected) {
  const auto layers = [&](decltype(Selection::what) what) {
    return static_cast<double>(vertices(std::move(what)).size()) / 9;
  };
  EXPECT_EQ(layers(Selection::InBox{p(-1, 0, 0), p(x_, 0.2, 0.2)}), k_ + 1);
  EXPECT_EQ(layers(Selection::InBox{p(x_, 0, 0), p(1, 0.2, 0.2)}), 9 - k_);
  EXPECT_EQ(layers(Selection::HalfSpace{p(x_, 0, 0), {3, 0, 0}}), 9 - k_);
  EXPECT_EQ(layers(Selection::HalfSpace{p(x_, 0, 0), {-3, 0, 0}}), k_ + 1);
  EXPECT_EQ(layers(Selection::Plane{p(x_, 0, 0), {3, 0, 0}, 0}), 1);
  EXPECT_EQ(layers(Selection::Plane{p(x_, 0, 0), {3, 0, 0}, -1}), 1);
  const auto reached = vertices(Selection::Sphere{p(x_, 0, 0), x_});
  const auto on_axis = std::ranges::count_if(reached, [&](Index v) {
    return built_->body().attributes().rest().get(v, 1) == 0 &&
           built_->body().attributes().rest().get(v, 2) == 0;
  });
  EXPECT_EQ(static_cast<double>(on_axis), std::min(2 * k_ + 1, 9.0));
}

TEST_P(OnTheBound, TheFirstOfEquallyNearNodesIsTheNearest) {
  const auto nearest = vertices(Selection::Nearest{p(x_ + 0.05, 0.05, 0.05)});
  const auto first = vertices(Selection::InBox{p(x_, 0, 0), p(x_ + 0.1, 0.1, 0.1)});
  EXPECT_EQ(nearest, std::vector<Index>{first[0]});
}

TEST_P(OnTheBound, CentroidsCountAsPositiveAndAsInside) {
  const double* rest = built_->body().attributes().rest().rows();
  const auto faces = [&](const CutPlane& scene) {
    const CutPlane cut = local(scene);
    return faces_across_patch(built_->body().complex(), rest,
                              {cut.point, cut.normal, cut.radius, cut.polygon});
  };
  for (const Dart face : faces({p(x_ + 0.05, 0, 0), {3, 0, 0}})) {
    const Index upper = std::max(face / 24, built_->body().complex().beta3(face) / 24);
    EXPECT_EQ(static_cast<double>(built_->element_name(upper) % 8), k_) << "between k - 1 and k";
  }
  for (const Dart face : faces({p(x_ + 0.05, 0, 0), {-3, 0, 0}})) {
    const Index lower = std::min(face / 24, built_->body().complex().beta3(face) / 24);
    EXPECT_EQ(static_cast<double>(built_->element_name(lower) % 8), k_) << "between k and k + 1";
  }
  // The links of the four bars meet the plane in a square of 0.1 m: three within its side.
  EXPECT_EQ(faces({p(x_, 0.05, 0.05), {1, 0, 0}, 0.1}).size(), 3u);
  const Pierce pierce = local(Pierce{{}, {p(x_ + 0.05, 0.05, 0.05)}, x_});
  const auto elements =
      elements_along_path(built_->body().complex(), rest, pierce.path, pierce.radius);
  const auto in_first_bar =
      std::ranges::count_if(elements, [&](Index e) { return built_->element_name(e) < 8; });
  EXPECT_EQ(static_cast<double>(in_first_bar), std::min(2 * k_ + 1, 8.0));
}

// From C++, too, coordinates are those of the scene.
TEST(Translation, OfWhatAProgramAsks) {
  std::vector<Vec3> moved;
  for (const Vec3& shift : {Vec3{}, exact_shift}) {
    Scene scene = beam(host(), "tm-faure", 8, 2, 9.8);
    scene.mesh.box->origin = shift;
    scene.solver.dt = 1e-3;
    scene.solver.end = 0.05;
    Diagnostics diagnostics;
    Simulation simulation(scene, host(), diagnostics);
    Listener heard;
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

TEST(Translation, OfWhatIsToldOfABladeThatMisses) {
  TemporaryFolder folder;
  const std::string blade = write_blade(folder).string();
  const Result run = run_text(every_coordinate(far_away, box_at(far_away),
                                               R"({"at": 0.01, "cut": {"surface": {"file": ")" +
                                                   blade + R"(", "translation": [0, 0, 0]}}})"),
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
