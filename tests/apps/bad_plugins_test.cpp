// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>

#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

using BadPlugins = Program;

struct Refused {
  const char* file;
  const char* words;
};

// The plugins with one defect each of tests/plugin_host, named by a scene.
TEST_F(BadPlugins, AreRefusedWithExitCode4AndTheReason) {
  const Refused plugins[] = {
      {"other-major", "ABI 7.0"},        {"no-note", "no Suture note"},
      {"no-symbol", "suture_plugin_v1"}, {"undefined-symbol", "nobody_defines_this"},
      {"two-models", "occurs twice"},    {"throwing", "throwing"},
      {"missing", "missing.so"}};
  for (const Refused& plugin : plugins) {
    const std::string file = std::string(TEST_PLUGINS) + "/" + plugin.file + ".so";
    const Outcome run = scene("run", "",
                              {"/plugins=[\"" + file + "\"]",
                               std::string("/models/0={\"model\": \"") + plugin.file + "\"}"});
    EXPECT_EQ(run.code, 4) << plugin.file << "\n" << run;
    EXPECT_TRUE(run.says(plugin.words)) << plugin.file << "\n" << run;
    EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << plugin.file;
  }
}

struct Failure {
  const char* how;
  int code;
  std::vector<const char*> words;
};

#define FAILING \
  "plugin 'failing'", "model 'failing'", "functor 'parallelepipeds'", "of elements 0 to 7"

TEST_F(BadPlugins, ModelsThatFailInTheRunStopItWithAMessage) {
  const Failure failures[] = {
      {"never", 0, {"finished"}},
      {"nan", 5, {"finite"}},
      {"throw", 4, {FAILING, "threw an exception (the law has lost its way)", "suture::stop()"}},
      {"throw-int", 4, {FAILING, "does not derive from std::exception", "suture::stop()"}},
      {"stop", 4, {FAILING, "the law asks to stop"}}};
  for (const Failure& failure : failures) {
    const Outcome run =
        scene("run", ", \"gravity\": [0, -9.8, 0]",
              {std::string("/plugins=[\"") + FAILING_PLUGIN + "\"]",
               std::string("/models/0={\"model\": \"failing\", \"parameters\": {\"rho\": 1000, "
                           "\"how\": \"") +
                   failure.how + "\"}}"});
    EXPECT_EQ(run.code, failure.code) << failure.how << "\n" << run;
    for (const char* words : failure.words)
      EXPECT_TRUE(run.says(words)) << failure.how << "\n" << run;
  }
}

/// The constructor of this plugin crashes if SUTURE_TEST_MISTAKE says so: it shows who loads it.
TEST_F(BadPlugins, CheckAndExplainRunNoCodeThatOnlyTheSceneNames) {
  const std::vector<std::string> sets{
      std::string("/plugins=[\"") + TEST_PLUGINS + "/mistakes.so\"]",
      R"(/models/0={"model": "mistakes"})"};
  setenv("SUTURE_TEST_MISTAKE", "loading-exits", 1);
  for (const char* command : {"check", "explain"}) {
    const Outcome outcome = scene(command, "", sets);
    EXPECT_EQ(outcome.code, 4) << outcome;
    for (const char* words :
         {"mistakes", "outside the search path", "--trust", "SUTURE_PLUGIN_PATH"})
      EXPECT_TRUE(outcome.says(words)) << outcome;
    EXPECT_FALSE(outcome.says("called exit()")) << outcome;
  }
  EXPECT_TRUE(scene("run", "", sets).says("called exit()"));
  unsetenv("SUTURE_TEST_MISTAKE");
  EXPECT_EQ(scene("run", "", sets).code, 0);
  std::vector<std::string> trusting{"check", "s.json", "--trust"};
  for (const std::string& set : sets) trusting.insert(trusting.end(), {"--set", set});
  EXPECT_EQ(suture(trusting).code, 0);
  setenv("SUTURE_PLUGIN_PATH", TEST_PLUGINS, 1);
  EXPECT_EQ(scene("check", "", sets).code, 0);
  unsetenv("SUTURE_PLUGIN_PATH");
}

TEST_F(BadPlugins, DamagedFilesOnTheSearchPathAreNamedWhereAModelIsMissing) {
  std::filesystem::create_directory(folder() / "plugins");
  write("plugins/mistakes.so", Program::read(TEST_PLUGINS "/mistakes.so").substr(0, 3000));
  write("plugins/text.so", "no library");
  setenv("SUTURE_PLUGIN_PATH", (folder() / "plugins").c_str(), 1);
  for (const char* command : {"check", "run"}) {
    const Outcome outcome = scene(command, "", {R"(/models/0={"model": "mistake"})"});
    EXPECT_EQ(outcome.code, 4) << outcome;
    for (const char* words : {"plugins/mistakes.so: it is truncated", "plugins/text.so: it is not"})
      EXPECT_TRUE(outcome.says(words)) << outcome;
  }
  // A damaged build beside a good one is passed over, with a warning.
  std::filesystem::copy(TEST_PLUGINS "/mistakes.so", folder() / "plugins",
                        std::filesystem::copy_options::overwrite_existing);
  write("plugins/mistakes.avx2.so", "no library");
  const Outcome outcome = scene("check", "", {R"(/models/0={"model": "mistakes"})"});
  EXPECT_EQ(outcome.code, 0) << outcome;
  EXPECT_TRUE(outcome.says("mistakes.avx2.so is refused")) << outcome;
  EXPECT_TRUE(outcome.says("mistakes.so is used instead")) << outcome;
  unsetenv("SUTURE_PLUGIN_PATH");
}

}  // namespace
}  // namespace suture::testing
