// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/checkpoint_file.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "kernel/base/error.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/output/checkpoints.hpp"
#include "tests/output/small_files.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

std::string refusal_of(const fs::path& path) {
  try {
    read_checkpoint(path);
    return "";
  } catch (const InputError& error) {
    const std::string text = error.what(), start = path.string() + ": ";
    EXPECT_TRUE(text.starts_with(start)) << text;
    return text.substr(std::min(start.size(), text.size()));
  }
}

TEST(CheckpointFile, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", some_header(), some_state(3));
  EXPECT_LT(fs::file_size(folder / "c.h5"), some_state(3).bytes() + 10000);
  const Checkpoint read = read_checkpoint(folder / "c.h5");
  EXPECT_TRUE(same(read.state, some_state(3)));
  EXPECT_EQ(read.header.program, "suture 0.1.0");
  EXPECT_EQ(read.header.scene_text, some_header().scene_text);
  EXPECT_EQ(read.header.mesh_hash, "");
  ASSERT_EQ(read.header.plugins.size(), 2u);
  EXPECT_EQ(read.header.plugins[1].file, "p/\xc3\xa9t\xc3\xa9.so");
  EXPECT_EQ(read.header.step, 123456789012u);
  EXPECT_EQ(read.header.time, 0.1);
  EXPECT_FALSE(fs::exists(folder / "c.h5.part"));
}

TEST(CheckpointFile, TheSameStateGivesTheSameBytes) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "a.h5", some_header(), some_state(3));
  write_checkpoint(folder / "b.h5", some_header(), some_state(3));
  EXPECT_EQ(read_text(folder / "a.h5"), read_text(folder / "b.h5"));
}

TEST(CheckpointFile, NamesAndSizesOfEveryKind) {
  StateTree tree;
  const std::string names[] = {"",    ".",   "..",       "a/b",   "/",        "%",
                               "%2F", "a b", "\xc3\xa9", "state", "with.dot", "0"};
  for (const std::string& name : names) {
    add(tree, name, Archive::Scalar::i32, 1, 1);
    add(tree.groups["groups"].groups[name], name, Archive::Scalar::f64, 3, 7);
  }
  for (const auto type :
       {Archive::Scalar::u8, Archive::Scalar::i32, Archive::Scalar::u32, Archive::Scalar::i64,
        Archive::Scalar::u64, Archive::Scalar::f32, Archive::Scalar::f64, Archive::Scalar::text}) {
    StateTree& group = tree.groups["type " + std::to_string(int(type))];
    for (const std::size_t columns : {1, 2, 16, 17, 3000}) {
      for (const std::size_t rows : {0, 1, 2, 256, 257, 70000}) {
        if (columns > 17 && rows > 2) continue;
        if (type == Archive::Scalar::text && columns > 1) continue;
        add(group, std::to_string(rows) + " x " + std::to_string(columns), type, columns, rows);
      }
    }
  }
  for (int i = 0; i < 1000; ++i)
    add(tree.groups["many"], std::to_string(i), Archive::Scalar::u64, 1, 1);
  for (int i = 0; i < 1000; ++i) tree.groups["many groups"].groups[std::to_string(i)];
  const TemporaryFolder folder;
  StateTree given = copy_of(tree);
  write_checkpoint(folder / "c.h5", some_header(), std::move(given));
  EXPECT_TRUE(same(read_checkpoint(folder / "c.h5").state, tree));
}

TEST(CheckpointFile, AGroupAndAListOfOneNameAreRefused) {
  StateTree tree;
  add(tree, "a", Archive::Scalar::f64, 1, 100);
  tree.groups["a"];
  const TemporaryFolder folder;
  EXPECT_THROW(write_checkpoint(folder / "c.h5", some_header(), std::move(tree)), IoError);
}

TEST(CheckpointFile, ReportsWhatIsNoCheckpoint) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(folder / "checkpoint_0009.h5"),
            "cannot be opened: No such file or directory; no checkpoint was found in " +
                folder.path().string());
  write_checkpoint(folder / "checkpoint_0002.h5", some_header(), some_state(1));
  write_checkpoint(folder / "checkpoint_0010.h5", some_header(), some_state(1));
  const std::string newest = "; the newest one is " + (folder / "checkpoint_0010.h5").string();
  EXPECT_EQ(refusal_of(folder / "checkpoint_0009.h5"),
            "cannot be opened: No such file or directory" + newest);
  EXPECT_EQ(refusal_of(folder.path()), "is a folder; give a checkpoint file" + newest);
  EXPECT_EQ(refusal_of(folder.write("empty", "")), "is empty; resume from an older checkpoint");
  EXPECT_EQ(refusal_of(folder.write("scene", "{\"suture\": 1}")),
            "is not a Suture checkpoint (checkpoint_NNNN.h5)");
  const std::string good = read_text(folder / "checkpoint_0002.h5");
  EXPECT_EQ(refusal_of(folder.write("foreign", good.substr(512))),
            "is an HDF5 file, but not a Suture checkpoint (checkpoint_NNNN.h5)");
  std::string other = good;
  other[other.find("format 9") + 7] = '1';
  EXPECT_EQ(refusal_of(folder.write("other", other)),
            "has format 1; this version of Suture reads format 9; resume it with the version that "
            "wrote it");
  EXPECT_EQ(refusal_of(folder.write("cut", good.substr(0, 2000))),
            "is truncated: it has 2000 of " + std::to_string(good.size()) +
                " bytes; resume from an older checkpoint");
  std::string damaged = good;
  damaged[good.size() / 2] ^= 1;
  EXPECT_EQ(
      refusal_of(folder.write("damaged", damaged)),
      "is damaged: its checksum does not match its contents; resume from an older checkpoint");
  EXPECT_EQ(
      refusal_of(folder.write("longer", good + "x")),
      "is damaged: its checksum does not match its contents; resume from an older checkpoint");
}

/// A file whose bytes are exchanged in place, which spares the disk.
class Bytes {
 public:
  Bytes(fs::path path, std::string good) : path_(std::move(path)), good_(std::move(good)) {
    std::ofstream(path_, std::ios::binary) << good_;
  }
  void write(const std::string& bytes) const {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    for (std::size_t at = 0; at < good_.size(); at += 4096) {
      const std::string_view piece = std::string_view(bytes).substr(at, 4096);
      if (piece == shown_.substr(at, 4096)) continue;
      file.seekp(std::streamoff(at));
      file << piece;
    }
    file.close();
    shown_ = bytes;
  }

 private:
  fs::path path_;
  std::string good_;
  mutable std::string shown_ = good_;
};

TEST(CheckpointFile, DamageAnywhereIsFound) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", some_header(), some_state(2));
  const std::string good = read_text(folder / "c.h5");
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  Bytes file(folder / "bad", good);
  ::testing::internal::CaptureStderr();
  for (std::size_t round = 0; round < 3000; ++round) {
    std::string bad = good;
    // Every byte of the block in front and of what follows it, then any.
    const std::size_t at = round < 1000 ? round : random() % good.size();
    bad[at] = char(bad[at] ^ (1 + random() % 255));
    for (std::size_t more = random() % 4; more-- > 0;) bad[random() % bad.size()] ^= char(random());
    file.write(bad);
    ASSERT_NE(refusal_of(folder / "bad"), "") << "byte " << at;
  }
  file.write(good);
  EXPECT_EQ(refusal_of(folder / "bad"), "");
  for (std::size_t size = good.size(); size > 0;) {
    size -= std::min<std::size_t>(size, 1 + random() % 1000);
    fs::resize_file(folder / "bad", size);
    ASSERT_NE(refusal_of(folder / "bad"), "") << size << " bytes";
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// HDF5's own checksums, as h5py sees them: the block in front is made to fit the damage.
TEST(CheckpointFile, Hdf5FindsDamageToo) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", some_header(), some_state(2));
  const std::string good = read_text(folder / "c.h5");
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  Bytes file(folder / "bad", good);
  ::testing::internal::CaptureStderr();
  int unnoticed = 0;
  for (int round = 0; round < 1000; ++round) {
    std::string bad = good;
    const std::size_t at = 512 + random() % (good.size() - 512);
    bad[at] = char(bad[at] ^ (1 + random() % 255));
    file.write(with_block(bad));
    try {
      const Checkpoint read = read_checkpoint(folder / "bad");
      ASSERT_TRUE(same(read.state, some_state(2))) << "byte " << at;
      ++unnoticed;
    } catch (const InputError&) {
    }
  }
  EXPECT_LT(unnoticed, 300) << "unused space is a small part";
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(CheckpointFile, AFullDiskIsReportedAndNothingRemains) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", some_header(), some_state(1));
  const std::string before = read_text(folder / "c.h5");
  ::testing::internal::CaptureStderr();
  for (const rlim_t bytes : {0, 100, 600, 20000}) {
    const SmallFiles limit(bytes);
    try {
      write_checkpoint(folder / "c.h5", some_header(), some_state(2));
      FAIL() << "no error";
    } catch (const IoError& error) {
      EXPECT_EQ(std::string(error.what()),
                (folder / "c.h5").string() + ": cannot be written: " + too_large);
    }
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(read_text(folder / "c.h5"), before);
  EXPECT_FALSE(fs::exists(folder / "c.h5.part"));
  EXPECT_THROW(write_checkpoint(folder / "none" / "c.h5", some_header(), some_state(1)), IoError);
}

}  // namespace
}  // namespace suture
