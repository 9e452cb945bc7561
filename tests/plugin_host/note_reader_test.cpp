// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/note_reader.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <random>

#include "tests/plugin_host/test_plugins.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A file with the given content, removed at the end of the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content)
      : path(fs::temp_directory_path() / ("suture-note-" + std::to_string(getpid()) + ".so")) {
    std::ofstream(path, std::ios::binary).write(content.data(), std::streamsize(content.size()));
  }
  ~TemporaryFile() { fs::remove(path); }
  const fs::path path;
};

std::string problem_of(const std::string& content) {
  return read_note(TemporaryFile(content).path).problem;
}

TEST(NoteReader, ReadsWhatThePluginSays) {
  const auto note = read_note(plugins / "good.so");
  EXPECT_EQ(note.problem, "");
  EXPECT_EQ(note.plugin, "good");
  EXPECT_EQ(note.models, std::vector<std::string>{"good"});
  EXPECT_EQ(note.isa, "base");
  EXPECT_EQ(note.lanes, 8u);
}

TEST(NoteReader, SeveralModelsAreSplitAtSpaces) {
  EXPECT_EQ(read_note(plugins / "other-ids.so").models,
            (std::vector<std::string>{"other-ids", "some-other-model"}));
}

TEST(NoteReader, SaysWhatAFileIsThatIsNoPlugin) {
  EXPECT_EQ(read_note("/no/such/file.so").problem, "no such file");
  EXPECT_EQ(read_note("/").problem, "it is not a regular file");
  EXPECT_EQ(problem_of(""), "it is not a shared library (not an ELF file)");
  EXPECT_EQ(problem_of("{ \"mesh\": 1 }"), "it is not a shared library (not an ELF file)");
  EXPECT_EQ(problem_of("\x7f"
                       "ELF"),
            "it is truncated within its ELF header");
  EXPECT_NE(read_note(plugins / "no-note.so").problem.find("not a Suture plugin"),
            std::string::npos);
}

TEST(NoteReader, ProgramsAndForeignMachinesAreNamed) {
  std::string content = bytes_of(plugins / "good.so");
  content[18] = 40;  // e_machine: ARM
  EXPECT_NE(problem_of(content).find("a different processor architecture (ELF machine 40"),
            std::string::npos);
  content = bytes_of(plugins / "good.so");
  content[16] = 1;  // e_type: ET_REL
  EXPECT_NE(problem_of(content).find("not a shared library (an object file"), std::string::npos);
}

// Section headers are at the end, so the last byte is missed, too.
TEST(NoteReader, EveryTruncationIsRefused) {
  const std::string whole = bytes_of(plugins / "good.so");
  EXPECT_EQ(problem_of(whole), "");
  EXPECT_NE(problem_of(whole.substr(0, whole.size() - 1)), "");
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const std::size_t length = random() % whole.size();
    EXPECT_NE(problem_of(whole.substr(0, length)), "") << "of length " << length;
  }
}

// Bytes of the headers and of the note set at random: no crash (run under the
// address sanitizer too), and a note is believed only if its magic is intact.
TEST(NoteReader, SurvivesDamage) {
  const std::string whole = bytes_of(plugins / "good.so");
  const std::size_t head = std::min<std::size_t>(whole.size(), 2048);
  std::mt19937 random(2);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string content = whole;
    for (int k = 0; k < 1 + i % 8; ++k) content[random() % head] = static_cast<char>(random());
    refused += problem_of(content).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
}

TEST(NoteReader, SystemLibrariesAreNoPlugins) {
  for (const char* file : {"/lib/x86_64-linux-gnu/libm.so.6", "/lib/aarch64-linux-gnu/libm.so.6"})
    if (fs::exists(file)) {
      EXPECT_NE(read_note(file).problem.find("has no Suture note"), std::string::npos);
    }
}

TEST(NoteReader, IncompatibleAbisAreRefusedWithBothVersions) {
  EXPECT_EQ(read_note(plugins / "other-major.so").problem,
            "it is built for plugin ABI 7.0, this Suture has ABI 1.0 (the major number must be "
            "equal); rebuild the plugin with this Suture's SDK");
  EXPECT_EQ(read_note(plugins / "newer-minor.so").problem,
            "it is built for plugin ABI 1.9, newer than this Suture's ABI 1.0; use a newer "
            "Suture, or rebuild the plugin with this one's SDK");
  EXPECT_EQ(read_note(plugins / "other-lanes.so").problem,
            "it is built for batches of 4 cells, this Suture has 8; rebuild the plugin with this "
            "Suture's SDK");
}

TEST(NoteReader, InstructionSetsThatDoNotRunAreRefused) {
  setenv("SUTURE_ISA", "base", 1);
  EXPECT_NE(read_note(plugins / "good-avx512.so").problem.find("it is built for avx512"),
            std::string::npos);
  EXPECT_EQ(read_note(plugins / "good.so").problem, "");
  unsetenv("SUTURE_ISA");
}

}  // namespace
}  // namespace suture
