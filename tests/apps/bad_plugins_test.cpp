// SPDX-License-Identifier: GPL-3.0-or-later
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
  const char* words;
};

TEST_F(BadPlugins, ModelsThatFailInTheRunStopItWithAMessage) {
  const Failure failures[] = {{"never", 0, "finished"},
                              {"nan", 5, "finite"},
                              {"throw", 5, "the law has lost its way"},
                              {"stop", 5, "the law asks to stop"}};
  for (const Failure& failure : failures) {
    const Outcome run =
        scene("run", ", \"gravity\": [0, -9.8, 0]",
              {std::string("/plugins=[\"") + FAILING_PLUGIN + "\"]",
               std::string("/models/0={\"model\": \"failing\", \"parameters\": {\"rho\": 1000, "
                           "\"how\": \"") +
                   failure.how + "\"}}"});
    EXPECT_EQ(run.code, failure.code) << failure.how << "\n" << run;
    EXPECT_TRUE(run.says(failure.words)) << failure.how << "\n" << run;
  }
}

}  // namespace
}  // namespace suture::testing
