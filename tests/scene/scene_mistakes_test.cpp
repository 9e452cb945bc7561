// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scenes with mistakes: each is named with its place, what was expected and the nearest valid name.
#include <gtest/gtest.h>

#include <algorithm>

#include "kernel/scene/scene_error.hpp"
#include "tests/scene/fake_model.hpp"

namespace suture::testing {
namespace {

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
        BadScene{R"(, "constraints": [{"fix": "x", "components": "x", "where": "all"}])",
                 "/constraints/0/components", "only allowed with 'move'"},
        BadScene{R"(, "constraints": [{"move": {"translation": [1, 2, 0]}, "components": "x",
                 "ramp": 1, "where": "all"}])",
                 "/constraints/0/components", "leaves y free, but the motion changes it"},
        BadScene{R"(, "constraints": [{"move": {"rotation": {"axis": [1, 0, 0], "angle": 3}},
                 "components": "xy", "ramp": 1, "where": "all"}])",
                 "/constraints/0/components", "leaves z free, but the motion changes it"},
        BadScene{R"(, "constraints": [{"move": {"translation": [1, 0, 0]}, "components": "w",
                 "ramp": 1, "where": "all"}])",
                 "/constraints/0/components", "each once"},
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
        BadSet{"/mesh/box/cells=[100000,100000,100000]", "/mesh/box/cells", "at most 67108863"},
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
        BadSet{"/solver/on_failure=skim", "/solver/on_failure", "did you mean 'skip'"},
        BadSet{"/debris={\"below\": 0}", "/debris/below", "must be > 0"},
        BadSet{"/debris={\"below\": 0.1, \"volume\": 1e-9}", "/debris/volume",
               "cannot be combined"},
        BadSet{"/debris={\"do\": \"remove\", \"bellow\": 0.1}", "/debris/bellow",
               "did you mean 'below'"},
        BadSet{"/debris={\"do\": \"freeze\"}", "/debris/do", "must be one of 'remove', 'keep'"},
        BadSet{"/models/0/on_inversion=wurn", "/models/0/on_inversion", "did you mean 'warn'"},
        BadSet{"/plugins=[\"x.so\"]", "/plugins/0", "no plugin file"}));

}  // namespace
}  // namespace suture::testing
