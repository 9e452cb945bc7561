// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs that are killed at random moments, and pairs of runs in one folder.
// SUTURE_FULL=1: 40 of each; otherwise a sample.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <set>

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "tests/apps/program.hpp"
#include "tests/output/output.hpp"

namespace suture::testing {
namespace {

namespace fs = std::filesystem;

int rounds() { return std::getenv("SUTURE_FULL") ? 40 : 6; }

using Files = std::map<std::string, std::string>;

/// The names of files that are not the same; "" if all are.
std::string difference(const Files& found, const Files& expected) {
  std::string names;
  for (const auto& [name, text] : found)
    if (!expected.contains(name) || expected.at(name) != text) names += name + ' ';
  for (const auto& [name, text] : expected)
    if (!found.contains(name)) names += name + " (missing) ";
  return names;
}

class Stress : public Program {
 protected:
  Stress() {
    // A block that swings, with all kinds of output.
    scene("check", R"(, "gravity": [0, -9.8, 0],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "output": {"directory": "o", "every_steps": 20, "energies": {}, "compression": "none",
                 "probes": {"at": [{"name": "tip", "point": [1, 1, 1]}]}},
      "checkpoint": {"every_steps": 150})");
  }
  static std::vector<std::string> run(const std::string& end) {
    return {
        "run", "s.json", "--set", "/solver/end=" + end, "--set", "/solver/max_steps=1000000000"};
  }
  /// What a list names is there and whole.
  void expect_whole(const fs::path& list) const {
    if (!fs::exists(list)) return;
    EXPECT_TRUE(read_text(list).ends_with("</VTKFile>\n")) << list;
    for (const std::string& frame : frames_in(list)) {
      const fs::path file = list.parent_path() / frame;
      ASSERT_TRUE(fs::exists(file)) << file;
      Diagnostics diagnostics;
      EXPECT_EQ(read_mesh(file, 1, diagnostics).hexahedra.size(), 8u) << file;
      EXPECT_TRUE(read_text(file).ends_with("</VTKFile>\n")) << file;
    }
  }
  /// All files but the list of the run and, on demand, the checkpoints.
  Files results(bool checkpoints) const {
    Files files;
    for (const auto& entry : fs::directory_iterator(folder() / "o")) {
      const std::string name = entry.path().filename();
      if (name == ".suture-run" || (!checkpoints && name.ends_with(".h5"))) continue;
      files[name] = read_text(entry.path());
    }
    return files;
  }
};

TEST_F(Stress, KilledRunsLeaveWholeFilesAndNothingToTheNext) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto whole_run = run("1");
  ASSERT_EQ(suture(whole_run).code, 0);
  const auto expected = results(true), without_checkpoints = results(false);
  ASSERT_EQ(expected.size(), 51u + 4 + 2);
  for (int round = 0; round < rounds(); ++round) {
    const pid_t child = start(whole_run);
    usleep(std::uniform_int_distribution<useconds_t>(1'000, 250'000)(random));
    kill(child, SIGKILL);
    finish(child);
    expect_whole(folder() / "o/run.pvd");
    const auto checkpoints = checkpoints_in(folder() / "o");
    for (const std::uint64_t number : checkpoints)
      EXPECT_NO_THROW(read_checkpoint(folder() / "o" / checkpoint_name(number)));
    const auto is_unfinished = [&] { return fs::exists(folder() / "o/suture-unfinished.txt"); };
    const bool was_unfinished = is_unfinished();
    const bool resumes = round % 2 == 0 && !checkpoints.empty();
    const Outcome next =
        suture(resumes ? std::vector<std::string>{"run", "--resume",
                                                  "o/" + checkpoint_name(checkpoints.back())}
                       : whole_run);
    ASSERT_EQ(next.code, 0) << next;
    EXPECT_EQ(next.says("the last run that wrote here did not finish"), was_unfinished) << next;
    EXPECT_FALSE(is_unfinished());
    EXPECT_EQ(difference(results(!resumes), resumes ? without_checkpoints : expected), "")
        << "round " << round << (resumes ? ", resumed" : "");
    if (HasFailure()) break;
  }
}

TEST_F(Stress, OfTwoRunsInAFolderOneWinsAndNothingIsMixed) {
  for (int round = 0; round < rounds(); ++round) {
    const std::string names[] = {"a", "b"};
    pid_t children[2];
    for (int i = 0; i < 2; ++i) {
      auto arguments = run("1e9");
      arguments.insert(arguments.end(), {"--set", "/title=" + names[i]});
      children[i] = start(arguments, names[i]);
    }
    int status = 0;
    siginfo_t ended{};
    waitid(P_ALL, 0, &ended, WEXITED | WNOWAIT);
    const int loser = ended.si_pid == children[0] ? 0 : 1, winner = 1 - loser;
    const Outcome lost = finish(children[loser], names[loser]);
    EXPECT_EQ(lost.code, 6) << lost;
    EXPECT_TRUE(lost.says("another run writes to this folder (process " +
                          std::to_string(children[winner]) + ")"))
        << lost;
    usleep(20'000);
    EXPECT_EQ(waitpid(children[winner], &status, WNOHANG), 0) << "the winner goes on";
    kill(children[winner], SIGTERM);
    EXPECT_EQ(finish(children[winner], names[winner]).code, 128 + SIGTERM);
    expect_whole(folder() / "o/run.pvd");
    std::set<std::string> files, provenances;
    for (const auto& [name, text] : results(false)) {
      EXPECT_FALSE(name.ends_with(".part")) << name;
      if (!name.ends_with(".vtu")) continue;
      files.insert(name);
      const std::string scene_is = "scene s.json ";
      provenances.insert(text.substr(text.find(scene_is), scene_is.size() + 16));
    }
    const auto listed = frames_in(folder() / "o/run.pvd");
    EXPECT_EQ(files, std::set<std::string>(listed.begin(), listed.end())) << "none lost or left";
    EXPECT_EQ(provenances.size(), files.empty() ? 0u : 1u);
  }
}

}  // namespace
}  // namespace suture::testing
