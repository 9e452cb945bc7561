// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

using BadScenes = Program;

TEST_F(BadScenes, FilesThatCannotBeRead) {
  const Outcome missing = suture({"run", "nowhere.json"});
  EXPECT_EQ(missing.code, 6) << missing;
  EXPECT_TRUE(missing.says("nowhere.json") && missing.says("No such file")) << missing;
  const Outcome directory = suture({"run", "."});
  EXPECT_EQ(directory.code, 6) << directory;
  EXPECT_TRUE(directory.says("folder")) << directory;
}

TEST_F(BadScenes, SyntaxErrorsHaveALineAndAHint) {
  write("empty.json", "");
  write("comma.json", "{\n  \"suture\": 1,\n}\n");
  write("binary.json", std::string("\x7f\x45\x4c\x46\0\0\1", 7));
  EXPECT_EQ(suture({"run", "empty.json"}).code, 3);
  const Outcome comma = suture({"run", "comma.json"});
  EXPECT_EQ(comma.code, 3) << comma;
  EXPECT_TRUE(comma.says("comma.json:3:1: ") && comma.says("one too many")) << comma;
  EXPECT_EQ(suture({"run", "binary.json"}).code, 3);
}

TEST_F(BadScenes, FiveMistakesAreToldAtOnceAndNothingRuns) {
  const Outcome five = scene("run", R"(,
  "gravty": [0, -9.8, 0],
  "constraints": [{"fix": "xyz", "were": {"set": "x0"}}],
  "events": [{"at": 1, "cut": {"faces": [[0, 1]]}}],
  "output": {"fields": ["strss"]})");
  EXPECT_EQ(five.code, 3) << five;
  for (const char* words : {"s.json:6:3: /gravty", "'gravity'", "s.json:7:34: /constraints/0/were",
                            "'where' is missing", "s.json:8:21: /events/0/at",
                            "s.json:9:25: /output/fields/0", "'stress'", "5 mistakes"}) {
    EXPECT_TRUE(five.says(words)) << words << five;
  }
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

struct BadValue {
  const char* set;
  int code;
  const char* words;
};

// What other programs run with all the same: a misspelt model or parameter, values
// out of range, nothing to run on.
TEST_F(BadScenes, WhatOthersRunWithAllTheSame) {
  const BadValue values[] = {
      {"/models/0/model=tm-fauer", 4, "tm-faure"},
      {"/models/0/parameters/young=5", 3, "unknown key"},
      {"/models/0/parameters/Nu=0.3", 3, "did you mean 'nu'"},
      {"/models/0/parameters/E=-5000", 3, "must be > 0 Pa, is -5000 Pa"},
      {"/models/0/parameters/E=abc", 3, "must be a number (Pa)"},
      {"/models/0/parameters/nu=0.7", 3, "< 0.5, is 0.7"},
      {"/models/0/parameters/nu=0.5", 3, "< 0.5, is 0.5"},
      {"/models/0/parameters/quadrature=gauss3", 3, "did you mean 'gauss2'"},
      {"/models/0/parameters/rho=0", 3, "> 0 kg/m^3"},
      {"/constraints=[{\"fix\": \"xyz\", \"where\": {\"ids\": [99]}}]", 3, "99"},
      {"/constraints=[{\"fix\": \"xyz\", \"where\": {\"set\": \"x2\"}}]", 3, "x2"},
      {"/constraints=[{\"fix\": \"xyz\", \"where\": {\"sphere\": {\"centre\": [9, 9, 9], "
       "\"radius\": 1}}}]",
       3, "/constraints/0/where"},
      {"/solver/dt=0", 3, "must be > 0 s"},
      {"/solver/dt=-1e-3", 3, "must be > 0 s"},
      {"/solver/end=0", 3, "> 0 s"},
      {"/models=[]", 3, "at least one model"},
      {"/mesh={}", 3, "exactly one of"},
      {"/mesh/file=nowhere.vtu", 3, "exactly one of"},
      {"/mesh={\"file\": \"nowhere.vtu\"}", 3, "no file"},
      {"/plugins=[\"nowhere.so\"]", 4, "nowhere"},
      {"/events=[{\"at\": 0.005, \"cut\": {\"faces\": [[0, 99]]}}]", 3, "99"},
      {"/events=[{\"at\": 0.005, \"cut\": {\"faces\": [[0, 7]]}}]", 3, "7"},
      {"solver/dt=1", 2, "/PATH/TO/KEY=VALUE"},
      {"/solver/dt/x=1", 2, "inside the number"}};
  for (const BadValue& value : values) {
    const Outcome outcome = scene("run", "", {value.set});
    EXPECT_EQ(outcome.code, value.code) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says(value.words)) << value.set << "\n" << outcome;
    EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << value.set;
    const Outcome checked = scene("check", "", {value.set});
    EXPECT_EQ(checked.code, value.code) << "check " << value.set << "\n" << checked;
  }
}

TEST_F(BadScenes, PluginsThatAreNone) {
  write("text.so", "this is no library");
  const Outcome text = scene("run", ", \"plugins\": [\"text.so\"]");
  EXPECT_EQ(text.code, 4) << text;
  EXPECT_TRUE(text.says("text.so")) << text;
}

TEST_F(BadScenes, OverlappingModelsShareElementsAndGapsAreTold) {
  const Outcome gap = scene("run", "",
                            {"/models/0/region={\"half_space\": {\"point\": [0.5, 0, 0], "
                             "\"normal\": [1, 0, 0]}}"});
  // Elements without a model have no mass: nothing can be said of their motion.
  EXPECT_EQ(gap.code, 3) << gap;
}

}  // namespace
}  // namespace suture::testing
