// SPDX-License-Identifier: GPL-3.0-or-later
//
// Frames of which each of several processes writes a piece.
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <chrono>

#include "kernel/mesh/mesh_file.hpp"
#include "kernel/output/collection.hpp"
#include "kernel/output/frame_pieces.hpp"
#include "tests/resume/together.hpp"

namespace suture::test {
namespace {

namespace fs = std::filesystem;

/// The bits of what a frame shows in its elements, one after the other: all numbers of their
/// corners, and their own. Pieces number their points, too, which may be left out.
std::vector<std::uint64_t> elements_of(const fs::path& frame, bool with_numbers = false) {
  std::vector<fs::path> files;
  for (const std::string& piece : pieces_of(frame.parent_path(), frame.filename()))
    files.push_back(frame.parent_path() / piece);
  if (files.empty()) files.push_back(frame);
  std::vector<std::uint64_t> numbers;
  const auto add = [&](double number) { numbers.push_back(std::bit_cast<std::uint64_t>(number)); };
  for (const fs::path& file : files) {
    Diagnostics diagnostics;
    const Mesh mesh = read_mesh(file, 1, diagnostics, all_arrays);
    for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) {
      for (const Index v : mesh.hexahedra[e]) std::ranges::for_each(mesh.points[v], add);
      for (const MeshArray& array : mesh.arrays) {
        if (array.name == point_in_frame && !with_numbers) continue;
        for (const Index row : array.of_elements ? std::vector{static_cast<Index>(e)}
                                                 : std::vector<Index>(mesh.hexahedra[e].begin(),
                                                                      mesh.hexahedra[e].end()))
          for (std::size_t c = 0; c < array.components; ++c)
            add(array.values[row * array.components + c]);
      }
    }
  }
  return numbers;
}

TEST_F(Together, PiecesOfFramesAreThoseOfOne) {
  Case what = cut_beam();
  what.scene["solver"]["end"] = 0.5;
  what.scene["output"] = {{"directory", "out"},
                          {"every", 0.1},
                          {"energies", Json::object()},
                          {"fields", {"velocity", "stress", "element_id"}}};
  what.scene["checkpoint"] = {{"every_steps", 50}};
  const fs::path alone = folder_ / "alone", together = folder_ / "together";
  write_case(what, alone);
  EXPECT_EQ(run(what, {"scene.json"}, 0, alone), 0) << said(alone);
  what.scene["output"]["pieces"] = true;
  write_case(what, together);
  EXPECT_EQ(run(what, {"scene.json"}, 3, together), 0) << said(together);
  const std::string newest = newest_checkpoint(together / "out").filename();
  const auto expect_same = [&] {
    EXPECT_EQ(read_text(together / "out" / "energies.csv"),
              read_text(alone / "out" / "energies.csv"));
    std::string list = read_text(together / "out" / "run.pvd");
    for (std::size_t at; (at = list.find(".pvtu")) != list.npos;) list.erase(at + 1, 1);
    EXPECT_EQ(list, read_text(alone / "out" / "run.pvd"));
    for (const char* frame : {"frame_0000", "frame_0002", "frame_0005"}) {
      const fs::path pieces = together / "out" / (std::string(frame) + ".pvtu");
      EXPECT_EQ(elements_of(pieces), elements_of(alone / "out" / (std::string(frame) + ".vtu")));
    }
  };
  expect_same();
  EXPECT_TRUE(fs::exists(together / "out" / "frame_0005_2.vtu"));
  EXPECT_EQ(run(what, {"--resume", "out/" + newest}, 2, together), 0) << said(together);
  expect_same();
  EXPECT_FALSE(fs::exists(together / "out" / "frame_0005_2.vtu"));
  EXPECT_TRUE(fs::exists(together / "out" / "frame_0000_2.vtu"));
}

/// All fields that pieces are computed for, of a body with cuts and holes.
Case with_all_fields() {
  return {"pieces-all", Json::parse(R"({
    "suture": 2,
    "mesh": {"box": {"size": [1, 1, 1], "cells": [21, 22, 23]}},
    "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "gravity": [0, -10, 0],
    "constraints": [{"where": {"set": "x0"}, "fix": "xyz"}],
    "contact": {"obstacles": [{"name": "floor",
                               "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}}]},
    "solver": {"end": 0.05},
    "events": [{"at": 0.01, "cut": {"along": "faces", "plane": {"point": [0.5, 0.5, 0.5],
                                                                "normal": [0.4, 1, 0.2]}}},
               {"at": 0.02, "pierce": {"path": [[0.4, -2, 0.6], [0.4, 2, 0.6]], "radius": 0.1}}],
    "output": {"directory": "out", "every_steps": 4, "pieces": true, "energies": {}, "fields": [
      "displacement", "velocity", "force", "reaction", "reaction_moment", "mass", "fixed",
      "node_id", "element_id", "island", "model", "strain", "principal_strain", "contact_force",
      "gap", "stress", "von_mises", "principal_stress", "nodal_stress", "nodal_von_mises"]},
    "checkpoint": {"every_steps": 5, "keep": 10}})")};
}

/// Fewer elements than processes.
Case with_two_elements() {
  Case what = with_all_fields();
  what.name = "pieces-two";
  what.scene["mesh"]["box"]["cells"] = {1, 1, 2};
  what.scene["events"] = Json::array();
  what.scene["solver"]["end"] = 0.5;
  return what;
}

/// Others, at random.
Case in_pieces(Random& random, unsigned index) {
  if (index < 2) return index == 0 ? with_two_elements() : with_all_fields();
  Case what = divided(random, index);
  what.name = "pieces-" + std::to_string(index);
  what.skips = random.chance(0.9);
  Json& scene = what.scene;
  auto& events = scene["events"].get_ref<Json::array_t&>();
  std::erase_if(events, [](const Json& event) {  // leaves tetrahedra, too
    return event.dump().find("blade") != std::string::npos;
  });
  std::vector<std::string> fields{"velocity", "force", "reaction", "reaction_moment",
                                  "mass",     "fixed", "node_id",  "element_id",
                                  "island",   "model", "strain",   "principal_strain"};
  if (scene["models"].dump().find("tm-faure") != std::string::npos)
    fields.insert(fields.end(), {"stress", "von_mises", "principal_stress", "nodal_stress"});
  if (scene.contains("contact")) fields.insert(fields.end(), {"contact_force", "gap"});
  std::erase_if(fields, [&](const std::string&) { return random.chance(0.5); });
  if (random.chance(0.1)) fields.emplace_back("hourglass");
  scene["output"] = {{"directory", "out"},
                     {"pieces", true},
                     {"fields", fields},
                     {"cuts", random.chance(0.3)},
                     {"energies", {{"every_steps", 5}}},
                     {"every_steps", static_cast<int>(random.between(4, 20))}};
  scene["checkpoint"] = {{"every_steps", static_cast<int>(random.between(4, 20))}, {"keep", 3}};
  return what;
}

void expect_same_frames(const fs::path& one, const fs::path& other) {
  unsigned frames = 0;
  for (const auto& entry : fs::directory_iterator(one)) {
    const fs::path name = entry.path().filename();
    if (name.extension() == ".csv" || name.extension() == ".pvd") {
      EXPECT_EQ(read_text(one / name), read_text(other / name)) << name;
    }
    if (name.extension() != ".pvtu" || !name.string().starts_with("frame")) continue;
    EXPECT_TRUE(elements_of(one / name, true) == elements_of(other / name, true)) << name;
    ++frames;
  }
  EXPECT_GT(frames, 0u);
}

/// A process computes its piece from rows near it; checkpoints have frames that are held back,
/// which others resume.
TEST_F(Together, PiecesOfDividedBodiesAreThoseOfOne) {
  const std::vector<unsigned> numbers{2, 3, 4, 7};
  const auto start = std::chrono::steady_clock::now();
  for (unsigned index = 0; index < 52; ++index) {
    const auto spent = std::chrono::steady_clock::now() - start;
    if (!is_full() && index > 1 && spent > std::chrono::seconds(3)) break;
    Random random(scenes_seed(), "pieces", index);
    const Case what = in_pieces(random, index);
    if (!is_chosen(what)) continue;
    SCOPED_TRACE(what.name + ", SUTURE_PROCESSES_SEED=" + std::to_string(scenes_seed()));
    const fs::path at = folder_ / what.name, scene = at / "scene.json";
    const fs::path alone = at / "0" / "out", there = at / "n", out = there / "out";
    const int code = run_alone(what, at);
    EXPECT_EQ(run(what, {scene}, random.pick(numbers), there), code) << said(there);
    expect_same_frames(alone, out);
    const fs::path newest = newest_checkpoint(out);
    expect_same_checkpoints(alone, out);
    if (!newest.empty()) {
      const std::string from = "out/" + newest.filename().string();
      EXPECT_EQ(run(what, {"--resume", from}, random.pick(numbers), there), code) << said(there);
      expect_same_frames(alone, out);
    }
    fs::remove_all(at);
  }
}

TEST_F(Together, APieceThatCannotBeWrittenEndsAll) {
  Case what = cut_beam();
  what.scene["output"] = {{"directory", "out"}, {"every", 0.1}, {"pieces", true}};
  const fs::path at = folder_ / "run";
  write_case(what, at);
  fs::create_directories(at / "out" / "frame_0001_1.vtu" / "in the way");
  EXPECT_EQ(run(what, {"scene.json"}, 2, at), 6);
  EXPECT_THAT(said(at), ::testing::HasSubstr("error: process 1 of 2: "));
  EXPECT_THAT(said(at), ::testing::HasSubstr("frame_0001_1.vtu: cannot be"));
  EXPECT_TRUE(fs::exists(at / "out" / "frame_0000.pvtu"));
  EXPECT_FALSE(fs::exists(at / "out" / "frame_0001.pvtu"));
}

}  // namespace
}  // namespace suture::test
