// SPDX-License-Identifier: GPL-3.0-or-later
//
// The usual mistakes of plugin authors, one row each: how the program ends, and what it says.
#include <csignal>
#include <cstdlib>

#include "tests/apps/program.hpp"
#include "tests/base/variable.hpp"

namespace suture::testing {
namespace {

using test::Variable;

class Mistakes : public Program {
 protected:
  /// `command` on a scene whose one model makes the mistake `how`.
  Outcome with(const std::string& command, const std::string& how) const {
    const Variable path("SUTURE_PLUGIN_PATH", TEST_PLUGINS);
    return scene(command, "",
                 {R"(/models/0={"model": "mistakes", "name": "tissue", "parameters": {"how": ")" +
                  how + "\"}}"});
  }
  void expect(const Outcome& outcome, const std::vector<const char*>& words,
              const std::string& how) const {
    EXPECT_EQ(outcome.code, 4) << how << "\n" << outcome;
    for (const char* word : words) EXPECT_TRUE(outcome.says(word)) << how << "\n" << outcome;
  }
};

struct Mistake {
  const char* how;
  const char* where;
  const char* what;
  const char* cure;
};

constexpr const char* crash_cure = "gdb --args suture";
constexpr const char* exception_cure = "catch them, and return SUTURE_STOP";
constexpr const char *fault = "the tables of the law are not loaded", *fault_cure = "load() first";
constexpr const char *unknown_status = "status 77",
                     *known_statuses = "SUTURE_STOP (-1) or SUTURE_FAULT (-2)";

TEST_F(Mistakes, NothingIsWrongWithThePluginElse) {
  for (const char* command : {"check", "explain", "run"})
    EXPECT_EQ(with(command, "nothing").code, 0) << command;
}

// While the scene is compiled: every command that does so names the place.
TEST_F(Mistakes, BeforeTheRunEndWithTheirPlaceAndExitCode4) {
  const Mistake mistakes[] = {
      {"prepare-throws", "prepare", "std::runtime_error (the law has lost its way)",
       exception_cure},
      {"enabled-throws", "functor 'elements', enabled", "std::runtime_error", exception_cure},
      {"extension-throws", "functor 'elements', extension", "std::runtime_error", exception_cure},
      {"contribution-throws", "attribute 'mass', contribution of elements 0 to 7",
       "std::runtime_error", exception_cure},
      {"contribution-nan", "attribute 'mass', contribution", "element 0 gives nan kg",
       "must be finite"},
      {"contribution-negative", "attribute 'mass', contribution", "element 0 gives -0.125",
       "not negative"},
      {"prepare-status", "prepare", unknown_status, known_statuses},
      {"prepare-fault", "prepare", fault, fault_cure},
      {"contribution-status", "attribute 'mass', contribution of elements 0 to 7", unknown_status,
       known_statuses},
      {"contribution-fault", "attribute 'mass', contribution of elements 0 to 7", fault,
       fault_cure},
      {"inspect-status", "functor 'elements', inspect of elements 0 to 7", unknown_status,
       known_statuses},
      {"inspect-fault", "functor 'elements', inspect of elements 0 to 7", fault, fault_cure},
      {"prepare-writes-behind", "prepare", "wrote behind its 8 bytes", "instance_bytes"},
#ifndef SUTURE_SANITIZED
      {"prepare-crashes", "prepare", "SIGSEGV", crash_cure},
      {"prepare-writes-far", "prepare", "it wrote 1 double past the end of its memory",
       "instance_bytes"},
      {"contribution-writes-far", "attribute 'mass', contribution of elements 0 to 7",
       "it wrote 1 double past the end of its results", "a row of 8 lanes"},
      {"contribution-crashes", "attribute 'mass', contribution of elements 0 to 7", "SIGSEGV",
       crash_cure},
      {"inspect-crashes", "functor 'elements', inspect of elements 0 to 7", "SIGSEGV", crash_cure},
#endif
  };
  for (const Mistake& mistake : mistakes)
    for (const char* command : {"check", "explain", "run"}) {
      const Outcome outcome = with(command, mistake.how);
      expect(outcome, {"plugin 'mistakes'", "mistakes", mistake.where, mistake.what, mistake.cure},
             std::string(command) + " " + mistake.how);
      EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << mistake.how;
    }
}

TEST_F(Mistakes, InTheRunEndWithFunctorCellsAndExitCode4) {
  const Mistake mistakes[] = {
      {"force-throws", "force of elements 0 to 7", "std::runtime_error (the law has lost its way)",
       exception_cure},
      {"force-throws-int", "force of elements 0 to 7", "of type int", exception_cure},
      {"force-throws-own", "force of elements 0 to 7", "OwnType", exception_cure},
      {"force-bad-alloc", "force of elements 0 to 7", "std::bad_alloc", exception_cure},
      {"force-noexcept", "force of elements 0 to 7", "std::runtime_error", exception_cure},
      {"force-exits", "force of elements 0 to 7", "called exit()", "must not end the program"},
      {"force-quick-exits", "force of elements 0 to 7", "called exit()",
       "must not end the program"},
      {"force-ends-process", "force of elements 0 to 7", "called _exit()",
       "must not end the program"},
      {"force-becomes-another", "force of elements 0 to 7", "called execl()",
       "must not end the program"},
      {"force-status", "force of elements 0 to 7", unknown_status, known_statuses},
      {"force-fault", "force of elements 0 to 7", fault, fault_cure},
      {"bounds-throws", "bounds of elements 0 to 7", "std::runtime_error", exception_cure},
      {"energy-status", "energy of elements 0 to 7", unknown_status, known_statuses},
      {"energy-fault", "energy of elements 0 to 7", fault, fault_cure},
      {"energy-throws", "energy of elements 0 to 7", "std::runtime_error", exception_cure},
#ifndef SUTURE_SANITIZED
      {"force-aborts", "force of elements 0 to 7", "SIGABRT", crash_cure},
      {"force-crashes", "force of elements 0 to 7", "SIGSEGV", crash_cure},
      {"force-overflows", "force of elements 0 to 7", "stack overflowed", "end the recursion"},
      {"force-divides", "force of elements 0 to 7", "SIGFPE", crash_cure},
      {"force-writes-far", "force of elements 0 to 7",
       "it wrote 3905 doubles past the end of its results", "--check-plugins"},
      {"force-writes-far-before", "force of elements 0 to 7",
       "doubles before the beginning of its results", "--check-plugins"},
      {"force-protects", "force of elements 0 to 7",
       "SIGSEGV: the memory for results is not accessible any more", "mprotect"},
#endif
  };
  for (const Mistake& mistake : mistakes)
    expect(with("run", mistake.how),
           {"plugin 'mistakes'", "model 'tissue' (mistakes)", "functor 'elements'", mistake.where,
            mistake.what, mistake.cure},
           mistake.how);
}

// What a run takes for results is found with --check-plugins, in `check` too.
TEST_F(Mistakes, InTheResultsAreFoundByCheckPlugins) {
  const Mistake mistakes[] = {
      {"force-nan", "functor 'elements', force of elements 0 to 7",
       "force of node 2, component 0, of cell 1 is nan", "division"},
      {"force-unset", "force of elements 0 to 7",
       "force of node 5, component 0, of cell 0 is never set", "set it for every node"},
      {"force-adds", "force of elements 0 to 7",
       "force of node 0, component 0, of cell 0 is never set", "set it for every node"},
      {"force-mixes-lanes", "force of elements 0 to 7", "depends on the other cells of the batch",
       "that lane only"},
      {"force-writes-before", "force of elements 0 to 7",
       "wrote 1 double before the beginning of force", "24 rows"},
      {"force-writes-behind", "force of elements 0 to 7", "wrote 1 double past the end of force",
       "24 rows"},
      {"force-writes-input", "force of elements 0 to 7",
       "into an input: position of node 0, component 0, of cell 3", "outputs only"},
      {"bounds-nan", "bounds of elements 0 to 7", "of cell 3 is not finite", "division"},
      {"energy-nan", "energy of elements 0 to 7", "is not finite", "division"},
#ifndef SUTURE_SANITIZED
      {"force-writes-far", "force of elements 0 to 7",
       "it wrote 3905 doubles past the end of force", "24 rows"},
      {"force-writes-far-before", "force of elements 0 to 7", "before the beginning of force",
       "24 rows"},
      {"force-reads-far", "force of elements 0 to 7",
       "it read 3905 doubles past the end of position", "24 rows"},
#endif
  };
  with("check", "nothing");  // writes the scene
  const Variable path("SUTURE_PLUGIN_PATH", TEST_PLUGINS);
  for (const char* command : {"check", "run"})
    for (const Mistake& mistake : mistakes) {
      const std::string how = mistake.how;
      const std::string model =
          R"(/models/0={"model": "mistakes", "name": "tissue", "parameters": )"
          R"({"how": ")" +
          how + "\"}}";
      expect(suture({command, "s.json", "--check-plugins", "--set", model}),
             {"plugin 'mistakes'", "model 'tissue' (mistakes)", mistake.where, mistake.what,
              mistake.cure},
             std::string(command) + " " + how);
    }
  // Good plugins pass, the mistake-free one and those of the kernel.
  EXPECT_EQ(suture({"run", "s.json", "--check-plugins"}).code, 0);
  EXPECT_EQ(suture({"run", "s.json", "--check-plugins", "--set",
                    R"(/models/0={"model": "mss-baudet", "parameters": {"E": 1e5, "nu": 0.3, )"
                    R"("rho": 1000}})"})
                .code,
            0);
}

TEST_F(Mistakes, ARunWhoseForcesAreNotFinitePointsToCheckPlugins) {
  const Outcome run = with("run", "force-nan");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("not finite") && run.says("suture run --check-plugins")) << run;
}

TEST_F(Mistakes, ATextThatIsNotTerminatedIsShownToItsEnd) {
  const Outcome run = with("run", "force-text");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says(std::string(512, 'x'))) << run;
  EXPECT_FALSE(run.says(std::string(513, 'x'))) << run;
}

TEST_F(Mistakes, AnEndlessLoopEndsAfterTheTimeThatACallMayTake) {
  const Variable timeout("SUTURE_PLUGIN_TIMEOUT", "0.2");
  expect(with("run", "force-loops"),
         {"plugin 'mistakes'", "functor 'elements', force of elements 0 to 7", "does not return",
          "SUTURE_PLUGIN_TIMEOUT"},
         "force-loops");
}

TEST_F(Mistakes, ACallThatBlocksEndsAfterTheTimeThatACallMayTake) {
  const Variable timeout("SUTURE_PLUGIN_TIMEOUT", "0.2");
  for (const char* how : {"force-sleeps", "force-locks-twice"})
    expect(with("run", how),
           {"plugin 'mistakes'", "functor 'elements', force of elements 0 to 7",
            "does not return: it waits", "SUTURE_PLUGIN_TIMEOUT"},
           how);
  expect(with("run", "force-loops-unsignalled"),
         {"functor 'elements', force of elements 0 to 7", "all the processor time"},
         "with all signals blocked");
}

TEST_F(Mistakes, AThreadOfAPluginMustNotEndTheProgramEither) {
  expect(with("run", "force-ends-process-elsewhere"),
         {"a thread that a plugin has started: the plugin called _exit()"},
         "force-ends-process-elsewhere");
  EXPECT_EQ(with("run", "force-starts-another").code, 0) << "a process of its own is no mistake";
}

// Nobody sees a system call: the folder says that the run's last word is missing.
TEST_F(Mistakes, AProcessThatEndsSilentlyLeavesItsFolderUnfinished) {
  const auto is_unfinished = [&] {
    return std::filesystem::exists(folder() / "out/s/suture-unfinished.txt");
  };
  with("run", "nothing");
  EXPECT_FALSE(is_unfinished());
  with("run", "later-exits-silently");
  EXPECT_TRUE(is_unfinished());
  EXPECT_NE(Program::read("out/s/suture-unfinished.txt").find("the results are incomplete"),
            std::string::npos);
  const Outcome failed = with("run", "force-throws");
  EXPECT_TRUE(is_unfinished()) << "a run that writes nothing leaves what it found";
  EXPECT_TRUE(failed.says("out/s: the last run that wrote here did not finish")) << failed;
  const Outcome next = with("run", "nothing");
  EXPECT_EQ(next.code, 0) << next;
  EXPECT_TRUE(next.says("out/s: the last run that wrote here did not finish")) << next;
  EXPECT_FALSE(is_unfinished());
  EXPECT_FALSE(with("run", "nothing").says("did not finish"));
}

// A model that leaves a rounding mode behind changes no bit of another model's results.
TEST_F(Mistakes, FloatingPointModesThatAreLeftChangedAreRestoredAndReported) {
  const Variable path("SUTURE_PLUGIN_PATH", TEST_PLUGINS);
  const auto energies_with = [&](const std::string& how, Outcome& outcome) {
    outcome = scene("run", R"(, "gravity": [0, -9.8, 0], "output": {"energies": {}})",
                    {R"(/models/-={"model": "mistakes", "adds": true, "parameters": {"how": ")" +
                     how + "\"}}"});
    return Program::read("out/s/energies.csv");
  };
  Outcome outcome;
  const std::string expected = energies_with("nothing", outcome);
  ASSERT_GT(expected.size(), 1000u) << outcome;
  EXPECT_FALSE(outcome.says("warning")) << outcome;
  const Mistake mistakes[] = {
    {"force-rounds", "functor 'elements', force: the plugin left", "the rounding mode", ""},
    {"prepare-rounds", "prepare: the plugin left", "the rounding mode", ""},
#if defined(__x86_64__)
    {"force-flushes", "functor 'elements', force: the plugin left", "flush-to-zero", ""},
#endif
    {"force-traps", "functor 'elements', force: the plugin left", "traps", ""}
  };
  for (const Mistake& mistake : mistakes) {
    EXPECT_EQ(energies_with(mistake.how, outcome), expected) << mistake.how;
    EXPECT_EQ(outcome.code, 0) << mistake.how << outcome;
    for (const char* words :
         {mistake.where, mistake.what, "restore it before the function returns"})
      EXPECT_TRUE(outcome.says(words)) << mistake.how << outcome;
    EXPECT_TRUE(outcome.says("suture: 1 warning\n")) << "once" << outcome;
  }
}

TEST_F(Mistakes, ATimeoutThatIsNotANumberIsRefused) {
  for (const char* value : {"soon", "-1", "1 s", "nan", "inf"}) {
    const Variable timeout("SUTURE_PLUGIN_TIMEOUT", value);
    const Outcome outcome = suture({"models"});
    EXPECT_EQ(outcome.code, 2) << value << "\n" << outcome;
    EXPECT_TRUE(outcome.says("SUTURE_PLUGIN_TIMEOUT")) << outcome;
  }
}

TEST_F(Mistakes, CtrlCEndsACallThatDoesNotReturnAndNamesIt) {
  const Variable timeout("SUTURE_PLUGIN_TIMEOUT", "4");  // a look every 0.1 s
  with("check", "nothing");                              // writes the scene
  const Outcome run = interrupted(
      {"run", "s.json", "--set", std::string("/plugins=[\"") + TEST_PLUGINS + "/mistakes.so\"]",
       "--set",
       R"(/models/0={"model": "mistakes", "name": "tissue", "parameters": {"how": "force-says-and-loops"}})"},
      SIGINT, "looping");
  EXPECT_EQ(run.code, 130) << run;
  for (const char* word : {"plugin 'mistakes'", "functor 'elements'", "under way"})
    EXPECT_TRUE(run.says(word)) << run;
}

TEST_F(Mistakes, CtrlCEndsACallThatBlocksInTheRun) {
  with("check", "nothing");  // writes the scene
  const Outcome run = interrupted(
      {"run", "s.json", "--set", std::string("/plugins=[\"") + TEST_PLUGINS + "/mistakes.so\"]",
       "--set",
       R"(/models/0={"model": "mistakes", "name": "tissue", "parameters": {"how": "later-sleeps"}})"},
      SIGINT, "sleeping");
  EXPECT_EQ(run.code, 130) << run;
  for (const char* word : {"plugin 'mistakes'", "functor 'elements', force of elements 0 to 7",
                           "interrupted, and the plugin's call does not return"})
    EXPECT_TRUE(run.says(word)) << run;
  EXPECT_TRUE(std::filesystem::exists(folder() / "out/s/suture-unfinished.txt"));
}

struct Table {
  const char* mistake;
  const char* where;
  const char* what;
};

// Tables are checked before anything uses them, and all that is wrong is said.
TEST_F(Mistakes, InTheTablesAreRefusedWithTheEntry) {
  const Table mistakes[] = {
      {"dimension", "functor 'elements'", "dimension is 4"},
      {"cell-type", "functor 'elements'", "cell_type"},
      {"column", "functor 'elements'", "column 3 is not an attribute"},
      {"same-parameter", "parameter 'how'", "occurs twice"},
      {"default", "parameter 'E'", "default 3 is outside its range from 0 to 2"},
      {"formula", "model 'mistakes'", "formula"},
      {"no-force", "functor 'elements'", "force is NULL"},
      {"no-contribution", "attribute 'mass'", "contribution 0: its function is NULL"},
      {"no-energy", "functor 'elements', extension 'suture.energy/1'", "function is NULL"},
      {"table-throws", "mistakes", "threw an exception of type int"},
      {"loading-exits", "loading", "called exit()"},
#ifndef SUTURE_SANITIZED
      {"table-crashes", "suture_plugin_v1", "SIGSEGV"},
      {"loading-crashes", "loading", "SIGSEGV"},
#endif
  };
  for (const Table& table : mistakes)
    for (const char* command : {"check", "explain", "run"}) {
      const Variable mistake("SUTURE_TEST_MISTAKE", table.mistake);
      expect(with(command, "nothing"), {"mistakes", table.where, table.what},
             std::string(command) + " " + table.mistake);
    }
  const Variable path("SUTURE_PLUGIN_PATH", TEST_PLUGINS),
      mistake("SUTURE_TEST_MISTAKE", "formula");
  expect(suture({"describe", "mistakes"}), {"model 'mistakes'", "formula"}, "describe");
}

}  // namespace
}  // namespace suture::testing
