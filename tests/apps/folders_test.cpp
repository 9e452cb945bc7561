// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a run writes, and what it does to what is there already.
#include <csignal>
#include <map>

#include "tests/apps/program.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture::testing {
namespace {

namespace fs = std::filesystem;

class Folders : public Program {
 protected:
  bool exists(const std::string& name) const { return fs::exists(folder() / name); }
  /// All files of a folder but the list of the run.
  std::map<std::string, std::string> contents(const std::string& name) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder() / name))
      if (const std::string file = entry.path().filename();
          entry.is_regular_file() && file != ".suture-run")
        files[file] = read(name + "/" + file);
    return files;
  }
};

std::string output(const fs::path& directory) {
  return ", \"output\": {\"directory\": \"" + directory.string() + "\"}";
}

TEST_F(Folders, ASceneWritesOnlyBelowTheWorkingFolder) {
  for (const char* command : {"run", "check", "explain"})
    for (const fs::path& path : {fs::path("../escaped"), fs::path("a/../../escaped"),
                                 folder().parent_path() / "escaped", fs::path("/escaped")}) {
      const Outcome refused = scene(command, output(path));
      EXPECT_EQ(refused.code, 3) << path << refused;
      EXPECT_TRUE(refused.says("s.json:5:") && refused.says("/output/directory: leads out") &&
                  refused.says("--output"))
          << refused;
    }
  EXPECT_EQ(scene("run", output("a/../inside/deeper")).code, 0);
  EXPECT_TRUE(exists("inside/deeper/run.pvd"));
  EXPECT_EQ(scene("run", output(folder() / "absolute")).code, 0);
  EXPECT_TRUE(exists("absolute/run.pvd"));
}

TEST_F(Folders, TheCommandLineMayNameAnyFolder) {
  const TemporaryFolder other;
  const std::string out = (other.path() / "out").string();
  EXPECT_EQ(scene("run", output("../escaped"), {"/output/directory=" + out}).code, 0);
  EXPECT_TRUE(fs::exists(other.path() / "out/run.pvd"));
  fs::create_directory_symlink(other.path(), folder() / "link");
  const Outcome refused = scene("run", output("link/here"));
  EXPECT_EQ(refused.code, 6) << refused;
  EXPECT_TRUE(refused.says("/link: is a link") && refused.says("--output")) << refused;
  EXPECT_EQ(suture({"run", "s.json", "-o", "link/here"}).code, 0);
  EXPECT_TRUE(fs::exists(other.path() / "here/run.pvd"));
}

TEST_F(Folders, ARunElsewhereGoesOnWhereItsCheckpointLies) {
  const TemporaryFolder other;
  const std::string out = (other.path() / "out").string();
  const Outcome first =
      scene("run", R"(, "checkpoint": {"every_steps": 4})", {"/output/directory=" + out});
  ASSERT_EQ(first.code, 0) << first;
  const Outcome again = suture({"run", "--resume", out + "/checkpoint_0002.h5"});
  EXPECT_EQ(again.code, 0) << again;
  fs::create_directory(folder() / "copy");
  fs::copy_file(out + "/checkpoint_0002.h5", folder() / "copy/checkpoint_0002.h5");
  const auto results = contents(out);
  const Outcome moved = suture({"run", "--resume", "copy/checkpoint_0002.h5"});
  EXPECT_EQ(moved.code, 0) << moved;
  EXPECT_TRUE(moved.says("1 of the earlier frames are missing")) << moved;
  EXPECT_TRUE(exists("copy/run.pvd"));
  EXPECT_EQ(contents(out), results) << "its text may be a stranger's";
}

TEST_F(Folders, ResumingACopyLeavesTheOriginal) {
  const std::string more = R"(, "output": {"directory": "o", "every_steps": 1},
  "checkpoint": {"every_steps": 2, "keep": 9})";
  ASSERT_EQ(scene("run", more).code, 0);
  const auto original = contents("o");
  fs::copy(folder() / "o", folder() / "copy");
  const auto resume = [&](const std::string& checkpoint, std::vector<std::string> options) {
    options.insert(options.begin(), {"run", "--resume", checkpoint});
    return suture(options);
  };
  const std::vector<std::string> shorter{"--set", "/models/0/parameters/E=1e4", "--set",
                                         "/solver/end=0.006"};
  const Outcome copy = resume("copy/checkpoint_0002.h5", shorter);
  EXPECT_EQ(copy.code, 0) << copy;
  EXPECT_EQ(contents("o"), original);
  EXPECT_FALSE(exists("copy/frame_0007.vtu")) << "a frame of the future that was left";
  EXPECT_NE(read("copy/frame_0006.vtu"), read("o/frame_0006.vtu"));

  // Nor does it replace the original where the user names that folder, or moves a checkpoint there.
  fs::copy(folder() / "copy/checkpoint_0003.h5", folder() / "o/checkpoint_0012.h5");
  const auto with_stranger = contents("o");
  for (const auto& [checkpoint, options] :
       {std::pair<std::string, std::vector<std::string>>{"copy/checkpoint_0003.h5", {"-o", "o"}},
        {"o/checkpoint_0012.h5", {}}}) {
    const Outcome refused = resume(checkpoint, options);
    EXPECT_EQ(refused.code, 6) << refused;
    EXPECT_TRUE(refused.says("/o: contains the results of another run")) << refused;
    EXPECT_EQ(contents("o"), with_stranger);
  }
  EXPECT_EQ(resume("copy/checkpoint_0003.h5", {"-o", "new"}).code, 0);
  EXPECT_TRUE(exists("new/run.pvd"));
  for (const char* earlier : {"o/checkpoint_0002.h5", "o/checkpoint_0003.h5"})
    EXPECT_EQ(resume(earlier, {}).code, 0) << "its own, twice";
}

TEST_F(Folders, AMeshReplacesALinkAndNotItsTarget) {
  write("victim", "precious");
  for (const char* name : {"m.vtu", "m.msh", "m.vtk.part", "m.vtk"}) {
    fs::create_symlink("victim", folder() / name);
    if (fs::path(name).extension() == ".part") continue;
    const Outcome made =
        suture({"mesh", "generate", "box", name, "--size", "1,1,1", "--cells", "1,1,1"});
    EXPECT_EQ(made.code, 0) << made;
    EXPECT_FALSE(fs::is_symlink(folder() / name)) << name;
  }
  EXPECT_EQ(read("victim"), "precious");
}

const std::string endless = R"(, "output": {"directory": "o", "every_steps": 100},
  "checkpoint": {"every_steps": 500})";

TEST_F(Folders, ASecondRunIsRefusedAtOnceAndTheFirstGoesOn) {
  scene("check", endless, {"/solver/end=1e9"});
  const pid_t first = start({"run", "s.json", "--set", "/solver/end=1e9"});
  wait_for("o/frame_0003.vtu", first);
  const Outcome second = suture({"run", "s.json"});
  EXPECT_EQ(second.code, 6) << second;
  EXPECT_TRUE(second.says("another run writes to this folder (process " + std::to_string(first)))
      << second;
  EXPECT_EQ(suture({"run", "s.json", "-o", "another"}).code, 0);
  kill(first, SIGTERM);
  const Outcome ended = finish(first);
  EXPECT_EQ(ended.code, 128 + SIGTERM) << ended;
  EXPECT_TRUE(exists("o/run.pvd"));
}

TEST_F(Folders, AShorterRunLeavesNothingOfALongerOne) {
  const std::string more =
      R"(, "output": {"directory": "o", "every_steps": 1, "energies": {}}, "checkpoint": {"every_steps": 3})";
  ASSERT_EQ(scene("run", more).code, 0);
  write("o/failed.pvd", "");
  write("o/mine.txt", "mine");
  write("o/.suture-run", read("o/.suture-run") + "failed.pvd\n");
  ASSERT_EQ(scene("run", output("o")).code, 0);
  std::vector<std::string> names;
  for (const auto& [name, text] : contents("o")) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"frame_0000.vtu", "frame_0001.vtu", "mine.txt",
                                             "provenance.json", "run.pvd"}));
}

TEST_F(Folders, EqualRunsGiveEqualBytes) {
  const std::string more = R"(, "gravity": [0, -9.8, 0],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
  "output": {"every_steps": 2, "energies": {}, "fields": ["stress", "island"]})";
  const auto run = [&](const std::string& name, const std::string& threads) {
    const Outcome done =
        scene("run", more,
              {"/mesh/box/cells=[12,12,12]", "/solver/threads=" + threads, "/solver/dt=1e-4",
               "/solver/end=1e-3", "/output/directory=" + name});
    EXPECT_EQ(done.code, 0) << done;
    return contents(name);
  };
  const auto one = run("a", "1");
  EXPECT_EQ(one.size(), 9u);
  for (const char* threads : {"1", "2", "4"}) EXPECT_TRUE(run("b", threads) == one) << threads;
}

TEST_F(Folders, AFolderThatGoesDuringTheRunEndsIt) {
  for (const bool all : {true, false}) {
    scene("check", R"(, "output": {"directory": "o", "energies": {}})", {"/solver/end=1e9"});
    const pid_t child = start({"run", "s.json", "--set", "/solver/end=1e9"});
    wait_for("o/energies.csv", child);
    if (all)
      fs::remove_all(folder() / "o");
    else
      fs::remove(folder() / "o/energies.csv");
    const Outcome ended = finish(child);
    EXPECT_EQ(ended.code, 6) << ended;
    EXPECT_TRUE(ended.says("removed")) << ended;
  }
}

TEST_F(Folders, FramesThatGoDuringTheRunAreMissed) {
  scene("check", endless, {"/solver/end=1e9"});
  const pid_t child = start({"run", "s.json", "--set", "/solver/end=1e9"});
  wait_for("o/frame_0003.vtu", child);
  fs::remove(folder() / "o/frame_0001.vtu");
  kill(child, SIGTERM);
  const Outcome ended = finish(child);
  EXPECT_EQ(ended.code, 6) << ended;
  EXPECT_TRUE(ended.says("run.pvd: 1 of its frames")) << ended;
}

TEST_F(Folders, ModesAreWrittenBesideTheResultsOfARun) {
  ASSERT_EQ(scene("run", "").code, 0);
  const auto results = contents("out/s");
  const auto find = [&](const char* count, const char* out) {
    return suture({"modes", "s.json", "--count", count, "-o", out});
  };
  const Outcome found = suture({"modes", "s.json", "--count", "8"});
  EXPECT_EQ(found.code, 0) << found;
  EXPECT_TRUE(found.says("zero: a rigid motion") && found.says("modes.pvd")) << found;
  EXPECT_EQ(contents("out/s"), results);
  EXPECT_EQ(contents("out/s/modes").size(), 10u);
  EXPECT_NE(read("out/s/modes/mode_0008.vtu").find("\"mode\""), std::string::npos);
  EXPECT_EQ(read("out/s/modes/modes.csv").find("mode,kind,frequency [Hz],omega^2 [1/s^2]"), 0u);
  EXPECT_EQ(find("7", "here").code, 0);
  EXPECT_EQ(find("3", "here").code, 0);
  EXPECT_EQ(contents("here").size(), 5u) << "earlier modes stayed";
  write("here/notes.vtu", "not a result");
  EXPECT_EQ(find("2", "here").code, 0);
  EXPECT_EQ(read("here/notes.vtu"), "not a result");
}

}  // namespace
}  // namespace suture::testing
