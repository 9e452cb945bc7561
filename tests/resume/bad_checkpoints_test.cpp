// SPDX-License-Identifier: GPL-3.0-or-later
//
// Checkpoints that cannot be resumed: one error that names the file and the reason, and no byte in
// the folder changes.
#include <map>

#include "kernel/output/checkpoint_file.hpp"
#include "tests/apps/program.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/output/checkpoints.hpp"
#include "tests/output/small_files.hpp"

namespace suture::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* more = R"(,
  "gravity": [0, -9.8, 0],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
  "output": {"directory": "out", "every_steps": 1, "energies": {"every_steps": 1}},
  "checkpoint": {"every_steps": 5})";

class BadCheckpoint : public Program {
 protected:
  std::map<std::string, std::string> all_files() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder())) {
      const std::string name = entry.path().filename().string();
      if (entry.is_regular_file() && name != ".out" && name != ".err")
        files[entry.path().string()] = read_text(entry.path());
    }
    return files;
  }
  void run(const std::vector<std::string>& sets = {}) {
    const Outcome outcome = scene("run", more, sets);
    ASSERT_EQ(outcome.code, 0) << outcome;
    ASSERT_TRUE(fs::exists(folder() / file)) << outcome;
    whole_ = read("out/energies.csv");
  }
  void expect_refused(const std::string& from, int code, const std::vector<std::string>& words,
                      const std::vector<std::string>& options = {}) {
    const auto before = all_files();
    std::vector<std::string> arguments{"run", "--resume", from};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = suture(arguments);
    EXPECT_EQ(outcome.code, code) << from << '\n' << outcome;
    for (const std::string& word : words)
      EXPECT_TRUE(outcome.says(word)) << from << ": " << word << '\n' << outcome;
    std::size_t errors = 0;
    for (std::size_t at = 0; (at = outcome.err.find("error", at)) != std::string::npos; ++at)
      ++errors;
    EXPECT_EQ(errors, 1u) << outcome;
    EXPECT_TRUE(all_files() == before) << from << ": nothing was touched\n" << outcome;
  }
  void expect_resumes(const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments{"run", "--resume", file};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = suture(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome;
    EXPECT_EQ(read("out/energies.csv"), whole_);
  }
  /// The header of a sound checkpoint, changed.
  template <class Change>
  void forge(const std::string& to, Change change) const {
    Checkpoint checkpoint = read_checkpoint(folder() / file);
    change(checkpoint.header);
    write_checkpoint(folder() / to, checkpoint.header, std::move(checkpoint.state));
  }
  void copy_plugin(const std::string& from) const {
    for (const char* kind : {".so", ".avx2.so", ".avx512.so"}) {
      const fs::path to = folder() / (std::string("memory") + kind);
      fs::remove(to);
      const fs::path source = TEST_PLUGINS "/" + from + kind;
      if (fs::exists(source)) fs::copy_file(source, to);
    }
  }
  void run_with_plugin() {
    copy_plugin("memory");
    run({R"(/plugins=["memory.so"])",
         R"(/models/-={"model": "memory", "parameters": {"k": 1, "r": 1}})"});
  }

  const std::string file = "out/checkpoint_0001.h5";
  std::string whole_;
};

TEST_F(BadCheckpoint, OfAnotherKindOrVersionOrDamagedIsRefused) {
  run();
  const std::string sound = read(file);
  std::string bytes = sound;
  bytes[sound.size() / 2] ^= 1;
  write("out/damaged.h5", bytes);
  expect_refused("out/damaged.h5", 3,
                 {"out/damaged.h5", "damaged", "resume from an older checkpoint"});
  write("out/cut.h5", sound.substr(0, sound.size() / 3));
  expect_refused("out/cut.h5", 3, {"out/cut.h5", "is truncated"});
  write("out/short.h5", sound.substr(0, 100));
  expect_refused("out/short.h5", 3, {"out/short.h5", "is truncated"});
  write("out/empty.h5", "");
  expect_refused("out/empty.h5", 3, {"out/empty.h5", "is empty"});
  write("out/text.h5", "no checkpoint");
  expect_refused("out/text.h5", 3, {"out/text.h5", "is not a Suture checkpoint"});
  bytes = sound;
  bytes[bytes.find("format ") + 7] = '1';
  write("out/format.h5", bytes);
  expect_refused("out/format.h5", 3, {"out/format.h5", "format 1"});
  expect_refused("out/missing.h5", 3, {"out/missing.h5", "cannot be opened", "the newest one"});
  expect_refused("out", 3, {"is a folder"});
  forge("out/older.h5", [](CheckpointHeader& header) { header.program = "suture 0.0.7"; });
  expect_refused("out/older.h5", 3, {"out/older.h5", "suture 0.0.7"});
  expect_resumes();
}

// Values that the mesh gives are not in the checkpoint.
TEST_F(BadCheckpoint, OfOtherArraysIsRefused) {
  const auto mesh = [](const char* modulus) {
    return "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
           "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\n"
           "CELL_TYPES 1\n12\nCELL_DATA 1\nSCALARS modulus double\nLOOKUP_TABLE default\n" +
           std::string(modulus) + "\n";
  };
  write("m.vtk", mesh("1e5"));
  run({R"(/mesh={"file": "m.vtk"})", R"(/models/0/parameters/E={"array": "modulus"})",
       R"(/constraints=[{"fix": "xyz", "where": {"nearest": [0, 0, 0]}}])"});
  write("m.vtk", mesh("1.0000001e5"));
  expect_refused(file, 3, {file, "a different mesh", "m.vtk"});
  write("m.vtk", mesh("1e5"));
  expect_resumes();
}

TEST_F(BadCheckpoint, OfAnotherMeshIsRefused) {
  const auto mesh = [](const char* z) {
    return "MeshVersionFormatted 2\nDimension 3\nVertices 8\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n"
           "0 0 1 0\n1 0 1 0\n1 1 1 0\n0 1 " +
           std::string(z) + " 0\nHexahedra 1\n1 2 3 4 5 6 7 8 0\nEnd\n";
  };
  write("m.mesh", mesh("1"));
  run({R"(/mesh={"file": "m.mesh"})",
       R"(/constraints=[{"fix": "xyz", "where": {"nearest": [0, 0, 0]}}])"});
  write("m.mesh", mesh("1.0000001"));
  expect_refused(file, 3, {file, "a different mesh", "m.mesh"});
  fs::remove(folder() / "m.mesh");
  expect_refused(file, 3, {"m.mesh", "no file"});
  write("m.mesh", mesh("1"));
  expect_resumes();
  run();
  expect_refused(file, 3, {file, "a different mesh"}, {"--set", "/mesh/box/cells=[2, 2, 3]"});
}

TEST_F(BadCheckpoint, OfAnotherPluginIsRefused) {
  run_with_plugin();
  copy_plugin("memory-wide");  // options of the run can be why, too
  expect_refused(file, 3, {file, "memory", "flow (1, a state)", "flow (2, a state)"});
  copy_plugin("memory-next");
  expect_refused(file, 4, {file, "memory 1.0", "memory 2.0"});
  copy_plugin("none");
  expect_refused(file, 4, {"memory.so"});
  copy_plugin("memory");
  expect_resumes();
}

TEST_F(BadCheckpoint, IsRefusedWithoutItsTables) {
  run();
  const std::string table = read("out/energies.csv");
  fs::rename(folder() / "out/energies.csv", folder() / "kept.csv");
  expect_refused(file, 3, {file, "energies.csv", "is missing"});
  write("out/energies.csv", table.substr(0, 150));
  expect_refused(file, 3, {file, "energies.csv", "150 bytes"});
  write("out/energies.csv", "other" + table);
  expect_refused(file, 3, {file, "energies.csv", "not the table of this run"});
  write("out/energies.csv", table);
  expect_resumes();
}

TEST_F(BadCheckpoint, GoesOnTwiceAndWithOtherThreads) {
  run();
  expect_resumes();
  expect_resumes({"--set", "/solver/threads=3"});
  expect_resumes({"--set", "/checkpoint/every_steps=3"});
}

TEST_F(BadCheckpoint, OfAnotherSceneGoesOnOrIsRefused) {
  run();
  for (const char* set :
       {R"(/solver/integrator="velocity-verlet")", R"(/solver/until="rest")", "/solver/damping=3",
        R"(/solver/dt="auto")", R"(/events=[{"at": 0.008, "pierce": {"where": {"ids": [1]}}}])",
        R"(/loads=[{"where": "all", "pressure": 3}])", R"(/output/probes={"at": []})",
        R"(/output/probes={"at": [{"name": "a", "point": [0, 0, 0]}]})", "/output=false",
        R"(/solver/sleep={"acceleration": 1, "velocity": 1})", "/solver/end=0.02",
        "/solver/end=0.001", R"(/constraints/-={"fix": "x", "where": {"set": "x1"}})",
        R"(/models/-={"model": "tm-faure", "parameters": {"E": 1, "nu": 0, "rho": 1}})",
        R"(/models=[{"model": "mss-baudet", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1}}])"}) {
    const Outcome outcome = suture({"run", "--resume", file, "--set", set});
    EXPECT_TRUE(outcome.code == 0 || (outcome.code >= 3 && outcome.code <= 5)) << set << outcome;
    if (outcome.code == 3) {
      EXPECT_TRUE(outcome.says(file) || outcome.says("as it was run")) << outcome;
    }
    run();
  }
  const Outcome outcome = suture({"run", "--no-skip", "--resume", file});
  EXPECT_TRUE(outcome.code == 0 || outcome.code == 3) << outcome;
}

TEST_F(BadCheckpoint, OnAFullDiskEndsTheRunAndLeavesNothingHalfWritten) {
  Outcome outcome;
  {
    const SmallFiles limit(1 << 14);
    outcome = scene("run", more);
  }
  EXPECT_EQ(outcome.code, 6) << outcome;
  EXPECT_TRUE(outcome.says("checkpoint_0001.h5")) << outcome;
  for (const auto& entry : fs::directory_iterator(folder() / "out")) {
    const std::string name = entry.path().filename().string();
    EXPECT_FALSE(name.starts_with("checkpoint_")) << name;
    EXPECT_FALSE(name.ends_with(".part")) << name;
  }
}

}  // namespace
}  // namespace suture::testing
