// SPDX-License-Identifier: GPL-3.0-or-later
//
// What ends the program from outside: signals, limits and pipes.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>

#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

class Signals : public Program {
 protected:
  bool exists(const std::string& name) const { return std::filesystem::exists(folder() / name); }
  /// A line of the shell in the working folder, $S being the program; the exit code is what the
  /// line writes to "code".
  Outcome shell(const std::string& line) const {
    const std::string whole =
        "cd " + folder().string() + " && S=" SUTURE_PROGRAM + "; { " + line + "; } > .out 2> .err";
    EXPECT_EQ(std::system(whole.c_str()), 0) << whole;
    const std::string code = read("code");
    return {code.empty() ? -1 : std::stoi(code), read(".out"), read(".err")};
  }
};

const std::string frames = ", \"output\": {\"directory\": \"o\", \"every_steps\": 100}";

TEST_F(Signals, EndTheBuildingOfALargeMeshAtOnce) {
  scene("check", frames);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t child = start({"run", "s.json", "--set", "/mesh/box/cells=[160,160,160]"});
    wait_for("o/.suture-run", child);
    usleep(300'000);
    const auto sent = std::chrono::steady_clock::now();
    kill(child, signal);
    const Outcome ended = finish(child);
    EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(1));
    EXPECT_EQ(ended.code, 128 + signal) << ended;
    EXPECT_TRUE(ended.says("stopped; nothing was written")) << ended;
    EXPECT_FALSE(exists("o")) << "left as it was found";
  }
}

TEST_F(Signals, EndARunInOrder) {
  scene("check", frames);
  for (const int signal : {SIGTERM, SIGHUP}) {
    std::filesystem::remove_all(folder() / "o");
    const Outcome ended =
        interrupted({"run", "s.json", "--set", "/solver/end=1e9", "--set", "/checkpoint={}"},
                    signal, "o/frame_0001.vtu");
    EXPECT_EQ(ended.code, 128 + signal) << ended;
    EXPECT_TRUE(ended.says("interrupted")) << ended;
    EXPECT_TRUE(exists("o/checkpoint_0001.h5"));
  }
}

TEST_F(Signals, HangingUpIsIgnoredUnderNohup) {
  scene("check", frames, {"/solver/end=1e9"});
  std::signal(SIGHUP, SIG_IGN);
  const pid_t child = start({"run", "s.json", "--set", "/solver/end=1e9"});
  std::signal(SIGHUP, SIG_DFL);
  wait_for("o/frame_0001.vtu", child);
  kill(child, SIGHUP);
  wait_for("o/frame_0009.vtu", child);
  kill(child, SIGTERM);
  EXPECT_EQ(finish(child).code, 128 + SIGTERM);
}

TEST_F(Signals, APipeThatIsClosedIsAnError) {
  const Outcome models = shell("{ sleep 0.1; $S models; echo $? > code; } | true");
  EXPECT_EQ(models.code, 6) << models;
  EXPECT_TRUE(models.says("cannot write all results to standard output")) << models;
  scene("check", frames);
  const Outcome run = shell("{ sleep 0.1; $S run s.json 2>&1; echo $? > code; } | true");
  EXPECT_EQ(run.code, 6) << run;
  EXPECT_TRUE(exists("o/run.pvd")) << "the run goes on";
}

TEST_F(Signals, AFullDiskBehindStandardOutputIsAnError) {
  const Outcome models = shell("$S models > /dev/full; echo $? > code");
  EXPECT_EQ(models.code, 6) << models;
  EXPECT_TRUE(models.says("standard output: No space left on device")) << models;
}

TEST_F(Signals, TheLimitOnTheSizeOfFilesIsAnError) {
  scene("check",
        ", \"output\": {\"directory\": \"o\", \"compression\": \"none\", \"every_steps\": 1}");
  const Outcome run =
      shell("ulimit -f 16; $S run s.json --set '/mesh/box/cells=[10,10,10]'; echo $? > code");
  EXPECT_EQ(run.code, 6) << run;
  EXPECT_TRUE(run.says("frame_0000.vtu: cannot be written: File too large") &&
              run.says("ulimit -f"))
      << run;
  for (const auto& entry : std::filesystem::directory_iterator(folder() / "o"))
    EXPECT_TRUE(entry.path().filename() == ".suture-run" ||
                entry.path().filename() == "provenance.json")
        << entry.path() << ": nothing behind the gap, nothing half";
  const Outcome mesh = shell(
      "ulimit -f 16; $S mesh generate box m.vtk --size 1,1,1 --cells 20,20,20; echo $? > code");
  EXPECT_EQ(mesh.code, 6) << mesh;
  EXPECT_TRUE(mesh.says("m.vtk: cannot be written: File too large")) << mesh;
  EXPECT_FALSE(exists("m.vtk") || exists("m.vtk.part"));
}

}  // namespace
}  // namespace suture::testing
