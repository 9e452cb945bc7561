// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/topology/fuzz.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

/// Blobs of a hundred cubes or more; sparse ones are full of non-manifold cells.
Mesh large_blob(int n, double fill, std::mt19937& random) {
  for (;;)
    if (Mesh mesh = blob(n, fill, random); mesh.hexahedra.size() >= 100) return mesh;
}

struct Family {
  const char* name;
  Mesh (*make)(std::mt19937& random);
};

const Family families[] = {
    {"voxel blobs", [](std::mt19937& random) { return large_blob(5, 0.9, random); }},
    {"shuffled blobs",
     [](std::mt19937& random) { return shuffled(large_blob(6, 0.6, random), random); }},
    {"pinched blobs", [](std::mt19937& random) { return large_blob(7, 0.35, random); }},
    {"rings, genus 1",
     [](std::mt19937&) {
       return voxels(7, 7, 3, [](int x, int y, int) { return x < 2 || x > 4 || y < 2 || y > 4; });
     }},
    {"frames of high genus",
     [](std::mt19937& random) {
       return turned(voxels(7, 5, 5,
                            [](int x, int y, int z) {
                              return (x % 2 == 0) + (y % 2 == 0) + (z % 2 == 0) >= 2;
                            }),
                     random);
     }},
    {"foreign meshes: O-grids, elements in any order and turn",
     [](std::mt19937& random) { return turned(shuffled(o_grid(3, 2, 4, true), random), random); }},
    {"foreign meshes of genus 1: pipes",
     [](std::mt19937& random) { return turned(shuffled(o_grid(3, 3, 3, false), random), random); }},
};

/// Writes what is left of a failing sequence beside the test.
std::string keep(const Journal& failed, const fuzz::Offence& offence, const std::string& name) {
  Journal journal = fuzz::shrink(failed);
  journal.remark = name + ": " + offence.law.substr(0, offence.law.find('\n'));
  const std::string file = name + ".journal";
  write_journal(file, journal);
  return offence.law + "\n  after operation " + std::to_string(offence.operation + 1) +
         "; shrunk to " + std::to_string(journal.operations.size()) + " operations in " + file +
         ", 'suture replay' repeats it, and this test with SUTURE_JOURNAL=" + file;
}

unsigned seed() {
  const char* given = std::getenv("SUTURE_SEED");
  return given ? static_cast<unsigned>(std::atoi(given)) : 2026u;
}

// 10,000 sequences in full, 160 otherwise; 12 operations each on 100 to 220 elements.
TEST(Fuzz, RandomSequencesDoTheSameToBothMaps) {
  const unsigned sequences = std::getenv("SUTURE_FULL") ? 10000 : 160;
  std::cout << "seed " << seed() << ", " << sequences << " sequences\n";
  fuzz::Tally tally;
  for (unsigned i = 0; i < sequences; ++i) {
    const Family& family = families[i % std::size(families)];
    std::seed_seq mix{seed(), i};  // each sequence can be repeated alone
    std::mt19937 random(mix);
    Journal journal;
    const auto offence = fuzz::play_random(family.make(random), 12, random, journal, tally);
    ASSERT_GE(journal.mesh.hexahedra.size(), 100u) << family.name;
    if (!offence) continue;
    FAIL() << family.name << ": "
           << keep(journal, *offence, "fuzz-" + std::to_string(seed()) + "-" + std::to_string(i));
  }
  std::cout << tally.faces_cut << " faces cut, " << tally.elements_removed << " elements removed, "
            << tally.faces_sewn << " faces sewn, " << tally.vertices_split << " vertices split, "
            << tally.vertices_merged << " merged, " << tally.copies << " copies, " << tally.absorbed
            << " elements absorbed, " << tally.refused << " sutures refused\n";
  EXPECT_GT(tally.faces_cut, 100 * sequences);
  EXPECT_GT(tally.elements_removed, sequences);
  EXPECT_GT(tally.vertices_split, 100 * sequences);
  EXPECT_GT(tally.vertices_merged, 10 * sequences);
  EXPECT_GT(tally.copies, 10 * sequences);
  EXPECT_GT(tally.absorbed, sequences);
  EXPECT_GT(tally.refused, sequences / 10);
}

// The journal named by SUTURE_JOURNAL, or a small one that comes with the tests.
TEST(Fuzz, AJournalDoesTheSameToBothMaps) {
  const char* given = std::getenv("SUTURE_JOURNAL");
  const Journal journal = read_journal(given ? given : SUTURE_TOPOLOGY_DATA "/ring.journal");
  const auto offence = fuzz::play(journal);
  EXPECT_FALSE(offence) << "operation " << offence->operation + 1 << ": " << offence->law;
}

// What makes it fail is one number of one operation, and one of a later one.
TEST(Fuzz, ShrinkingLeavesWhatMatters) {
  std::mt19937 random(3);
  Journal journal;
  fuzz::Tally tally;
  ASSERT_FALSE(fuzz::play_random(grid(5, 5, 4), 12, random, journal, tally));
  journal.operations.insert(journal.operations.begin() + 3, {Operation::Kind::cut, {8, 32, 56}});
  journal.operations.insert(journal.operations.begin() + 9,
                            {Operation::Kind::sew, {0, 72, 8, 24, 9, 27}});
  const Journal small = fuzz::shrink(journal, [](const Journal& j) {
    bool cut = false;
    for (const Operation& operation : j.operations)
      for (std::size_t i = 0; i < operation.numbers.size(); ++i) {
        if (operation.kind == Operation::Kind::cut && operation.numbers[i] == 32) cut = true;
        if (operation.kind == Operation::Kind::sew && i % 2 == 0 && operation.numbers[i] == 8 &&
            operation.numbers[i + 1] == 24 && cut)
          return true;
      }
    return false;
  });
  ASSERT_EQ(small.operations.size(), 2u);
  EXPECT_EQ(small.operations[0].numbers, (std::vector<Index>{32}));
  EXPECT_EQ(small.operations[1].numbers, (std::vector<Index>{8, 24}));
}

}  // namespace
}  // namespace suture
