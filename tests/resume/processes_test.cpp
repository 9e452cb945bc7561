// SPDX-License-Identifier: GPL-3.0-or-later
//
// Several processes that make a run together leave the same bytes as one process, also when they
// are stopped and others, of another number, go on. For what varies, see together.hpp.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <random>

#include "kernel/output/checkpoint_file.hpp"
#include "tests/resume/together.hpp"

namespace suture::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Together, TheyLeaveTheBytesOfOne) {
  const bool full = is_full() || !only().empty();
  std::vector<Kind> kinds = all_kinds();
  std::mt19937_64 order(scenes_seed());
  if (!full) std::ranges::shuffle(kinds, order);
  const auto start = std::chrono::steady_clock::now();
  unsigned shared = 0, refused = 0;
  for (const Kind& kind : kinds) {
    const auto spent = std::chrono::steady_clock::now() - start;
    if (!full && shared > 0 && spent > std::chrono::seconds(6)) break;
    Random random(scenes_seed(), kind.name, 0);
    const Case what = kind.make(random, 0, scenes_seed());
    if (!is_chosen(what)) continue;
    SCOPED_TRACE(what.name + ", SUTURE_PROCESSES_SEED=" + std::to_string(scenes_seed()));
    const fs::path at = folder_ / what.name;
    write_case(what, at);
    const Ran alone = run_here(what, at, at / "alone", {});
    const bool is_long = alone.seconds > 2 || alone.steps > 2000;
    if (alone.code == 3 || alone.code == 4 || (is_long && !full)) continue;
    const std::string scene = (at / "scene.json").string();
    for (const unsigned processes :
         full ? std::vector<unsigned>{1, 2, 3, 4, 7}
              : std::vector<unsigned>{random.pick(std::vector<unsigned>{2, 3, 4, 7})}) {
      const fs::path out = at / std::to_string(processes);
      const int code = run(what, {scene}, processes, out);
      if (code == 3 && said(out).find("several processes") != std::string::npos) {
        ++refused;
        break;
      }
      ++shared;
      EXPECT_EQ(code, alone.code) << said(out);
      EXPECT_EQ(difference(at / "alone", out / "out"), "") << processes << " processes";
    }
    fs::remove_all(at);
  }
  if (only().empty()) {
    EXPECT_GT(shared, 0u) << "the module cannot be loaded";
  }
  std::cout << shared << " runs shared, " << refused << " scenes refused\n";
}

/// Vertices of several blocks, so that the passes are divided, too; others go on from one of the
/// checkpoints.
TEST_F(Together, TheyDivideThePasses) {
  const std::vector<unsigned> numbers{2, 3, 4, 7};
  const auto start = std::chrono::steady_clock::now();
  unsigned runs = 0, resumed = 0;
  for (unsigned index = 0; index < 50; ++index) {
    const auto spent = std::chrono::steady_clock::now() - start;
    if (!is_full() && runs > 0 && spent > std::chrono::seconds(3)) break;
    Random random(scenes_seed(), "divided", index);
    const Case what = divided(random, index);
    if (!is_chosen(what)) continue;
    SCOPED_TRACE(what.name + ", SUTURE_PROCESSES_SEED=" + std::to_string(scenes_seed()));
    const fs::path at = folder_ / what.name, scene = at / "scene.json", alone = at / "0" / "out";
    const int code = run_alone(what, at);
    for (const unsigned processes :
         is_full() ? std::vector<unsigned>{1, 2, 3, 4, 7} : std::vector{random.pick(numbers)}) {
      SCOPED_TRACE(std::to_string(processes) + " processes");
      const fs::path there = at / std::to_string(processes), out = there / "out";
      EXPECT_EQ(run(what, {scene}, processes, there), code) << said(there);
      EXPECT_EQ(difference(alone, out), "");
      ++runs;
      const fs::path newest = newest_checkpoint(out);
      expect_same_checkpoints(alone, out);
      if (newest.empty()) continue;
      if (random.chance(0.5)) continue;
      const std::vector<std::string> resume{"--resume", "out/" + newest.filename().string()};
      EXPECT_EQ(run(what, resume, random.pick(numbers), there), code) << said(there);
      EXPECT_EQ(difference(alone, out), "") << "resumed";
      ++resumed;
    }
    fs::remove_all(at);
  }
  std::cout << runs << " runs, " << resumed << " resumed\n";
}

/// Checkpoints at and after steps at which forces are checked, without a frame between them.
TEST_F(Together, CheckpointsHaveTheForcesOfOne) {
  const Case what{"forces", Json::parse(R"({
    "suture": 2,
    "mesh": {"box": {"size": [1, 1, 1], "cells": [21, 21, 21]}},
    "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "gravity": [0, -10, 0],
    "constraints": [{"where": {"set": "x0"}, "fix": "xyz"}],
    "solver": {"end": 0.076, "dt": 1e-3},
    "output": {"directory": "out", "every": 1},
    "checkpoint": {"every_steps": 4, "keep": 1000}})")};
  const fs::path at = folder_ / "case", alone = at / "alone", there = at / "there";
  write_case(what, at);
  EXPECT_EQ(run(what, {at / "scene.json"}, 0, alone), 0) << said(alone);
  EXPECT_EQ(run(what, {at / "scene.json"}, 2, there), 0) << said(there);
  EXPECT_GE(checkpoints_in(there / "out").size(), 18u);
  expect_same_checkpoints(alone / "out", there / "out");
}

/// Loads and contact are computed by all, at positions that all of them have: the passes are
/// divided, as messages to single processes show.
TEST_F(Together, TheyDivideScenesWithLoadsAndContact) {
  const Case what{"loads", Json::parse(R"({
    "suture": 2,
    "mesh": {"box": {"size": [1, 1, 1], "cells": [21, 21, 21]}},
    "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "gravity": {"value": [0, -10, 0], "ramp": {"to": 0.02}},
    "loads": [{"pressure": 300, "where": {"set": "y1"}, "ramp": 0.01},
              {"traction": [0, 0, 200], "where": {"set": "x1"}},
              {"volume": 5000, "where": "all"}],
    "contact": {"friction": 0.2, "pieces": true, "obstacles": [
      {"name": "floor", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}},
      {"name": "ball", "sphere": {"centre": [0.5, 1.2, 0.5], "radius": 0.2},
       "path": [{"at": 0}, {"at": 0.05, "translation": [0, -0.1, 0]}]}]},
    "solver": {"end": 0.05},
    "events": [{"at": 0.02, "cut": {"along": "faces", "plane": {"point": [0.5, 0.5, 0.5],
                                                                "normal": [0.4, 1, 0.2]}}}],
    "output": {"directory": "out", "energies": {"every_steps": 5}, "every": 0.02}})")};
  const fs::path at = folder_ / "case", scene = at / "scene.json";
  write_case(what, at);
  EXPECT_EQ(run(what, {scene}, 0, at / "0"), 0) << said(at / "0");
  EXPECT_EQ(run(what, {scene, "-v"}, 2, at / "2"), 0) << said(at / "2");
  EXPECT_EQ(difference(at / "0" / "out", at / "2" / "out"), "");
  EXPECT_THAT(read_text(at / "2" / ".out") + said(at / "2"),
              ::testing::AllOf(::testing::HasSubstr("messages to single processes"),
                               ::testing::Not(::testing::HasSubstr(" in 0 messages to single"))));
}

/// Products with the tangent are divided, and everything else is repeated.
TEST_F(Together, TheySolveEquations) {
  const std::vector<unsigned> numbers{2, 3, 7};
  Random random(scenes_seed(), "solved", 0);
  const std::vector<Case> solvers{
      solved("static", {{"static", {{"frames", 3}}}, {"end", 0.3}}),
      solved("newmark", {{"integrator", "newmark"}, {"dt", 0.1}, {"end", 0.3}}),
      solved("xpbd", {{"integrator", "xpbd"}, {"dt", 0.02}, {"end", 0.3}})};
  const std::string one = random.pick(solvers).name;
  for (const Case& what : solvers) {
    if (!is_chosen(what) || (only().empty() && !is_full() && what.name != one)) continue;
    const unsigned processes = random.pick(numbers);
    SCOPED_TRACE(what.name + " on " + std::to_string(processes) + " processes");
    const fs::path at = folder_ / what.name, scene = at / "scene.json";
    write_case(what, at);
    EXPECT_EQ(run(what, {scene}, 0, at / "0"), 0) << said(at / "0");
    EXPECT_EQ(run(what, {scene}, processes, at / "n"), 0) << said(at / "n");
    EXPECT_EQ(difference(at / "0" / "out", at / "n" / "out"), "");
  }
}

TEST_F(Together, OthersGoOnFromTheirCheckpoint) {
  Case what = cut_beam();
  what.scene["solver"]["end"] = 0.5;
  what.scene["checkpoint"] = {{"every_steps", 50}, {"keep", 3}};
  const fs::path at = folder_ / "case";
  write_case(what, at);
  run_here(what, at, at / "alone", {});
  const std::string scene = (at / "scene.json").string();
  const std::vector<unsigned> numbers{1, 2, 3, 4, 7};
  for (unsigned i = 0; i < (is_full() ? 20 : 1); ++i) {
    SCOPED_TRACE(std::to_string(i) + ", SUTURE_PROCESSES_SEED=" + std::to_string(scenes_seed()));
    Random random(scenes_seed(), "kill", i);
    const fs::path there = at / ("shared-" + std::to_string(i)), out = there / "out";
    fs::create_directories(there);
    Child first(there, {"run", scene}, launcher(random.pick(numbers)));
    while (newest_checkpoint(out).empty() && !first.has_ended()) usleep(1000);
    first.send(SIGKILL, 0.1 * random.number());
    first.wait();
    for (int again = 0; again < 2; ++again) {
      const unsigned processes = random.pick(numbers);
      // The processes whose launcher was killed may still have to notice: until then they hold the
      // folder and write further checkpoints.
      int code = 6;
      for (int tries = 0; tries < 30 && code != 0; ++tries) {
        if (tries > 0) sleep(1);
        const fs::path newest = newest_checkpoint(out);
        ASSERT_NE(newest, "");
        code = run(what, {"--resume", "out/" + newest.filename().string()}, processes, there);
      }
      EXPECT_EQ(code, 0) << said(there);
      EXPECT_EQ(difference(at / "alone", out), "") << processes << " processes";
    }
  }
}

/// A checkpoint after a look for islands that sleep has the forces of the step to come, so that
/// nothing is evaluated before the first pass; cuts have changed the borders, and their vertices
/// make a fifth block.
TEST_F(Together, OthersGoOnWithTheForcesOfACheckpoint) {
  Case what{"forces", Json::parse(R"({
    "suture": 2,
    "mesh": {"box": {"size": [1, 1, 1], "cells": [25, 25, 25]}},
    "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "gravity": [0, -10, 0],
    "constraints": [{"where": {"set": "x0"}, "fix": "xyz"}],
    "solver": {"end": 0.04, "dt": 5e-4, "sleep": {"acceleration": 1e-7, "velocity": 1e-7}},
    "output": {"directory": "out"},
    "checkpoint": {"every_steps": 64}})")};
  for (const double y : {0.3, 0.4, 0.5, 0.6, 0.7})
    what.scene["events"].push_back(
        {{"at", 0.01},
         {"cut",
          {{"along", "faces"}, {"plane", {{"point", {0.5, y, 0.5}}, {"normal", {0.4, 1, 0.2}}}}}}});
  const fs::path at = folder_ / "case", alone = at / "alone", there = at / "there";
  write_case(what, at);
  EXPECT_EQ(run(what, {at / "scene.json"}, 0, alone), 0) << said(alone);
  fs::copy(alone, there, fs::copy_options::recursive);
  const std::string newest = newest_checkpoint(there / "out").filename();
  EXPECT_EQ(run(what, {"--resume", "out/" + newest}, 3, there), 0) << said(there);
  EXPECT_EQ(difference(alone / "out", there / "out"), "");
  const Json processes = Json::parse(read_text(there / "out" / "provenance.json"))["processes"];
  EXPECT_EQ(processes.size(), 3u);
  int elements = 0, vertices = 0;
  for (const Json& process : processes) {
    EXPECT_EQ(process["elements"][0], elements);
    elements = process["elements"][1];
    vertices += process["vertices"].get<int>();
    EXPECT_NE(process["machine"], "");
    EXPECT_GT(process["threads"], 0);
  }
  EXPECT_EQ(elements, 25 * 25 * 25);
  EXPECT_EQ(vertices, 5 * 4096);
}

TEST_F(Together, TheProgramStartsThem) {
  Case what = cut_beam();
  what.scene["solver"]["end"] = 0.25;
  const fs::path at = folder_ / "case", scene = at / "scene.json";
  write_case(what, at);
  EXPECT_EQ(run(what, {scene}, 0, at / "0"), 0);
  EXPECT_EQ(run(what, {scene, "--processes", "2"}, 0, at / "2"), 0) << said(at / "2");
  EXPECT_NE(said(at / "2").find("2 processes make this run"), std::string::npos);
  EXPECT_EQ(difference(at / "0" / "out", at / "2" / "out"), "");
  EXPECT_EQ(run(what, {"missing.json", "--processes", "2"}, 0, at / "3"), 6);
  EXPECT_THAT(said(at / "3"), ::testing::MatchesRegex("2 processes make this run\nsuture: error: "
                                                      "the scene 'missing.json' cannot [^\n]*\n"));
}

TEST_F(Together, TheProgramTellsThatOneWasKilled) {
  Case what = cut_beam();
  what.scene["solver"]["end"] = 1000;
  what.scene["output"]["every"] = 0.01;
  const fs::path at = folder_ / "run";
  write_case(what, at);
  const Child program(at, {"run", "scene.json", "--processes", "2"});
  const fs::path out = at / "out";
  while (!fs::exists(out / "frame_0001.vtu") && !program.has_ended()) usleep(1000);
  std::string word;
  pid_t first = 0;  // "Process 123 writes results"
  ASSERT_TRUE(std::ifstream(out / "suture-unfinished.txt") >> word >> first);
  kill(first, SIGKILL);
  EXPECT_EQ(program.wait(), 128 + SIGKILL);
  EXPECT_THAT(said(at), ::testing::HasSubstr("error: signal 9 ended a process"));
}

TEST_F(Together, WhatTheyCannotShareIsNamed) {
  Case what = cut_beam();
  const fs::path at = folder_ / "case";
  write_case(what, at);
  EXPECT_EQ(run(what, {at / "scene.json", "--processes", "3"}, 2, at / "three"), 3);
  EXPECT_NE(said(at / "three").find("the launcher of this run has started 2"), std::string::npos);
  what.scene["solver"] = {{"integrator", "implicit-euler"},
                          {"dt", 0.01},
                          {"end", 1},
                          {"budget", {{"milliseconds", 5}}}};
  write_case(what, at);
  const std::string scene = (at / "scene.json").string();
  EXPECT_EQ(run(what, {scene}, 2, at / "budget"), 3);
  EXPECT_NE(said(at / "budget").find("/solver/budget/milliseconds: the clocks of several"),
            std::string::npos)
      << said(at / "budget");
}

/// The words of process 1 differ from those of process 0; returns what both say.
std::string said_by_two(const fs::path& folder, const std::string& first, const std::string& second,
                        const Case& what = cut_beam()) {
  fs::create_directories(folder);
  write_case(what, folder);
  std::vector<std::string> words = launcher(2);
  words.insert(words.end(), {"bash", "-c",
                             "if [ $OMPI_COMM_WORLD_RANK = 0 ]; then exec \"$0\" run " + first +
                                 "; else exec \"$0\" run " + second + "; fi"});
  EXPECT_NE(Child(folder, {}, words).wait(), 0);
  return read_text(folder / ".err");
}

/// Writing a checkpoint for the first time takes process 0 longer than the others wait for each
/// other. Each process leaves its number in pid.RANK.
Child with_slow_process_0(const fs::path& folder, const Case& what) {
  fs::create_directories(folder);
  write_case(what, folder);
  std::vector<std::string> words = launcher(2);
  words.insert(words.end(), {"bash", "-c",
                             "echo $$ > pid.$OMPI_COMM_WORLD_RANK; "
                             "if [ $OMPI_COMM_WORLD_RANK = 0 ]; then export LD_PRELOAD=" SLOW_DISK
                             "; fi; exec \"$0\" run scene.json --threads 1"});
  return Child(folder, {}, words);
}

/// Both at once, as they take seconds.
TEST_F(Together, WaitForProcess0ToWriteWhatStands) {
  Case what = cut_beam();
  what.scene["checkpoint"] = {{"every_steps", 1000000000}};
  what.scene["solver"]["end"] = 1000;
  what.scene["output"]["every"] = 0.01;
  const fs::path stopped = folder_ / "stopped", failed = folder_ / "failed";
  const Child first = with_slow_process_0(stopped, what);
  what.scene["checkpoint"] = {{"every_steps", 1}, {"keep", 1000}};
  what.scene["gravity"] = {0, -1e5, 0};
  const Child other = with_slow_process_0(failed, what);
  while (!fs::exists(stopped / "out" / "frame_0001.vtu") && !first.has_ended()) usleep(1000);
  kill(std::stoi(read_text(stopped / "pid.1")), SIGTERM);
  EXPECT_EQ(first.wait(), 128 + SIGTERM) << read_text(stopped / ".err");
  EXPECT_THAT(read_text(stopped / ".err"), ::testing::HasSubstr("resume with: "));
  EXPECT_NE(newest_checkpoint(stopped / "out"), "");
  EXPECT_EQ(other.wait(), 5) << read_text(failed / ".err");
  EXPECT_THAT(read_text(failed / ".err"),
              ::testing::AllOf(::testing::HasSubstr("suture: error: "),
                               ::testing::Not(::testing::HasSubstr("process 1 of 2"))));
  EXPECT_NE(newest_checkpoint(failed / "out"), "");
}

TEST_F(Together, AnErrorOfOneEndsAll) {
  const std::string said = said_by_two(folder_ / "run", "scene.json", "missing.json");
  EXPECT_NE(said.find("process 1 of 2: the scene 'missing.json' cannot"), said.npos) << said;
}

TEST_F(Together, RunsThatDifferAreRefused) {
  const std::string said =
      said_by_two(folder_ / "run", "scene.json", "scene.json --set /solver/damping=3");
  EXPECT_NE(said.find("the processes of this run differ: process 0 has scene: "), said.npos)
      << said;
}

TEST_F(Together, FilesThatDifferAreRefused) {
  Case what = cut_beam();
  what.scene["constraints"][1] = Json::parse(R"({"where": {"set": "x1"}, "move": {"table": {
    "file": "pull.csv", "columns": {"time": "t", "x": "x"}, "units": {"length": "m", "time": "s"}}}})");
  const fs::path at = folder_ / "run";
  for (const auto& [folder, reach] : {std::pair{"first", "0.1"}, {"other", "0.2"}}) {
    what.files["pull.csv"] = std::string("t,x\n0,0\n1,") + reach + "\n";
    write_case(what, at / folder);
  }
  const std::string said = said_by_two(at, "first/scene.json", "other/scene.json", what);
  EXPECT_NE(said.find("the processes of this run differ: process 0 has file pull.csv: "), said.npos)
      << said;
}

TEST_F(Together, LaunchersOfAnotherMpiAreRefused) {
  write_case(cut_beam(), folder_ / "run");
  const std::vector<std::string> launched{"env", "PMI_SIZE=2", "PMI_RANK=0"};
  EXPECT_EQ(Child(folder_ / "run", {"run", "scene.json"}, launched).wait(), 3);
  const std::string said = read_text(folder_ / "run" / ".err");
  EXPECT_NE(said.find("has started 2 processes, but MPI finds 1"), said.npos) << said;
}

}  // namespace
}  // namespace suture::test
