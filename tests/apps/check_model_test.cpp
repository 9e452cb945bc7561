// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "kernel/scene/json_document.hpp"
#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

class CheckModel : public Program {
 protected:
  /// On a model of the plugin `planted-faults`.
  Outcome planted(const std::string& model, std::vector<std::string> more) const {
    setenv("SUTURE_PLUGIN_PATH", TEST_PLUGINS, 1);
    more.insert(more.begin(), {"check-model", model});
    const Outcome outcome = suture(more);
    unsetenv("SUTURE_PLUGIN_PATH");
    return outcome;
  }
};

TEST_F(CheckModel, AModelOfTheTreePassesAllChecks) {
  const Outcome outcome = suture({"check-model", "tm-faure"});
  EXPECT_EQ(outcome.code, 0) << outcome;
  EXPECT_TRUE(outcome.says("passed          gradient        force = -dE/dx; ")) << outcome;
  EXPECT_TRUE(outcome.says("not applicable  state           the model has no state")) << outcome;
  EXPECT_TRUE(outcome.says("ns per cell")) << outcome;
  EXPECT_FALSE(outcome.says("FAILED")) << outcome;
}

// Built from the headers of version 1.0 of the contract alone.
TEST_F(CheckModel, PluginsOfTheFirstContractWork) {
  for (const char* plugin : {ABI_LAW, ABI_CELLS}) {
    const Outcome checks = suture({"check-model", plugin, "--timeout", "600"});
    EXPECT_EQ(checks.code, 0) << checks;
  }
  const Outcome run =
      scene("run", R"(, "plugins": [")" ABI_LAW R"(", ")" ABI_CELLS R"("])",
            {R"(/models=[
          {"model": "abi-damage", "parameters":
            {"mu": 1e4, "lambda": 2e4, "rho": 1000, "e0": 0.1, "e1": 1}},
          {"model": "abi-springs", "parameters": {"k": 10}},
          {"model": "abi-skin", "parameters": {"gamma": 1}},
          {"model": "abi-drag", "parameters": {"c": 0.1}}])",
             "/gravity=[0, -9.8, 0]", R"(/output={"fields": ["stress", "largest"]})"});
  EXPECT_EQ(run.code, 0) << run;
}

TEST_F(CheckModel, ABrokenLawIsNamedAndItsCaseRepeated) {
  const Outcome outcome = planted("twice", {"--only", "gradient,mass"});
  EXPECT_EQ(outcome.code, 4) << outcome;
  EXPECT_TRUE(outcome.says("FAILED          gradient")) << outcome;
  EXPECT_TRUE(outcome.says("passed          mass")) << outcome;
  EXPECT_TRUE(outcome.says("'twice' breaks these laws: gradient")) << outcome;
  EXPECT_TRUE(outcome.says("functor 'edges'")) << outcome;
  ASSERT_TRUE(std::filesystem::exists(folder() / "twice-gradient.json"));
  const Outcome again = suture({"replay", "--trust", "twice-gradient.json"});
  EXPECT_EQ(again.code, 4) << again;
  EXPECT_TRUE(again.says("twice-gradient.json, check gradient of model 'twice': the force on"))
      << again;
  const Outcome refused = suture({"replay", "twice-gradient.json"});
  EXPECT_EQ(refused.code, 4) << refused;
  EXPECT_TRUE(refused.says("--trust")) << refused;
}

TEST_F(CheckModel, DamagedCasesAreRefused) {
  planted("twice", {"--only", "gradient"});
  const std::string text = read("twice-gradient.json");
  const auto damaged = [&](const std::string& what, const std::string& by) {
    std::string other = text;
    other.replace(other.find(what), what.size(), by);
    write("d.json", other);
    return suture({"replay", "--trust", "d.json"});
  };
  const Outcome outcomes[] = {
      damaged("\"valid\": ", "\"valid\": 9"), damaged("\"position\": [", "\"position\": [1,"),
      damaged("\"edges\"", "\"edgse\""), damaged("\"shape\": ", "\"shape\": 7")};
  for (const Outcome& outcome : outcomes) EXPECT_EQ(outcome.code, 3) << outcome;
  EXPECT_TRUE(outcomes[1].says("the arrays of the batch do not fit functor 'edges'"))
      << outcomes[1];
  EXPECT_EQ(suture({"replay", "--trust", "missing.json"}).code, 3);
}

TEST_F(CheckModel, CrashesAndEndlessCallsFailOneCheck) {
  const auto mistake = [&](const std::string& how) {
    return planted("mistakes",
                   {"--only", "balance,translation", "--timeout", "2", "--set", "how=" + how});
  };
#ifndef SUTURE_SANITIZED
  const Outcome crash = mistake("force-crashes");
  EXPECT_EQ(crash.code, 4) << crash;
  EXPECT_TRUE(crash.says("SIGSEGV") && crash.says("balance, translation")) << crash;
#endif
  EXPECT_TRUE(mistake("force-exits").says("called exit()"));
  EXPECT_TRUE(mistake("force-throws").says("the law has lost its way"));
  const Outcome endless =
      planted("mistakes", {"--only", "balance", "--timeout", "0.2", "--set", "how=force-loops"});
  EXPECT_TRUE(endless.says("the check takes longer than")) << endless;
}

TEST_F(CheckModel, PrintsJson) {
  const Outcome outcome = planted("twice", {"--only", "gradient,mass", "--json", "--seed", "5"});
  EXPECT_EQ(outcome.code, 4) << outcome;
  const JsonValue root = parse_json(outcome.out, "check-model");
  ASSERT_EQ(root.items.size(), 1u);
  EXPECT_EQ(root.items[0].find("seed")->number, 5);
  const auto& checks = root.items[0].find("checks")->items;
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].find("status")->text, "failed");
  EXPECT_GT(checks[0].find("figure")->number, 0.4);
  EXPECT_EQ(checks[1].find("status")->text, "passed");
}

TEST_F(CheckModel, ListsItsChecks) {
  const Outcome outcome = suture({"check-model", "--list"});
  EXPECT_EQ(outcome.code, 0) << outcome;
  EXPECT_TRUE(outcome.says("gradient") && outcome.says("force = -dE/dx")) << outcome;
}

struct WrongCheck {
  std::vector<std::string> arguments;
  int code;
  const char* words;
};

TEST_F(CheckModel, WrongUsageNamesWhatWasMeant) {
  const WrongCheck wrong[] = {
      {{}, 2, "a model or plugin file"},
      {{"tm-fauer"}, 4, "did you mean 'tm-faure'?"},
      {{"./missing.so"}, 4, "no such file"},
      {{"tm-faure", "--only", "gradeint"}, 2, "did you mean 'gradient'?"},
      {{"tm-faure", "--set", "F=1", "--only", "mass"}, 2, "no such parameter"},
      {{"tm-faure", "--set", "E"}, 2, "NAME=VALUE"},
      {{"tm-faure", "--timeout", "-1"}, 2, "--timeout"},
      {{"tm-faure", "--seed", "x"}, 2, "--seed"}};
  for (const WrongCheck& use : wrong) {
    std::vector<std::string> arguments{"check-model"};
    arguments.insert(arguments.end(), use.arguments.begin(), use.arguments.end());
    const Outcome outcome = suture(arguments);
    EXPECT_EQ(outcome.code, use.code) << use.words << outcome;
    EXPECT_TRUE(outcome.says(use.words)) << use.words << outcome;
  }
}

}  // namespace
}  // namespace suture::testing
