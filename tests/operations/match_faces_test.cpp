// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/match_faces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

std::vector<double> rows_of(const std::vector<Vec3>& points) {
  std::vector<double> rows;
  for (const Vec3& p : points) rows.insert(rows.end(), {p[0], p[1], p[2], 0});
  return rows;
}

/// Every vertex at the place it had before cuts: the k-th of its kind.
struct Cuttable {
  Mesh mesh;
  CellComplex complex;
  std::vector<Index> point;

  explicit Cuttable(Mesh m) : mesh(std::move(m)), complex(complex_of(mesh)) {
    point.resize(complex.count(0));
    for (Index e = 0; e < complex.element_count(); ++e)
      for (std::size_t i = 0; i < 8; ++i) point[complex.vertices_of(e)[i]] = mesh.hexahedra[e][i];
  }
  void cut(const std::vector<Dart>& faces) {
    const TopologyChange change = complex.cut(faces);
    for (const Split& split : change.splits[0]) point.push_back(point[split.old_cell]);
  }
  std::vector<double> rows() const {
    std::vector<Vec3> places;
    for (const Index p : point) places.push_back(mesh.points[p]);
    return rows_of(places);
  }
  std::vector<Dart> inner_faces() const {
    std::vector<Dart> faces;
    for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
      if (complex.beta3(d) != none && d < complex.beta3(d)) faces.push_back(d);
    return faces;
  }
};

TEST(SeamsOfCuts, BringBackTheMapBitForBit) {
  const unsigned seed = 7;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 20; ++round) {
    Cuttable body(blob(4, 0.8, random));
    const CellComplex before = body.complex;
    std::vector<Dart> faces = body.inner_faces();
    std::shuffle(faces.begin(), faces.end(), random);
    faces.resize(faces.size() / 2);
    body.cut(faces);
    const std::vector<Seam> seams = seams_of_cuts(body.complex, body.point, {}).seams;
    ASSERT_EQ(seams.size(), faces.size());
    body.complex.sew(seams);
    body.complex.validate();
    for (Dart d = 0; d < 24 * before.element_count(); ++d)
      ASSERT_EQ(body.complex.beta3(d), before.beta3(d));
    EXPECT_TRUE(seams_of_cuts(body.complex, body.point, {}).seams.empty());
  }
}

TEST(SeamsOfCuts, StayWithinTheElements) {
  Cuttable body(grid(4, 1, 1));
  body.cut(body.inner_faces());
  const std::vector<Index> elements{1, 2, 3};
  const auto seams = seams_of_cuts(body.complex, body.point, elements).seams;
  ASSERT_EQ(seams.size(), 2u);
  EXPECT_EQ(seams[0].one / 24, 1u);
  EXPECT_EQ(seams[1].one / 24, 2u);
}

// Two blocks of 2 x 3 faces each, some way apart.
struct TwoBlocks {
  Mesh mesh = grid(2, 2, 3);
  CellComplex complex;
  std::vector<Index> left, right;
  std::vector<double> rows;

  explicit TwoBlocks(Vec3 shift, bool turn_numbers = false) {
    const Mesh other = grid(2, 2, 3);
    const auto first = static_cast<Index>(mesh.points.size());
    for (Index e = 0; e < 12; ++e) {
      Hexahedron h;
      // A quarter turn of the corners about x: the same cube with other local axes.
      constexpr std::array<std::size_t, 8> turned{2, 3, 6, 7, 0, 1, 4, 5};
      for (std::size_t i = 0; i < 8; ++i)
        h[i] = first + other.hexahedra[e][turn_numbers ? turned[i] : i];
      mesh.hexahedra.push_back(h);
      left.push_back(e);
      right.push_back(12 + e);
    }
    for (Vec3 p : other.points) {
      for (std::size_t c = 0; c < 3; ++c) p[c] += shift[c] + (c == 0 ? 2 : 0);
      mesh.points.push_back(p);
    }
    complex = complex_of(mesh);
    rows = rows_of(mesh.points);
  }
  MatchedSeams matched(double gap) const {
    return seams_within_gap(complex, rows.data(), left, right, gap);
  }
  std::vector<Seam> match(double gap) const { return matched(gap).seams; }
};

TEST(SeamsWithinGap, PairCornersWhateverTheLocalAxes) {
  for (const bool turned : {false, true}) {
    TwoBlocks blocks({0.1, 0.05, 0}, turned);
    const auto seams = blocks.match(0.12);
    ASSERT_EQ(seams.size(), 6u);
    for (const Seam& seam : seams) {
      for (int k = 0; k < 4; ++k) {
        const Vec3& p =
            blocks.mesh.points[blocks.complex.origin((seam.one & ~3u) | ((seam.one + k) & 3))];
        const Vec3& q = blocks.mesh.points[blocks.complex.origin(
            CellComplex::beta1((seam.other & ~3u) | ((seam.other - k) & 3)))];
        EXPECT_NEAR(q[0] - p[0], 0.1, 1e-12);
        EXPECT_NEAR(q[1] - p[1], 0.05, 1e-12);
        EXPECT_NEAR(q[2] - p[2], 0, 1e-12);
      }
    }
    EXPECT_EQ(blocks.complex.sew(seams).faces_sewn, 6u);
    blocks.complex.validate();
    Index islands = 0;
    blocks.complex.islands(&islands);
    EXPECT_EQ(islands, 1u);
  }
}

TEST(SeamsWithinGap, NothingIsNearEnough) {
  EXPECT_TRUE(TwoBlocks({0.1, 0, 0}).match(0.09).empty());
  EXPECT_TRUE(TwoBlocks({-9, 0, 0}).match(0.5).empty()) << "backs to each other are not sewn";
}

// Places in such gaps are numbers that no integer holds.
TEST(SeamsWithinGap, AnyPositiveGapWillDo) {
  for (const double gap : {1e-19, 1e-300, 1e300}) {
    EXPECT_EQ(TwoBlocks({0, 0, 0}).match(gap).size(), 6u) << gap;
    EXPECT_EQ(TwoBlocks({0.1, 0, 0}).match(gap).size(), gap > 1 ? 6u : 0u) << gap;
  }
}

TEST(SeamsWithinGap, FacesOfOtherGridsAreNamed) {
  TwoBlocks blocks({0, 0.5, 0});  // shifted by half a face: centres 0.5 apart, corners too
  EXPECT_TRUE(blocks.matched(0.8).misfits.empty());
  EXPECT_TRUE(blocks.matched(0.3).misfits.empty());
  // One side twice as fine along y: centres are near, corners are not.
  for (std::size_t v = 0; v < blocks.mesh.points.size(); ++v)
    if (v >= blocks.mesh.points.size() / 2)
      blocks.rows[4 * v + 1] = (blocks.rows[4 * v + 1]) / 4 + 0.3;
  const MatchedSeams found = blocks.matched(0.25);
  EXPECT_TRUE(found.seams.empty());
  const std::string text = misfits_text(found.misfits, {});
  EXPECT_NE(text.find("stay open:\n"), std::string::npos) << text;
  EXPECT_NE(text.find("side x1 of element 1 and side x0 of element 12: corners are 0."),
            std::string::npos)
      << text;
}

// A cut that ends within the body, whose outer sides meet its lips at right angles
// within the gap: what was cut is found again, and nothing else.
//
//    +---+---+---+          lips of the cut    ====
//    |   | z0'   |          outer sides are within the gap of them, and no pair
//    +===+===+---+
//    |   |   |   |
//    +---+---+---+
TEST(SeamsWithinGap, TheEndOfACutIsSewnWhole) {
  Cuttable body(grid(4, 4, 3));
  const CellComplex before = body.complex;
  std::vector<Index> below, above;
  for (Index e = 0; e < body.complex.element_count(); ++e)
    (e / 4 % 4 < 2 ? below : above).push_back(e);
  std::vector<Dart> faces;
  for (const Dart face : body.inner_faces()) {
    const Index e = face / 24, other = body.complex.beta3(face) / 24;
    if ((e / 4 % 4 == 1) && other == e + 4 && e % 4 < 3) faces.push_back(face);
  }
  ASSERT_EQ(faces.size(), 9u);
  body.cut(faces);
  const std::vector<double> rows = body.rows();
  for (const double gap : {0.5, 1.5, 2.0, 3.5}) {
    const MatchedSeams found = seams_within_gap(body.complex, rows.data(), below, above, gap);
    EXPECT_EQ(found.seams.size(), 9u) << gap;
    EXPECT_TRUE(found.misfits.empty()) << gap << ": " << misfits_text(found.misfits, {});
    for (const Seam& seam : found.seams)
      EXPECT_EQ(before.beta3(seam.one) & ~3u, seam.other & ~3u) << gap;
    CellComplex sewn = body.complex;
    EXPECT_EQ(sewn.sew(found.seams).faces_sewn, 9u);
  }
}

// Lips that open like a book are sewn up to 60 degrees; sides at more than that belong
// to an edge of the body.
TEST(SeamsWithinGap, SidesAtAnAngleDoNotFace) {
  for (const double angle : {0.0, 0.7, 1.3, 1.6}) {
    TwoBlocks blocks({0.2, 0, 0});
    for (std::size_t v = blocks.mesh.points.size() / 2; v < blocks.mesh.points.size(); ++v) {
      const double x = blocks.rows[4 * v] - 2.2, y = blocks.rows[4 * v + 1];
      blocks.rows[4 * v] = 2.2 + std::cos(angle) * x + std::sin(angle) * y;
      blocks.rows[4 * v + 1] = std::cos(angle) * y - std::sin(angle) * x;
    }
    const auto lips = std::ranges::count_if(blocks.match(3), [](const Seam& seam) {
      return seam.one % 24 / 4 == 2 && seam.other % 24 / 4 == 0;  // x1 of the left, x0 of the right
    });
    EXPECT_EQ(lips, angle < 1 ? 6 : 0) << angle;
  }
}

TEST(SeamBatch, TakesWhatSewTakesAndReportsTheRest) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Cuttable body(blob(4, 0.7, random));
    std::vector<Dart> faces = body.inner_faces();
    std::shuffle(faces.begin(), faces.end(), random);
    faces.resize(faces.size() / 3);
    body.cut(faces);
    std::vector<Dart> open;
    for (Dart d = 0; d < 24 * body.complex.element_count(); ++d)
      if (body.complex.beta3(d) == none) open.push_back(d);
    SeamBatch batch(body.complex);
    int refused = 0;
    for (int i = 0; i < 60; ++i) {
      const Seam seam{open[random() % open.size()], open[random() % open.size()]};
      if (seam.one / 24 == seam.other / 24) continue;
      std::vector<Seam> with = batch.seams();
      with.push_back(seam);
      bool accepted = true;
      try {
        CellComplex copy = body.complex;
        copy.sew(with);
      } catch (const TopologyError&) {
        accepted = false;
      }
      const auto reason = batch.add(seam);
      ASSERT_EQ(!reason, accepted) << reason.value_or("");
      refused += !accepted;
    }
    EXPECT_GT(refused, 0);
    EXPECT_GT(batch.seams().size(), 1u);
  }
}

TEST(SeamsBetween, FindWhatWasCutElseTheNearest) {
  Cuttable body(grid(3, 1, 1));
  body.cut({8});  // between 0 and 1
  const auto element_of = [](std::uint64_t id) { return id < 3 ? static_cast<Index>(id) : none; };
  const std::vector<double> rows = body.rows();
  const std::vector<ElementPair> pairs{{1, 0}, {1, 2}};
  const ListedSeams found =
      seams_between(body.complex, rows.data(), "/p", pairs, element_of, body.point);
  ASSERT_EQ(found.seams.size(), 1u);
  EXPECT_EQ(found.seams[0].one & ~3u, 24u + 0) << "x0 of element 1";
  EXPECT_EQ(found.seams[0].other & ~3u, 8u) << "x1 of element 0";
  EXPECT_EQ(found.idle, (std::vector<ElementPair>{{1, 2}})) << "they share a face";

  // All sides of both ends turn their backs to each other: sewing any two of them
  // would turn the row inside out.
  const Cuttable row(grid(3, 1, 1));
  const std::vector<double> places = row.rows();
  const std::vector<ElementPair> ends{{0, 2}};
  EXPECT_THROW(seams_between(row.complex, places.data(), "/p", ends, element_of, row.point),
               InputError);
  const std::vector<ElementPair> unknown{{0, 9}};
  try {
    seams_between(body.complex, rows.data(), "/p", unknown, element_of, body.point);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/p/0: the mesh has no element 9");
  }
}

// A hole between two elements is not closed by sewing its walls: those above and
// below would have two nodes in one place. Reported with the numbers of the mesh.
TEST(SeamsBetween, WhatWouldFoldAnElementIsReported) {
  Cuttable body(grid(3, 3, 1));
  body.complex.pierce(std::vector<Index>{4});
  const std::vector<double> rows = body.rows();
  const auto element_of = [](std::uint64_t id) { return static_cast<Index>(id - 100); };
  const Naming names{[](Index e) { return std::to_string(e + 100); },
                     [](Index v) { return "n" + std::to_string(v); }};
  const std::vector<ElementPair> pairs{{103, 105}};
  try {
    seams_between(body.complex, rows.data(), "/p", pairs, element_of, body.point, names);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "/p/0: elements 103 and 105 cannot be sewn: nodes n3 and n9 of element 101 would "
                 "be merged; nothing was sewn");
  }
}

}  // namespace
}  // namespace suture
