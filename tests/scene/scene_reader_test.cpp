// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/scene_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "kernel/scene/scene_error.hpp"
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

TEST(SceneReader, ReportsAllMistakesAtOnceInTheirOrder) {
  const std::string error = error_of(R"({
  "suture": 1,
  "mesh": {"box": {"size": [1, -1, 1], "cells": [2, 2, 2]}},
  "modles": [],
  "models": [{"model": "jelly", "parameters": {"Nu": 0.3}}],
  "solver": {"dt": 0, "end": "soon"}
})");
  const char* expected[] = {
      "folder/s.json:3:32: /mesh/box/size/1: must be > 0 m, is -1 m",
      "folder/s.json:4:3: /modles: unknown key (did you mean 'models'?)",
      "folder/s.json:5:47: /models/0/parameters: 'E' is missing: E, in Pa",
      "folder/s.json:5:48: /models/0/parameters/Nu: unknown key (did you mean 'nu'?)",
      "folder/s.json:6:20: /solver/dt: must be > 0 s, is 0 s",
      "folder/s.json:6:30: /solver/end: must be a number (s), is the string 'soon'",
      "6 mistakes in folder/s.json"};
  std::size_t from = 0;
  for (const char* line : expected) {
    const std::size_t at = error.find(line, from);
    ASSERT_NE(at, std::string::npos) << "not found, or not in order: " << line << "\n" << error;
    from = at;
  }
}

// One mistake per scene: the JSON after the sound beginning, the place of the
// mistake, words that must be in the message.
struct BadScene {
  const char* more;
  const char* path;
  const char* words;
};

class SceneMistakes : public ::testing::TestWithParam<BadScene> {};

TEST_P(SceneMistakes, AreNamed) {
  const BadScene& bad = GetParam();
  const std::string error = error_of(scene_with(bad.more));
  EXPECT_NE(error.find(std::string(": ") + bad.path + ": "), std::string::npos) << error;
  EXPECT_NE(error.find(bad.words), std::string::npos) << error;
  EXPECT_NE(error.find("\n1 mistake in"), std::string::npos) << error;
}

INSTANTIATE_TEST_SUITE_P(
    All, SceneMistakes,
    ::testing::Values(
        BadScene{R"(, "gravty": [0, 0, 0])", "/gravty", "did you mean 'gravity'"},
        BadScene{R"(, "temperature": 3)", "/temperature", "valid keys: 'suture'"},
        BadScene{R"(, "title": 3)", "/title", "must be a string, is the number 3"},
        BadScene{R"(, "title": "a", "title": "b")", "/title", "duplicate key"},
        BadScene{R"(, "gravity": [0, 0])", "/gravity", "three numbers"},
        BadScene{R"(, "gravity": [0, "x", 0])", "/gravity/1", "must be a number (m/s^2)"},
        BadScene{R"(, "gravity": {"ramp": 1})", "/gravity", "'value' is missing"},
        BadScene{R"(, "gravity": {"value": [0,1,0], "ramp": -1})", "/gravity/ramp", ">= 0 s"},
        BadScene{R"(, "gravity": {"value": [0,1,0], "ramp": {"from": 2, "to": 1}})",
                 "/gravity/ramp/to", "before 'from'"},
        BadScene{R"(, "gravity": {"value": [0,1,0], "ramp": {"to": 1, "shape": "smoth"}})",
                 "/gravity/ramp/shape", "did you mean 'smooth'"},
        BadScene{R"(, "constraints": {})", "/constraints", "must be an array of constraints"},
        BadScene{R"(, "constraints": [{"fix": "xyw", "where": "all"}])", "/constraints/0/fix",
                 "xyw"},
        BadScene{R"(, "constraints": [{"fix": "xx", "where": "all"}])", "/constraints/0/fix",
                 "once"},
        BadScene{R"(, "constraints": [{"fix": "x"}])", "/constraints/0", "'where' is missing"},
        BadScene{R"(, "constraints": [{"where": "all"}])", "/constraints/0",
                 "exactly one of 'fix'"},
        BadScene{R"(, "constraints": [{"fix": "x", "where": "al"}])", "/constraints/0/where",
                 "\"all\""},
        BadScene{R"(, "constraints": [{"fix": "x", "where": {"set": 3}}])",
                 "/constraints/0/where/set", "string"},
        BadScene{R"(, "constraints": [{"fix": "x", "where": {"ids": [-1]}}])",
                 "/constraints/0/where/ids/0", "whole number >= 0"},
        BadScene{R"(, "constraints": [{"fix": "x", "where": {"ids": [1.5]}}])",
                 "/constraints/0/where/ids/0", "whole number >= 0"},
        BadScene{
            R"(, "constraints": [{"fix": "x", "where": {"box": {"min": [0,1,0], "max": [1,0,1]}}}])",
            "/constraints/0/where/box", "larger than 'max' along y"},
        BadScene{R"(, "constraints": [{"fix": "x", "where":
            {"plane": {"point": [0,0,0], "normal": [0,0,0]}}}])",
                 "/constraints/0/where/plane/normal", "direction"},
        BadScene{
            R"(, "constraints": [{"fix": "x", "where": {"sphere": {"centre": [0,0,0], "radius": 0}}}])",
            "/constraints/0/where/sphere/radius", "> 0 m"},
        BadScene{R"(, "constraints": [{"move": {"translation": [1,0,0]}, "where": "all"}])",
                 "/constraints/0", "'ramp' is missing"},
        BadScene{
            R"(, "constraints": [{"move": {"translation": [1,0,0]}, "ramp": 0, "where": "all"}])",
            "/constraints/0/ramp", "longer than 0 s"},
        BadScene{R"(, "constraints": [{"move": {}, "ramp": 1, "where": "all"}])",
                 "/constraints/0/move", "'translation', 'rotation'"},
        BadScene{R"(, "loads": [{"force": [1,0,0], "pressure": 3, "where": "all"}])", "/loads/0",
                 "has 'force', 'pressure'"},
        BadScene{R"(, "events": [{"at": -1, "cut": {"faces": [[0,1]]}}])", "/events/0/at",
                 ">= 0 s"},
        BadScene{R"(, "events": [{"at": 2, "cut": {"faces": [[0,1]]}}])", "/events/0/at",
                 "after the end of the run"},
        BadScene{R"(, "events": [{"at": 0.5}])", "/events/0", "exactly one of 'cut', "},
        BadScene{R"(, "events": [{"at": 0.5, "cut": {"faces": [[1,1]]}}])", "/events/0/cut/faces/0",
                 "twice"},
        BadScene{R"(, "events": [{"at": 0.5, "cut": {"faces": []}}])", "/events/0/cut/faces",
                 "empty"},
        BadScene{
            R"(, "events": [{"at": 0.5, "cut": {"plane": {"point": [0,0,0], "normal": [0,0,0]}}}])",
            "/events/0/cut/plane/normal", "direction"},
        BadScene{R"(, "events": [{"at": 0.5, "cut": {"faces": [[0,1]]}, "shape": "deform"}])",
                 "/events/0/shape", "did you mean 'deformed'"},
        BadScene{R"(, "output": {"every": 0})", "/output/every", "> 0 s"},
        BadScene{R"(, "output": {"every": 1, "every_steps": 1})", "/output", "not both"},
        BadScene{R"(, "output": {"fields": ["displacment"]})", "/output/fields/0",
                 "did you mean 'displacement'"},
        BadScene{R"(, "output": {"fields": ["mass", "mass"]})", "/output/fields/1", "second time"},
        BadScene{R"(, "output": {"compression": "lz5"})", "/output/compression",
                 "did you mean 'lz4'"},
        BadScene{R"(, "output": {"probes": {"at": [{"name": "a b", "point": [0,0,0]}]}})",
                 "/output/probes/at/0/name", "letters"},
        BadScene{R"(, "output": {"probes": {"at": [{"name": "a", "point": [0,0,0]},
                                              {"name": "a", "point": [1,0,0]}]}})",
                 "/output/probes/at/1/name", "earlier probe"},
        BadScene{R"(, "output": {"probes": {"at": [{"name": "a", "point": [0,0,0],
                                               "fields": ["mass", "reacton"]}]}})",
                 "/output/probes/at/0/fields/1", "did you mean 'reaction'"},
        BadScene{R"(, "output": {"probes": {"at": [{"name": "a", "where": "all",
                                               "fields": ["von_mises"]}]}})",
                 "/output/probes/at/0/fields/0",
                 "must be one of 'position', 'displacement', 'velocity'"},
        BadScene{R"(, "output": {"probes": {"at": [{"name": "a", "where": "all",
                                               "fields": ["mass", "mass"]}]}})",
                 "/output/probes/at/0/fields/1", "second time"},
        BadScene{R"(, "output": {"probes": {"at": [{"name": "a", "where": "all", "fields": []}]}})",
                 "/output/probes/at/0/fields", "remove the key"},
        BadScene{
            R"(, "output": {"probes": {"at": [{"name": "a", "where": "all", "fields": "mass"}]}})",
            "/output/probes/at/0/fields", "must be an array of names"},
        BadScene{
            R"(, "output": {"probes": {"at": [{"name": "a", "where": "all", "of": "average"}]}})",
            "/output/probes/at/0/of", "must be one of 'mean', 'sum', 'min', 'max'"},
        BadScene{R"(, "output": {"fields": ["position"]})", "/output/fields/0", "must be one of"},
        BadScene{R"(, "output": true, "solve": 1)", "/solve", "did you mean 'solver'"}));

// For programs that show mistakes themselves.
TEST(SceneMistakeList, NamesPathLineAndSet) {
  try {
    read("{\"suture\": 1,\n\"solve\": 1}", {"/gravity=3"});
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.mistakes().size(), 5u) << error.what();
    const auto has = [&](const char* path, std::uint32_t line, const char* set) {
      return std::ranges::any_of(error.mistakes(), [&](const SceneMistake& m) {
        return m.path == path && m.line == line && m.set == set && !m.text.empty();
      });
    };
    EXPECT_TRUE(has("/solve", 2, ""));
    EXPECT_TRUE(has("", 1, ""));
    EXPECT_TRUE(has("/gravity", 0, "/gravity=3"));
  }
  try {
    read("{\n \"suture\": }");
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.mistakes().size(), 1u);
    EXPECT_EQ(error.mistakes()[0].line, 2u);
  }
}

// The same for parts that the sound beginning has already: set to what is bad.
struct BadSet {
  const char* set;
  const char* path;
  const char* words;
};
class SceneSetMistakes : public ::testing::TestWithParam<BadSet> {};

TEST_P(SceneSetMistakes, AreNamed) {
  const BadSet& bad = GetParam();
  const std::string error = error_of(scene_with(""), {bad.set});
  EXPECT_NE(error.find(std::string("--set '") + bad.set + "': " + bad.path), std::string::npos)
      << error;
  EXPECT_NE(error.find(bad.words), std::string::npos) << error;
  EXPECT_NE(error.find("\n1 mistake in"), std::string::npos) << error;
}

INSTANTIATE_TEST_SUITE_P(
    All, SceneSetMistakes,
    ::testing::Values(
        BadSet{"/solver/dt=-1e-4", "/solver/dt", "must be > 0 s, is -1e-04 s"},
        BadSet{"/solver/dt=2", "/solver/dt", "longer than the whole run"},
        BadSet{"/solver/dt=fast", "/solver/dt", "\"auto\""},
        BadSet{"/solver/dtt=1", "/solver/dtt", "did you mean 'dt'"},
        BadSet{"/slover/dt=1", "/slover", "did you mean 'solver'"},
        BadSet{"/solver/threads=-1", "/solver/threads", "whole number >= 0"},
        BadSet{"/solver/integrator=verlet", "/solver/integrator", "'velocity-verlet'"},
        BadSet{"/solver/safety=1.5", "/solver/safety", "<= 1"},
        BadSet{"/solver/damping=auto", "/solver/damping", "until"},
        BadSet{"/solver/tolerance=1e-3", "/solver/tolerance", "until"},
        BadSet{"/solver/kick=1e-3", "/solver/kick", "until"},
        BadSet{"/solver={}", "/solver", "has no end"},
        BadSet{"/suture=3", "/suture", "reads versions 1 and 2"},
        BadSet{"/mesh={}", "/mesh", "exactly one of 'box', 'file', 'voxels', 'surface'"},
        BadSet{"/mesh/cells=9", "/mesh/cells", "is only allowed where a body is filled"},
        BadSet{"/mesh={\"surface\": \"nowhere.stl\", \"cells\": 9}", "/mesh/surface", "no file"},
        BadSet{"/mesh/scale=2", "/mesh/scale", "is only allowed with 'file'"},
        BadSet{"/mesh/pinched=spilt", "/mesh/pinched", "did you mean 'split'"},
        BadSet{"/mesh/bad_elements=dropp", "/mesh/bad_elements", "did you mean 'drop'"},
        BadSet{"/mesh={\"file\": \"nowhere.vtu\"}", "/mesh/file", "no file"},
        BadSet{"/mesh/box/cells/0=0", "/mesh/box/cells/0", ">= 1"},
        BadSet{"/mesh/box/cells=[100000,100000,100000]", "/mesh/box/cells", "at most 178956970"},
        BadSet{"/mesh={\"voxels\": {\"size\": 1, \"rows\": [\"..\"]}}", "/mesh/voxels/rows",
               "no cube"},
        BadSet{"/models=[]", "/models", "at least one"},
        BadSet{"/models/0/model=jely", "/models/0/model", "did you mean 'jelly'"},
        BadSet{"/models/0/name=a/b", "/models/0/name", "letters"},
        BadSet{"/models/0/parameters/E=-1", "/models/0/parameters/E", "must be > 0 Pa, is -1 Pa"},
        BadSet{"/models/0/parameters/E=stiff", "/models/0/parameters/E", "must be a number (Pa)"},
        BadSet{"/models/0/parameters/nu=0.5", "/models/0/parameters/nu",
               "must be > -1 and < 0.5, is 0.5"},
        BadSet{"/models/0/parameters/order=2.5", "/models/0/parameters/order", "whole number"},
        BadSet{"/models/0/parameters/correction=1", "/models/0/parameters/correction",
               "true or false"},
        BadSet{"/models/0/parameters/quadrature=gauss3", "/models/0/parameters/quadrature",
               "did you mean 'gauss2'"},
        BadSet{"/models/0/on_inversion=wurn", "/models/0/on_inversion", "did you mean 'warn'"},
        BadSet{"/plugins=[\"x.so\"]", "/plugins/0", "no plugin file"}));

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
