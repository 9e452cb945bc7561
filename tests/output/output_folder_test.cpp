// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/output_folder.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "kernel/base/error.hpp"
#include "tests/output/output.hpp"
#include "tests/output/small_files.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

void put(OutputFolder& out, const std::string& name, const std::string& text) {
  out.write(name, [&](OutputFile& file) { file.write(text); });
}

std::string refusal_of(const std::function<void()>& act) {
  try {
    act();
    return "";
  } catch (const IoError& error) {
    return error.what();
  }
}

TEST(OutputFolder, LinksAreReplacedAndTheirTargetsStay) {
  const TemporaryFolder folder;
  folder.write("victim", "precious");
  fs::create_directory(folder / "out");
  for (const char* name : {"run.pvd", "frame_0000.vtu.part", "energies.csv"})
    fs::create_symlink("../victim", folder / "out" / name);
  OutputFolder out(folder / "out", folder.path());
  put(out, "frame_0000.vtu", "a frame");
  put(out, "run.pvd", "a list");
  out.grow("energies.csv")->write("a table");
  EXPECT_EQ(read_text(folder / "victim"), "precious");
  EXPECT_EQ(read_text(folder / "out/run.pvd"), "a list");
  EXPECT_EQ(read_text(folder / "out/frame_0000.vtu"), "a frame");
  EXPECT_EQ(read_text(folder / "out/energies.csv"), "a table");
  EXPECT_FALSE(fs::is_symlink(folder / "out/energies.csv"));
  fs::create_symlink("../victim", folder / "out/probes.csv");
  EXPECT_NE(refusal_of([&] { out.grow("probes.csv", 3); }), "") << "a table that goes on";
  EXPECT_EQ(read_text(folder / "victim"), "precious");
}

TEST(OutputFolder, ALinkInPlaceOfItsListIsRefused) {
  const TemporaryFolder folder;
  folder.write("victim", "precious\n");
  fs::create_symlink("victim", folder / ".suture-run");
  EXPECT_NE(refusal_of([&] { put(*output(folder.path()), "run.pvd", "x"); }), "");
  EXPECT_EQ(read_text(folder / "victim"), "precious\n");
}

TEST(OutputFolder, NoFolderBelowItsRootIsALink) {
  const TemporaryFolder folder, other;
  fs::create_directory_symlink(other.path(), folder / "link");
  for (const char* path : {"link", "link/deeper"}) {
    OutputFolder out(folder / path, folder.path());
    const std::string refusal = refusal_of([&] { out.open(); });
    EXPECT_NE(refusal.find("is a link"), refusal.npos) << refusal;
    EXPECT_NE(refusal.find("--output"), refusal.npos) << refusal;
  }
  EXPECT_TRUE(fs::is_empty(other.path()));
  put(*output(folder / "link"), "run.pvd", "as the command line says");
  EXPECT_TRUE(fs::exists(other / "run.pvd"));
}

TEST(OutputFolder, WhatAnEarlierRunLeftGoesAsOneSet) {
  const TemporaryFolder folder;
  const std::vector<std::string> earlier{"run.pvd",      "frame_0000.vtu",    "frame_0001.vtu",
                                         "failed.pvd",   "mode.pvd",          "failed_0000.vtu",
                                         "energies.csv", "checkpoint_0003.h5"};
  {
    OutputFolder out(folder.path());
    for (const std::string& name : earlier) put(out, name, "old");
  }
  folder.write("frame_0001.vtu.part", "of a run that was killed");
  folder.write("frame_0009.vtu", "not listed");
  folder.write("notes.txt", "mine");
  OutputFolder out(folder.path());
  out.open();
  {
    const SmallFiles limit(100);
    EXPECT_NE(refusal_of([&] { put(out, "frame_0000.vtu", std::string(1000, 'x')); }), "");
  }
  for (const std::string& name : earlier) EXPECT_EQ(read_text(folder / name), "old") << name;
  put(out, "frame_0000.vtu", "new");
  for (const std::string& name : earlier)
    EXPECT_EQ(fs::exists(folder / name), name == "frame_0000.vtu") << name;
  EXPECT_FALSE(fs::exists(folder / "frame_0001.vtu.part"));
  EXPECT_EQ(read_text(folder / "frame_0009.vtu"), "not listed");
  EXPECT_EQ(read_text(folder / "notes.txt"), "mine");
  EXPECT_EQ(read_text(folder / ".suture-run"), "frame_0000.vtu\n");
}

TEST(OutputFolder, AListThatNamesOtherFilesIsNotBelieved) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "out");
  folder.write("above.vtu", "mine");
  for (const char* name : {"out/notes.txt", "out/keys", "out/old.vtu"}) folder.write(name, "x");
  folder.write("out/.suture-run", "../above.vtu\n" + (folder / "above.vtu").string() +
                                      "\nnotes.txt\nkeys\n.\n..\n\nold.vtu\nunfinished");
  put(*output(folder / "out"), "run.pvd", "new");
  for (const char* name : {"above.vtu", "out/notes.txt", "out/keys"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  EXPECT_FALSE(fs::exists(folder / "out/old.vtu"));
}

TEST(OutputFolder, WhatARunGoesOnFromStays) {
  const TemporaryFolder folder;
  {
    OutputFolder out(folder.path());
    for (const char* name : {"a_0000.vtu", "a_0001.vtu", "a_0002.vtu"}) put(out, name, name);
    put(out, "a.pvd", "0 1 2");
  }
  OutputFolder out(folder.path());
  out.keep("a_0000.vtu");
  out.keep("a.pvd", "0");
  EXPECT_EQ(read_text(folder / "a.pvd"), "0 1 2") << "nothing was written yet";
  folder.write("a_0000.vtu.part", "of a run that was killed before its first frame");
  out.begin();
  EXPECT_EQ(read_text(folder / "a.pvd"), "0");
  EXPECT_TRUE(fs::exists(folder / "a_0000.vtu"));
  EXPECT_FALSE(fs::exists(folder / "a_0000.vtu.part"));
  EXPECT_FALSE(fs::exists(folder / "a_0001.vtu") || fs::exists(folder / "a_0002.vtu"));
}

/// A process that has opened a folder, until it is killed.
class Holder {
 public:
  explicit Holder(const fs::path& path) {
    int ready[2];
    if (pipe(ready) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      OutputFolder out(path);
      out.open();
      if (write(ready[1], "x", 1) == 1) pause();
      _exit(1);
    }
    char byte = 0;
    EXPECT_EQ(read(ready[0], &byte, 1), 1);
    for (const int end : ready) close(end);
  }
  void kill() {
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = 0;
};

TEST(OutputFolder, HasOneWriterUntilThatEndsHoweverItDoes) {
  const TemporaryFolder folder;
  Holder holder(folder / "out");
  const std::string refusal = refusal_of([&] { output(folder / "out")->open(); });
  EXPECT_EQ(refusal, (folder / "out").string() + ": another run writes to this folder (process " +
                         std::to_string(holder.pid()) +
                         "); choose another one with --output, or wait until that run ends");
  EXPECT_TRUE(fs::exists(folder / "out")) << "the first one's";
  holder.kill();
  put(*output(folder / "out"), "run.pvd", "x");
}

/// The message to another process that opens the folder and ends at once.
std::string refusal_in_another_process(const fs::path& path) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    const std::string refusal = refusal_of([&] { output(path)->open(); });
    _exit(write(ends[1], refusal.data(), refusal.size()) < 0);
  }
  close(ends[1]);
  std::string text(1000, ' ');
  const ssize_t size = read(ends[0], text.data(), text.size());
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return text;
}

TEST(OutputFolder, HasOneWriterInAProcessToo) {
  const TemporaryFolder folder;
  OutputFolder first(folder / "out");
  first.open();
  for (int attempt = 0; attempt < 2; ++attempt) {
    const std::string refusal = refusal_of([&] { output(folder / "out")->open(); });
    EXPECT_NE(refusal.find("another run of this process writes to this folder"), refusal.npos)
        << refusal;
    const std::string other = refusal_in_another_process(folder / "out");
    EXPECT_NE(other.find("(process " + std::to_string(getpid()) + ")"), other.npos) << other;
  }
  put(first, "run.pvd", "x");
  first.close();
  EXPECT_EQ(refusal_in_another_process(folder / "out"), "");
  put(*output(folder / "out"), "run.pvd", "y");
  EXPECT_NE(refusal_of([&] { put(first, "run.pvd", "z"); }), "") << "it has ended";
  EXPECT_EQ(read_text(folder / "out/run.pvd"), "y");
}

TEST(OutputFolder, IsContinuedByTheRunThatWroteItOnly) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& earlier) {
    OutputFolder out(folder.path());
    return refusal_of([&] { out.continue_run(earlier); });
  };
  EXPECT_EQ(refusal("a"), "") << "there is nothing to replace";
  {
    OutputFolder out(folder.path());
    out.set_run("a");
    put(out, "checkpoint_0001.h5", "a");
  }
  EXPECT_EQ(refusal("a"), "");
  for (const char* other : {"b", ""})
    EXPECT_NE(refusal(other).find("contains the results of another run"), std::string::npos);
  {
    OutputFolder out(folder.path());
    out.continue_run("a");
    out.set_run("b");
    out.keep("checkpoint_0001.h5");
    put(out, "checkpoint_0002.h5", "b");
  }
  EXPECT_EQ(refusal("a") + refusal("b"), "") << "it has checkpoints of both";
  put(*output(folder.path()), "run.pvd", "a run that cannot be resumed");
  EXPECT_NE(refusal("a"), "");
  EXPECT_NE(refusal("b"), "");
}

TEST(OutputFolder, LeavesNoTraceWithoutAFile) {
  const TemporaryFolder folder;
  { output(folder / "a/b")->open(); }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  fs::create_directory(folder / "a");
  folder.write("a/mine", "x");
  { output(folder / "a/b")->open(); }
  EXPECT_TRUE(fs::exists(folder / "a/mine"));
  EXPECT_FALSE(fs::exists(folder / "a/b"));
  { output(folder / "a")->open(); }
  EXPECT_FALSE(fs::exists(folder / "a/.suture-run"));
}

TEST(OutputFolder, OneThatWasRemovedOrReplacedIsReported) {
  for (const bool replaced : {false, true}) {
    const TemporaryFolder folder;
    OutputFolder out(folder / "out");
    put(out, "run.pvd", "x");
    fs::remove_all(folder / "out");
    if (replaced) fs::create_directory(folder / "out");
    const std::string refusal = refusal_of([&] { put(out, "run.pvd", "y"); });
    EXPECT_NE(refusal.find("was removed or replaced"), refusal.npos) << refusal;
  }
}

}  // namespace
}  // namespace suture
