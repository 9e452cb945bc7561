// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/journal.hpp"

#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using Kind = Operation::Kind;

TEST(Journal, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  Journal journal;
  journal.mesh = meshes::wheel(7);  // coordinates of many digits
  journal.remark = "a wheel";
  journal.operations = {{Kind::cut, {8, 33}},
                        {Kind::tear, {}},
                        {Kind::pierce, {6, 0, 6}},
                        {Kind::sew, {8, 33, 9, 34}},
                        {Kind::clone, {1, 1, 3}, {200, 8}, {33}, {{2, 8}}},
                        {Kind::pierce, {9}}};
  write_journal(folder / "a.journal", journal);
  Journal read = read_journal(folder / "a.journal");
  EXPECT_EQ(read.mesh.points, journal.mesh.points);
  EXPECT_EQ(read.mesh.hexahedra, journal.mesh.hexahedra);
  EXPECT_EQ(read.operations, journal.operations);
  read.remark = journal.remark;
  write_journal(folder / "b.journal", read);
  EXPECT_EQ(read_text(folder / "b.journal"), read_text(folder / "a.journal"));
}

TEST(Journal, DamagedOnesAreRefusedWithTheLine) {
  const TemporaryFolder folder;
  const std::string head =
      "suture-journal 1\npoints 8\n0 0 0 1 0 0 0 1 0 1 1 0\n0 0 1 1 0 1 0 1 1 1 1 1\n"
      "hexahedra 1\n0 1 2 3 4 5 6 7\n";
  const std::pair<std::string, const char*> damaged[] = {
      {"suture-journal 2\n", ":1: version 2"},
      {"vertices 8\n", "suture-journal"},
      {"suture-journal 1\npoints 900000000\n0 0 0\n", ":2:"},
      {"suture-journal 1\npoints 1\n0 nan 0\n", ":3:"},
      {head + "operations 1\nctu 1  8\n", ":8: operation 'ctu' (did you mean 'cut'?)"},
      {head + "operations 1\ncut 1  24\n", ":8: dart 24; there are 24"},
      {head + "operations 1\npierce 1  1\n", ":8: element 1; there are 1"},
      {head + "operations 1\nsew 1  3\n", ":9: the file ends where dart"},
      {head + "operations 1\nclone 1  0  sew 1  24 48", ":8: dart 48; there are 48"},
      {head + "operations 1\nclone 1  0  sew 0  absorb 0", ":8: "},
      {head + "operations 1\nclone 900  0\n", ":8: 900 items are declared"},
      {head + "operations 1\ncut 0\ncut 0\n", ":9: more data than declared"},
      {head + "operations 3\ncut 1  8\n", ":7: 3 operations are declared"},
  };
  for (const auto& [text, words] : damaged) {
    const auto file = folder.write("damaged.journal", text);
    try {
      read_journal(file);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(read_journal(folder.write("good.journal", head + "operations 1 # of nothing\ncut 0\n"))
                .operations.size(),
            1u);
}

TEST(Journal, RequestsAreWhatTheMapAdmits) {
  CellComplex map = meshes::complex_of(meshes::grid(2, 2, 1));
  Request wanted = request(map, {Kind::cut, {8, 9, 24, 0}});  // one face thrice, a boundary face
  EXPECT_EQ(wanted.faces, std::vector<Dart>{8});
  EXPECT_EQ(wanted.left_out, 1u);
  ASSERT_EQ(map.origin(27), map.vertices_of(1)[0]);
  wanted = request(map, {Kind::tear, {27}});  // the middle of a side: one face
  EXPECT_EQ(wanted.faces, std::vector<Dart>{8});
  ASSERT_EQ(map.origin(24 * 3 + 3), map.vertices_of(3)[0]);
  wanted = request(map, {Kind::tear, {24 * 3 + 3}});  // the axis: all four
  EXPECT_EQ(wanted.faces.size(), 4u);
  wanted = request(map, {Kind::pierce, {3, 2, 1, 0, 2}});
  EXPECT_EQ(wanted.elements, (std::vector<Index>{1, 2, 3}));
  EXPECT_EQ(apply(map, wanted).removed[3].size(), 3u);
  wanted = request(map, {Kind::pierce, {0, 1}});
  EXPECT_TRUE(wanted.elements.empty());
  EXPECT_EQ(wanted.left_out, 2u);
}

// A copy that was refused is missing for all later lines.
TEST(Journal, RequestsLeaveOutWhatTheMapDoesNotHave) {
  const CellComplex map = meshes::complex_of(meshes::grid(2, 1, 1));
  for (const Kind kind : {Kind::cut, Kind::tear, Kind::pierce})
    EXPECT_EQ(request(map, {kind, {100'000}}).left_out, 1u) << name_of(kind);
  EXPECT_EQ(request(map, {Kind::sew, {8, 100'000}}).left_out, 1u);
}

}  // namespace
}  // namespace suture
