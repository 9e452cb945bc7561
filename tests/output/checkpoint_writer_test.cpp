// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/checkpoint_writer.hpp"

#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/output/checkpoints.hpp"
#include "tests/output/output.hpp"
#include "tests/output/small_files.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;
using Numbers = std::vector<std::uint64_t>;

void submit(CheckpointWriter& writer, std::uint64_t step, std::size_t size = 1) {
  CheckpointHeader header = some_header();
  header.step = step;
  writer.submit(header, some_state(size));
}

TEST(CheckpointWriter, KeepsTheNewest) {
  for (const unsigned keep : {1, 2, 5}) {
    const TemporaryFolder folder;
    CheckpointWriter writer({.folder = output(folder / "a" / "b"), .keep = keep});
    for (std::uint64_t n = 1; n <= 5; ++n) submit(writer, 10 * n, n);
    writer.finish();
    Numbers expected;
    for (std::uint64_t n = 6 - keep; n <= 5; ++n) expected.push_back(n);
    EXPECT_EQ(checkpoints_in(folder / "a" / "b"), expected);
    EXPECT_EQ(writer.newest(), folder / "a" / "b" / "checkpoint_0005.h5");
    const Checkpoint read = read_checkpoint(writer.newest());
    EXPECT_EQ(read.header.number, 5u);
    EXPECT_EQ(read.header.step, 50u);
    EXPECT_TRUE(same(read.state, some_state(5)));
  }
}

TEST(CheckpointWriter, NothingIsLostWithoutFinish) {
  const TemporaryFolder folder;
  {
    CheckpointWriter writer({.folder = output(folder.path())});
    EXPECT_EQ(writer.newest(), fs::path());
    submit(writer, 1);
    submit(writer, 2);
  }
  EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{1, 2}));
}

TEST(CheckpointWriter, FilesOfAnotherRunGoWhenThereIsANewOne) {
  const TemporaryFolder folder;
  for (const char* name :
       {"checkpoint_0001.h5", "checkpoint_0007.h5", "checkpoint_12345.h5", "checkpoint_7.h5",
        "checkpoint_00008.h5", "checkpoint_0009.h5.bak", "checkpoint_0008.h5.part"})
    folder.write(name, "old");
  folder.write(".suture-run",
               "checkpoint_0001.h5\ncheckpoint_0007.h5\ncheckpoint_12345.h5\n"
               "checkpoint_0008.h5\n");
  CheckpointWriter writer({.folder = output(folder.path())});
  writer.finish();
  EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{1, 7, 12345}));
  submit(writer, 1);
  writer.finish();
  EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{1}));
  EXPECT_EQ(read_checkpoint(folder / "checkpoint_0001.h5").header.step, 1u);
  for (const char* name : {"checkpoint_7.h5", "checkpoint_00008.h5", "checkpoint_0009.h5.bak"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  EXPECT_FALSE(fs::exists(folder / "checkpoint_0008.h5.part"));
}

TEST(CheckpointWriter, GoesOnBehindTheOneResumedFrom) {
  const TemporaryFolder folder;
  {
    CheckpointWriter writer({.folder = output(folder.path()), .keep = 4});
    for (std::uint64_t n = 1; n <= 4; ++n) submit(writer, n);
  }
  // Twice from the second: what was written after it belongs to a future that is computed again.
  for (int round = 0; round < 2; ++round) {
    const fs::path from = folder / "checkpoint_0002.h5";
    CheckpointWriter writer(
        {.folder = output(folder.path()), .keep = 3, .resumed_from = from, .resumed_number = 2});
    EXPECT_EQ(writer.newest(), from);
    submit(writer, 33);
    writer.finish();
    EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{1, 2, 3}));
    EXPECT_EQ(read_checkpoint(folder / "checkpoint_0003.h5").header.step, 33u);
  }
  CheckpointWriter writer({.folder = output(folder.path()),
                           .keep = 2,
                           .resumed_from = folder / "checkpoint_0003.h5",
                           .resumed_number = 3});
  submit(writer, 44);
  writer.finish();
  EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{3, 4}));
}

TEST(CheckpointWriter, ResumedFromAnotherFolderLeavesThatAlone) {
  const TemporaryFolder there, folder;
  {
    CheckpointWriter writer({.folder = output(there.path())});
    submit(writer, 1);
    submit(writer, 2);
  }
  CheckpointWriter writer({.folder = output(folder.path()),
                           .keep = 1,
                           .resumed_from = there / "checkpoint_0002.h5",
                           .resumed_number = 2});
  submit(writer, 3);
  submit(writer, 4);
  writer.finish();
  EXPECT_EQ(checkpoints_in(there.path()), (Numbers{1, 2}));
  EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{4}));
}

TEST(CheckpointWriter, AFullDiskIsReportedOnceAndOlderOnesStay) {
  const TemporaryFolder folder;
  CheckpointWriter writer({.folder = output(folder.path()), .keep = 1});
  submit(writer, 1);
  writer.finish();
  {
    const SmallFiles limit(5000);
    submit(writer, 2);
    try {
      writer.finish();
      FAIL() << "no error";
    } catch (const IoError& error) {
      EXPECT_EQ(std::string(error.what()),
                (folder / "checkpoint_0002.h5").string() + ": cannot be written: " + too_large);
    }
    writer.finish();
  }
  EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{1}));
  EXPECT_EQ(read_checkpoint(writer.newest()).header.step, 1u);
  submit(writer, 3);
  writer.finish();
  EXPECT_EQ(checkpoints_in(folder.path()), (Numbers{3}));
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".part");
}

TEST(CheckpointWriter, AFileInPlaceOfTheFolderIsReported) {
  const TemporaryFolder folder;
  folder.write("out", "x");
  CheckpointWriter writer({.folder = output(folder / "out")});
  submit(writer, 1);
  EXPECT_THROW(writer.finish(), IoError);
}

}  // namespace
}  // namespace suture
