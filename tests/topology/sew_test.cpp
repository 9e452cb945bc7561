// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/topology/changes.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;
using Seams = std::vector<Seam>;

/// The seams that undo a cut of these faces.
Seams seams_of(const CellComplex& map, const std::vector<Dart>& faces) {
  Seams seams;
  for (const Dart d : faces) seams.push_back({d, map.beta3(d)});
  return seams;
}

void expect_same_map(const CellComplex& a, const CellComplex& b) {
  EXPECT_TRUE(std::ranges::equal(a.vertices(), b.vertices()));
  EXPECT_TRUE(std::ranges::equal(a.edges(), b.edges()));
  EXPECT_TRUE(std::ranges::equal(a.faces(), b.faces()));
  for (int dimension = 0; dimension < 3; ++dimension)
    for (Index id = 0; id < b.count(dimension); ++id)
      EXPECT_EQ(a.dart_of(dimension, id), b.dart_of(dimension, id));
  for (Dart d = 0; d < 24 * a.element_count(); ++d) ASSERT_EQ(a.beta3(d), b.beta3(d));
}

TEST(Sew, TwoCubesBackTogether) {
  CellComplex map = complex_of(two_cubes());
  const CellComplex whole = map;
  const Seams seams = seams_of(map, {8});
  map.cut(std::array<Dart, 1>{8});
  const CellComplex before = map;
  const TopologyChange change = map.sew(seams);
  map.validate();
  EXPECT_EQ(change.faces_sewn, 1u);
  EXPECT_EQ(change.merges[0].size(), 4u);
  EXPECT_EQ(change.merges[1].size(), 4u);
  EXPECT_EQ(change.merges[2].size(), 1u);
  EXPECT_EQ(change.elements, (std::vector<Index>{0, 1}));
  EXPECT_EQ(map.existing(0), 12u);
  expect_change_tells_all(before, map, change);
  expect_same_map(map, whole);
}

TEST(Sew, UndoesAnyCut) {
  const unsigned seed = 20260103;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 20; ++round) {
    CellComplex map = complex_of(blob(5, 0.7, random));
    const CellComplex whole = map;
    std::vector<Dart> faces = interior_faces(map);
    std::shuffle(faces.begin(), faces.end(), random);
    faces.resize(faces.size() / (1 + round % 4));
    Seams seams = seams_of(map, faces);
    map.cut(faces);
    for (Seam& seam : seams) {  // any dart of the face, either side first
      for (auto turns = random() % 4; turns > 0; --turns)
        seam = {CellComplex::beta1(seam.one), CellComplex::beta0(seam.other)};
      if (random() % 2) std::swap(seam.one, seam.other);
    }
    for (const std::size_t part : {seams.size() / 2, seams.size() - seams.size() / 2}) {
      const CellComplex before = map;
      const TopologyChange change = map.sew(std::span(seams).first(part));
      map.validate();
      expect_change_tells_all(before, map, change);
      seams.erase(seams.begin(), seams.begin() + std::ptrdiff_t(part));
    }
    expect_same_map(map, whole);
  }
}

TEST(Sew, TheLastGapOfARingMergesNoVertices) {
  // Around the axis of a wheel cut at one spoke the elements are a path; sewn, a cycle.
  CellComplex map = complex_of(wheel(100));
  const std::vector<Dart> spoke{interior_faces(map)[0]};
  const Seams seams = seams_of(map, spoke);
  map.cut(spoke);
  const CellComplex before = map;
  const TopologyChange change = map.sew(seams);
  map.validate();
  EXPECT_EQ(change.merges[0].size(), 2u);  // at the rim; the axis was whole
  EXPECT_EQ(change.merges[1].size(), 3u);
  expect_change_tells_all(before, map, change);
}

TEST(Sew, TheEndsOfARowIntoARing) {
  CellComplex map = complex_of(grid(3, 1, 1));
  const CellComplex before = map;
  const TopologyChange change = map.sew(Seams{{0, 48 + 8}});
  EXPECT_EQ(change.merges[0].size(), 4u);
  map.validate();
  expect_change_tells_all(before, map, change);
}

void expect_refused(const CellComplex& map, const Seams& seams, const std::string& why) {
  CellComplex touched = map;
  try {
    touched.sew(seams);
    ADD_FAILURE() << "sewn";
  } catch (const TopologyError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
  expect_same_map(touched, map);
  touched.validate();
  if (seams.size() > 1) return;
  EXPECT_FALSE(map.can_sew(seams[0].one, seams[0].other));
  const std::string reason = map.why_not_sew(seams[0].one, seams[0].other);
  EXPECT_NE(reason.find(why), std::string::npos) << reason;
}

TEST(Sew, RefusesWhatDoesNotMatchAndThenDoesNothing) {
  CellComplex map = complex_of(grid(2, 2, 1));
  expect_refused(map, {{0, 16}}, "belong to the same element");
  expect_refused(map, {{0, 24 * 4}}, "does not exist");
  expect_refused(map, {{8, 24 * 3 + 8}}, "is already joined to element 1");
  EXPECT_TRUE(map.can_sew(0, 24 * 3 + 8));
  expect_refused(map, {{0, 24 * 3 + 8}, {1, 24 + 8}}, "two seams");
  // x0 of element 0 to y0 of its neighbour: two corners of an element would meet.
  expect_refused(map, {{0, 24 + 4}}, "a vertex twice");
  map.pierce(std::array<Index, 1>{3});
  expect_refused(map, {{0, 24 * 3 + 8}}, "was removed");
  EXPECT_TRUE(map.sew({}).empty());
}

TEST(Sew, SeamsThatAreImpossibleTogetherOnly) {
  // Two faces of one element to two of the other: rings that turn or fold.
  CellComplex map = complex_of(grid(3, 1, 1));
  Seams allowed, both;
  for (Dart d = 0; d < 24; ++d)
    for (Dart other = 48; other < 72; ++other)
      if (map.can_sew(d, other)) allowed.push_back({d, other});
  ASSERT_FALSE(allowed.empty());
  int refused = 0;
  for (const Seam& a : allowed)
    for (const Seam& b : allowed) {
      if (a.one / 4 == b.one / 4 || a.other / 4 == b.other / 4) continue;
      CellComplex touched = map;
      try {
        touched.sew(Seams{a, b});
      } catch (const TopologyError&) {
        ++refused;
        expect_same_map(touched, map);
      }
      touched.validate();
    }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace suture
