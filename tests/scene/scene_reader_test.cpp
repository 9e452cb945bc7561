// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/scene_reader.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "tests/scene/fake_model.hpp"

namespace suture::testing {
namespace {

TEST(SceneReader, ReadsEveryKey) {
  const Scene scene = read(R"({
    // comments are welcome
    "suture": 1, "title": "all of it",
    "mesh": {"box": {"origin": [1, 2, 3], "size": [1, 0.5, 0.25], "cells": [4, 2, 1],
                     "grading": [2, 1, 1]}, "pinched": "refuse", "allow_inverted_rest": true,
             "bad_elements": "drop", "renumber": false},
    "models": [
      {"model": "jelly", "name": "soft", "region": {"half_space": {"point": [1.5, 0, 0],
       "normal": [-1, 0, 0]}}, "parameters": {"E": 1e3, "nu": 0.45, "order": 3,
       "correction": false, "quadrature": "exact"}},
      {"model": "jelly", "on_inversion": "stop", "parameters": {"E": 5}},
      {"model": "jelly", "parameters": {"E": 6}}],
    "gravity": {"value": [0, -9.8, 0], "ramp": {"from": 0.1, "to": 0.5, "shape": "smooth"}},
    "constraints": [
      {"fix": "xz", "where": {"plane": {"point": [1, 0, 0], "normal": [1, 0, 0]}}},
      {"move": {"translation": [0, 0.1, 0], "rotation": {"axis": [1, 0, 0], "angle": 90,
       "centre": [0, 0, 1]}}, "ramp": 0.5, "where": {"set": "x1"}}],
    "loads": [{"force": [1, 0, 0], "where": {"nearest": [2, 2, 3]}},
              {"traction": [0, 2, 0], "where": {"sphere": {"centre": [1, 2, 3], "radius": 2}}},
              {"pressure": 3, "ramp": 0.25, "where": {"ids": [4, 5]}}],
    "solver": {"integrator": "velocity-verlet", "dt": 1e-3, "end": 2, "damping": 0.5, "threads": 2,
               "on_inversion": "warn", "max_steps": 1000},
    "divisible": true,
    "events": [{"at": 1.5, "cut": {"faces": [[0, 1], [2, 3]]}},
               {"at": 0.5, "cut": {"plane": {"point": [1.5, 0, 0], "normal": [1, 0, 0]}},
                "shape": "rest"}],
    "output": {"directory": "d", "every": 0.1, "fields": ["velocity", "wobble"],
               "compression": "zlib", "energies": {"every_steps": 10}, "cuts": true,
               "probes": {"every_steps": 5, "at": [{"name": "tip", "point": [2, 2, 3]},
                                                   {"name": "end", "where": {"set": "x1"},
                                                    "fields": ["position", "wobble"],
                                                    "of": "max"}]}}})");
  EXPECT_EQ(scene.title, "all of it");
  EXPECT_TRUE(scene.divides_elements());
  EXPECT_EQ(scene.mesh.box->origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(scene.mesh.box->cells, (std::array<Index, 3>{4, 2, 1}));
  EXPECT_EQ(scene.mesh.box->grading[0], 2);
  EXPECT_EQ(scene.mesh.import.non_manifold, ImportOptions::NonManifold::refuse);
  EXPECT_TRUE(scene.mesh.import.allow_inverted_rest);
  EXPECT_TRUE(scene.mesh.drop_bad_elements);
  EXPECT_FALSE(scene.mesh.import.renumber);
  ASSERT_EQ(scene.models.size(), 3u);
  EXPECT_EQ(scene.models[0].parameters, (std::vector<double>{1e3, 0.45, 3, 0, 0}));
  EXPECT_EQ(scene.models[1].parameters, (std::vector<double>{5, 0.3, 2, 1, 1}));
  EXPECT_EQ(scene.models[0].name, "soft");
  EXPECT_EQ(scene.models[1].name, "jelly");
  EXPECT_EQ(scene.models[2].name, "jelly-2");
  EXPECT_EQ(scene.models[1].on_inversion, OnInversion::stop);
  EXPECT_EQ(scene.models[2].on_inversion, OnInversion::by_model);
  EXPECT_TRUE(std::holds_alternative<Selection::HalfSpace>(scene.models[0].region.what));
  EXPECT_EQ(scene.gravity[1], -9.8);
  EXPECT_TRUE(scene.gravity_ramp.smooth);
  ASSERT_EQ(scene.constraints.size(), 2u);
  EXPECT_EQ(scene.constraints[0].components, 5);
  EXPECT_EQ(scene.constraints[0].where.path, "/constraints/0/where");
  EXPECT_LT(std::get<Selection::Plane>(scene.constraints[0].where.what).tolerance, 0);
  EXPECT_TRUE(scene.constraints[1].moves);
  EXPECT_DOUBLE_EQ(scene.constraints[1].angle, std::numbers::pi / 2);
  EXPECT_EQ(scene.constraints[1].ramp.to, 0.5);
  ASSERT_EQ(scene.loads.size(), 3u);
  EXPECT_EQ(scene.loads[1].kind, Load::Kind::traction);
  EXPECT_EQ(scene.loads[2].pressure, 3);
  EXPECT_EQ(std::get<Selection::Ids>(scene.loads[2].where.what).ids.size(), 2u);
  EXPECT_EQ(scene.solver.integrator, "velocity-verlet");
  EXPECT_EQ(scene.solver.dt, 1e-3);
  EXPECT_EQ(scene.solver.max_steps, 1000u);
  EXPECT_EQ(scene.solver.on_inversion, OnInversion::warn);
  ASSERT_EQ(scene.events.size(), 2u);
  EXPECT_EQ(scene.events[0].at, 0.5);  // sorted by time
  EXPECT_EQ(scene.events[0].path, "/events/1");
  EXPECT_TRUE(scene.events[0].rest_shape);
  EXPECT_EQ(std::get<CutFaces>(scene.events[1].what).element_pairs[1],
            (std::array<std::uint64_t, 2>{2, 3}));
  EXPECT_TRUE(scene.output.directory.is_absolute());
  EXPECT_EQ(scene.output.fields, (std::vector<std::string>{"velocity", "wobble"}));
  EXPECT_EQ(scene.output.compression, OutputOptions::Compression::zlib);
  EXPECT_EQ(scene.output.energies_every, 10u);
  ASSERT_EQ(scene.output.probes.size(), 2u);
  EXPECT_EQ(scene.output.probes[0].name, "tip");
  EXPECT_TRUE(scene.output.probes[0].at_point);
  EXPECT_TRUE(scene.output.probes[0].fields.empty());
  EXPECT_FALSE(scene.output.probes[0].of);
  EXPECT_FALSE(scene.output.probes[1].at_point);
  EXPECT_EQ(scene.output.probes[1].fields, (std::vector<std::string>{"position", "wobble"}));
  EXPECT_EQ(scene.output.probes[1].of, Probe::Of::max);
}

TEST(SceneReader, FillsInDefaults) {
  const Scene scene = read(scene_with(""));
  EXPECT_EQ(scene.gravity, (Vec3{0, 0, 0}));
  EXPECT_FALSE(scene.solver.dt);
  EXPECT_EQ(scene.output.directory, std::filesystem::current_path() / "out" / "s");
  EXPECT_EQ(scene.output.fields, std::vector<std::string>{"displacement"});
  EXPECT_TRUE(scene.output.enabled);
  EXPECT_FALSE(read(scene_with(", \"output\": false")).output.enabled);
}

TEST(SceneReader, NamesOfModelsMustDiffer) {
  const std::string error =
      error_of(scene_with(""), {"/models/-={\"model\": \"jelly\", \"name\": \"jelly\", "
                                "\"parameters\": {\"E\": 1}}"});
  EXPECT_NE(error.find("/models/1/name: 'jelly' is already the name of an earlier model"),
            std::string::npos)
      << error;
}

TEST(SceneReader, ExitCodeReportsPluginsFromScenes) {
  try {
    read(scene_with(""), {"/models/0/model=none"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 4);
  }
  try {
    read(scene_with(""), {"/models/0/model=none", "/solver/end=0"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 3);
  }
}

TEST(SceneReader, SetsChangeTheSceneAndItsHash) {
  const std::string text = scene_with("");
  const Scene scene = read(text, {"/solver/dt=1e-4", "/output/energies/every_steps=3",
                                  "/title=a bare string", "/solver/end=0.5"});
  EXPECT_EQ(scene.solver.dt, 1e-4);
  EXPECT_EQ(scene.output.energies_every, 3u);
  EXPECT_EQ(scene.title, "a bare string");
  EXPECT_EQ(scene.solver.end, 0.5);
  EXPECT_NE(scene.hash, read(text).hash);
  EXPECT_EQ(read(text).hash, read("// comment\n " + text + "\n").hash);
  EXPECT_EQ(read(text).hash, read(text, {"/solver/end=1.0"}).hash);
  EXPECT_EQ(read(text).hash, read(text, {"/output/directory=elsewhere"}).hash);
}

TEST(SceneReader, SetsAppendToWhatIsNotThereYet) {
  const std::string cut = R"({"at": 0.5, "cut": {"faces": [[0, 1]]}})";
  const Scene scene = read(scene_with(""), {"/events/-=" + cut, "/events/-=" + cut,
                                            "/events/-/at=0.25", "/events/2/cut/faces=[[2, 3]]"});
  ASSERT_EQ(scene.events.size(), 3u);
  EXPECT_EQ(scene.events[0].at, 0.25);  // they are put in order of time
  EXPECT_EQ(scene.events[2].at, 0.5);
}

TEST(SceneReader, SetsThatLeadNowhereAreUsageErrors) {
  for (const char* set :
       {"solver/dt=1", "/solver/dt", "", "/title/x=1", "/models/7/name=a", "/models/x/name=a"}) {
    EXPECT_THROW(read(scene_with(", \"title\": \"t\""), {set}), UsageError) << set;
  }
  EXPECT_THROW(read(scene_with(""), {"/solver={\"dt\": }"}), InputError);
}

TEST(SceneReader, WarnsOfRampsThatOutliveTheRun) {
  Diagnostics diagnostics;
  read_scene_text(scene_with(R"(, "gravity": {"value": [0, -1, 0], "ramp": 3})"), "s.json", {},
                  jelly_only(), diagnostics);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("/gravity"), std::string::npos);
}

TEST(SceneReader, SuggestsFilesOfTheFolder) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "suture-scene";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "beam.vtu") << "x";
  Diagnostics diagnostics;
  try {
    read_scene_text(scene_with(""), folder / "s.json", {"/mesh={\"file\": \"baem.vtu\"}"},
                    jelly_only(), diagnostics);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'beam.vtu'"), std::string::npos)
        << error.what();
  }
  std::filesystem::remove_all(folder);
}

TEST(SceneReader, ReadsWhenToWriteCheckpoints) {
  const auto options = [](const std::string& text) {
    return read(scene_with(text.empty() ? "" : ", \"checkpoint\": " + text)).checkpoint;
  };
  EXPECT_FALSE(options("").enabled);
  const CheckpointOptions plain = options("{}");
  EXPECT_TRUE(plain.enabled);
  EXPECT_EQ(plain.every_steps, 0u);
  EXPECT_EQ(plain.every, 0);
  EXPECT_EQ(plain.minutes, 0);
  EXPECT_EQ(plain.keep, 2u);
  EXPECT_EQ(options(R"({"every_steps": 100, "keep": 1})").every_steps, 100u);
  EXPECT_EQ(options(R"({"every": 0.25})").every, 0.25);
  EXPECT_EQ(options(R"({"minutes": 0.5, "keep": 7})").minutes, 0.5);
  EXPECT_EQ(options(R"({"minutes": 0.5, "keep": 7})").keep, 7u);
}

TEST(SceneReader, RefusesCheckpointsThatCannotBe) {
  const auto error = [](const std::string& text) {
    const std::string all = error_of(scene_with(", \"checkpoint\": " + text));
    return all.substr(std::min(all.find(" /checkpoint"), all.size()));
  };
  EXPECT_EQ(error("true"),
            " /checkpoint: must be an object { ... }, is true\n1 mistake in folder/s.json");
  EXPECT_NE(error(R"({"keep": 0})").find("/checkpoint/keep: must be"), std::string::npos);
  EXPECT_NE(error(R"({"every_steps": 0})").find("/checkpoint/every_steps: must be"),
            std::string::npos);
  EXPECT_NE(error(R"({"minutes": -1})").find("must be > 0 min, is -1 min"), std::string::npos);
  EXPECT_NE(error(R"({"every_step": 1})").find("unknown key (did you mean 'every_steps'?)"),
            std::string::npos);
  EXPECT_NE(error(R"({"every": 1, "minutes": 1})")
                .find("/checkpoint: must have at most one of 'every_steps', 'every' (s of "
                      "simulated time) and 'minutes' (wall-clock time)"),
            std::string::npos);
  EXPECT_NE(error(R"({}, "output": false)")
                .find("/checkpoint: needs an output folder, but \"output\" is false; add an output "
                      "or remove the checkpoint"),
            std::string::npos);
}

TEST(SceneReader, ASourceReadsAsTheSameSceneInAnyFolder) {
  namespace fs = std::filesystem;
  const fs::path before = fs::current_path();
  const fs::path folder = fs::path(::testing::TempDir()) / "suture-source";
  fs::create_directories(folder / "elsewhere");
  std::ofstream(folder / "beam.vtu") << "x";
  fs::current_path(folder);
  Diagnostics diagnostics;
  const Scene scene = read_scene_text(
      scene_with(R"(, "gravity": [-0.0, 0.1, -9.81] // comment
)"),
      "s.json", {"/mesh={\"file\": \"beam.vtu\"}", "/title=a \"title\"", "/checkpoint={}"},
      jelly_only(), diagnostics);
  fs::current_path("elsewhere");
  try {
    read_scene_source(scene.source, {}, jelly_only(), diagnostics);
    ADD_FAILURE() << "its output would lie outside";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(":1:1: /output: leads out of"), std::string::npos)
        << error.what();
  }
  SceneSource source = scene.source;
  source.resumed_folder = scene.output.directory;
  const Scene again = read_scene_source(source, {}, jelly_only(), diagnostics);
  EXPECT_EQ(again.hash, scene.hash);
  EXPECT_EQ(again.source.text, scene.source.text);
  EXPECT_EQ(again.title, "a \"title\"");
  EXPECT_EQ(again.file, scene.file);
  EXPECT_EQ(again.mesh.file, scene.mesh.file);
  EXPECT_EQ(again.mesh.file.filename(), "beam.vtu");
  EXPECT_EQ(again.output.directory, scene.output.directory);
  EXPECT_TRUE(std::signbit(again.gravity[0]));
  EXPECT_TRUE(again.checkpoint.enabled);
  EXPECT_EQ(read_scene_source(source, {"/solver/end=7"}, jelly_only(), diagnostics).solver.end, 7);
  fs::remove(folder / "beam.vtu");
  try {
    read_scene_source(source, {}, jelly_only(), diagnostics);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("s.json (as it was run):1:"), std::string::npos)
        << error.what();
  }
  fs::current_path(before);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace suture::testing
