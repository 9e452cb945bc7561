// SPDX-License-Identifier: GPL-3.0-or-later
//
// tests/house/outside.cmake builds, checks and runs them. The law is an example that other tests
// use.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>

#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

using NewModel = Program;

TEST_F(NewModel, WritesAFolderAndPrintsThreeCommands) {
  const Outcome outcome = suture({"-q", "new-model", "my-own-law"});
  EXPECT_EQ(outcome.code, 0) << outcome;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 3) << outcome;
  for (const char* command : {"cmake -S my-own-law -B my-own-law/build", "ctest --test-dir",
                              "suture run my-own-law/scene.json"})
    EXPECT_TRUE(outcome.says(command)) << outcome;
  std::ifstream example(SUTURE_SOURCES "/tests/sdk/neo_hooke.cpp");
  std::string law{std::istreambuf_iterator<char>(example), {}};
  law = std::regex_replace(law, std::regex("NeoHooke"), "MyOwnLaw");
  law = std::regex_replace(law, std::regex("neo-hooke"), "my-own-law");
  EXPECT_EQ(read("my-own-law/model.cpp"), law);
  for (const char* name : {"CMakeLists.txt", "README.md", "model.cpp", "scene.json"})
    EXPECT_EQ(read(std::string("my-own-law/") + name).find('@'), std::string::npos) << name;
}

TEST_F(NewModel, IsReadyForGitAndItsChecks) {
  ASSERT_EQ(suture({"-q", "new-model", "kept"}).code, 0);
  EXPECT_EQ(read("kept/.gitignore"), "build/\nout/\n");
  const std::string workflow = read("kept/.github/workflows/check.yml");
  for (const char* step : {"cmake --build build", "ctest --test-dir build", "vars.SUTURE"})
    EXPECT_NE(workflow.find(step), std::string::npos) << step;
}

TEST_F(NewModel, HasALevelForEveryKindOfCell) {
  struct Level {
    const char *name, *file, *words;
  };
  const Level levels[] = {
      {"springs", "model.cpp", "on_edges"},    {"nodes", "model.cpp", "on_vertices"},
      {"faces", "model.cpp", "on_faces"},      {"field", "model.cpp", "vertex_field"},
      {"constraint", "model.cpp", "C^2"},      {"lips", "model.cpp", "on_lips"},
      {"batches", "model.cpp", "SUTURE_EDGE"}, {"c", "model.c", "SUTURE_VERTEX"}};
  for (const auto& [name, file, words] : levels) {
    const std::string folder = std::string("my-") + name + "/";
    EXPECT_EQ(suture({"new-model", std::string("my-") + name, "--kind", name}).code, 0) << name;
    EXPECT_NE(read(folder + file).find(words), std::string::npos) << name;
    EXPECT_NE(read(folder + "CMakeLists.txt").find(file), std::string::npos) << name;
    for (const char* written : {"CMakeLists.txt", "README.md", "scene.json", file})
      EXPECT_EQ(read(folder + written).find('@'), std::string::npos) << name << ", " << written;
  }
}

TEST_F(NewModel, MistakesWriteNothing) {
  struct Wrong {
    std::vector<std::string> arguments;
    int code;
    const char* words;
  };
  std::filesystem::create_directory(folder() / "taken");
  const Wrong wrong[] = {{{}, 2, "name"},
                         {{"My model"}, 2, "is 'My model', try 'my-model'"},
                         {{"a/b"}, 2, "try 'b'"},
                         {{"../up"}, 2, "try 'up'"},
                         {{"7"}, 2, "try 'my-model'"},
                         {{std::string(64, 'a')}, 2, "at most 63"},
                         {{"taken"}, 2, "taken exists already"},
                         {{"tm-faure"}, 2, "there is a model 'tm-faure' already"},
                         {{"x", "--level", "lwa"}, 2, "did you mean 'law'?"},
                         {{"x", "-o", "missing"}, 6, "missing/x"}};
  for (const Wrong& use : wrong) {
    std::vector<std::string> arguments{"new-model"};
    arguments.insert(arguments.end(), use.arguments.begin(), use.arguments.end());
    const Outcome outcome = suture(arguments);
    EXPECT_EQ(outcome.code, use.code) << use.words << outcome;
    EXPECT_TRUE(outcome.says(use.words)) << use.words << outcome;
    EXPECT_FALSE(std::filesystem::exists(folder() / "x"));
  }
}

}  // namespace
}  // namespace suture::testing
