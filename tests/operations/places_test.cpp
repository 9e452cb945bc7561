// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cells selected by plane patches, paths and boxes.
#include <gtest/gtest.h>

#include <numeric>
#include <optional>
#include <random>

#include "kernel/geometry/element_blocks.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "kernel/operations/islands.hpp"
#include "kernel/operations/pierce_path.hpp"
#include "kernel/operations/plane_patch.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

struct Block {
  Mesh mesh;
  CellComplex complex;
  std::vector<double> rows;
  explicit Block(Mesh m) : mesh(std::move(m)), complex(complex_of(mesh)) {
    for (const Vec3& p : mesh.points) rows.insert(rows.end(), {p[0], p[1], p[2], 0});
  }
  Vec3 face_centre(Dart face) const {
    Vec3 sum{};
    for (Dart k = 0; k < 4; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] += mesh.points[complex.origin((face & ~3u) + k)][c] / 4;
    return sum;
  }
};

TEST(FacesAcrossPatch, ADiscOpensWhatItCovers) {
  const Block block(grid(9, 9, 2));
  PlanePatch disc{{4.5, 4.5, 1}, {0, 0, 2}, 2.5, {}};
  const auto faces = faces_across_patch(block.complex, block.rows.data(), disc);
  std::size_t expected = 0;
  for (int x = 0; x < 9; ++x)
    for (int y = 0; y < 9; ++y) expected += std::hypot(x - 4.0, y - 4.0) <= 2.5;
  EXPECT_EQ(faces.size(), expected);
  for (const Dart face : faces) {
    const Vec3 p = block.face_centre(face);
    EXPECT_LE(std::hypot(p[0] - 4.5, p[1] - 4.5), 2.5);
  }
  disc.radius = 0.4;
  disc.point = {4, 4, 1};  // between the segments
  EXPECT_TRUE(faces_across_patch(block.complex, block.rows.data(), disc).empty());
}

// Triangles from the sides of a square to a point in it, whose common sides pass through segments:
// each segment belongs to one, and to another only if it meets their common side.
TEST(FacesAcrossPatch, TrianglesAroundAPointMissNothingAndShareTheirSides) {
  const Block block(grid(9, 9, 2));
  const unsigned seed = 4;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> step(1, 26);
  const Vec3 corners[] = {{0, 0, 1}, {9, 0, 1}, {9, 9, 1}, {0, 9, 1}};
  for (int round = 0; round < 300; ++round) {
    const Vec3 middle{step(random) / 3.0, step(random) / 3.0, 1};
    std::vector<Dart> all;
    for (int i = 0; i < 4; ++i) {
      const Vec3 triangle[] = {corners[i], corners[(i + 1) % 4], middle};
      const PlanePatch patch{.point = {0, 0, 1}, .normal = {0, 0, 1}, .polygon = triangle};
      const auto part = faces_across_patch(block.complex, block.rows.data(), patch);
      all.insert(all.end(), part.begin(), part.end());
    }
    std::ranges::sort(all);
    const auto is_on_a_side = [&](Dart face) {
      const Vec3 p = block.face_centre(face);
      return std::ranges::any_of(corners, [&](const Vec3& c) {
        const double u = p[0] - c[0], v = p[1] - c[1], x = middle[0] - c[0], y = middle[1] - c[1];
        return std::abs(u * y - v * x) <= 0.0201 * std::hypot(x, y);
      });
    };
    std::size_t shared = 0;
    for (std::size_t i = 0; i + 1 < all.size(); ++i)
      if (all[i] == all[i + 1]) {
        ++shared;
        EXPECT_TRUE(is_on_a_side(all[i])) << middle[0] << ' ' << middle[1];
      }
    EXPECT_EQ(all.size(), 81 + shared) << middle[0] << ' ' << middle[1];
  }
}

// Two polygons that share a side open what their union opens, each face once.
TEST(FacesAcrossPatch, PolygonsSideBySideMissAndRepeatNothing) {
  const Block block(grid(8, 8, 2));
  const std::vector<Vec3> left{{0, 0, 1}, {3.5, 0, 1}, {5.5, 8, 1}, {0, 8, 1}};
  const std::vector<Vec3> right{{3.5, 0, 1}, {8, 0, 1}, {8, 8, 1}, {5.5, 8, 1}};
  std::vector<Dart> faces;
  for (const auto& polygon : {left, right}) {
    PlanePatch patch{{0, 0, 1}, {0, 0, 1}};
    patch.polygon = polygon;
    const auto part = faces_across_patch(block.complex, block.rows.data(), patch);
    EXPECT_GT(part.size(), 20u);
    faces.insert(faces.end(), part.begin(), part.end());
  }
  std::ranges::sort(faces);
  EXPECT_EQ(faces, faces_across_plane(block.complex, block.rows.data(), {0, 0, 1}, {0, 0, 1}));
}

// Round numbers end on segments, and no order of the corners or direction of the normal decides.
TEST(FacesAcrossPatch, APolygonReachesAllOfItsSides) {
  const Block block(grid(8, 8, 2));
  for (const double off : {0.0, 1e-15, -1e-15, 0.013, -0.013})
    for (const double up : {1.0, -3.0}) {
      const double low = 2.5 - off, high = 5.5 + off;
      const std::vector<Vec3> square{
          {low, low, 1}, {high, low, 1}, {high, high, 1}, {low, high, 1}};
      CutArea area;
      const PlanePatch patch{.point = square[0], .normal = {0, 0, up}, .polygon = square};
      EXPECT_EQ(
          faces_across_patch(block.complex, block.rows.data(), patch, 4, nullptr, &area).size(),
          16u)
          << off << ' ' << up;
      EXPECT_DOUBLE_EQ(area.opened, 16);
      EXPECT_NEAR(area.blade, 9, 0.6);
    }
}

// An L: its corner piece is not cut. The projection is the same from every side.
TEST(FacesAcrossPatch, APolygonMayBeReentrant) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<int, 3> cells{4, 4, 4};
    cells[axis] = 2;
    const Block block(grid(cells[0], cells[1], cells[2]));
    const auto at = [&](double u, double v) {
      Vec3 p{};
      p[axis] = 1;
      p[(axis + 1) % 3] = u;
      p[(axis + 2) % 3] = v;
      return p;
    };
    const std::vector<Vec3> corner{at(0, 0), at(4, 0), at(4, 2), at(2, 2), at(2, 4), at(0, 4)};
    PlanePatch patch{at(0, 0), {}};
    patch.normal[axis] = -1;
    patch.polygon = corner;
    EXPECT_EQ(faces_across_patch(block.complex, block.rows.data(), patch).size(), 12u) << axis;
  }
}

TEST(ElementsAlongPath, AreThoseNearThePolyline) {
  const unsigned seed = 31;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(-1, 7);
  const Block block(grid(6, 6, 6));
  for (int round = 0; round < 20; ++round) {
    std::vector<Vec3> path;
    for (int i = 0; i < 1 + round % 4; ++i)
      path.push_back({anywhere(random), anywhere(random), anywhere(random)});
    const double radius = 0.3 + 0.1 * round;
    std::vector<Index> expected;
    for (Index e = 0; e < 216; ++e) {
      const Vec3 c{e % 6 + 0.5, e / 6 % 6 + 0.5, e / 36 + 0.5};
      double nearest = 1e300;  // by many points along each segment
      for (std::size_t i = 0; i < path.size(); ++i)
        for (int s = 0; s <= 2000; ++s) {
          const Vec3 &a = path[i], &b = path[std::min(i + 1, path.size() - 1)];
          const double t = s / 2000.0;
          nearest = std::min(
              nearest, std::hypot(a[0] + t * (b[0] - a[0]) - c[0], a[1] + t * (b[1] - a[1]) - c[1],
                                  a[2] + t * (b[2] - a[2]) - c[2]));
        }
      if (nearest <= radius) expected.push_back(e);
    }
    EXPECT_EQ(elements_along_path(block.complex, block.rows.data(), path, radius), expected);
  }
}

TEST(ElementBlocks, AreEmptyWhereAllElementsWereRemoved) {
  Block block(grid(16, 16, 3));
  constexpr std::size_t level = ElementBlocks::levels - 1;
  constexpr Index size = ElementBlocks::sizes[level];
  std::vector<Index> second(size);
  std::iota(second.begin(), second.end(), size);
  block.complex.pierce(second);
  const ElementBlocks blocks(block.complex, {block.rows.data()});
  ASSERT_EQ(blocks.count(level), 16u * 16 * 3 / size);
  for (const Index b : {0u, 2u})
    EXPECT_LT(blocks.box(level, b).low[0], blocks.box(level, b).high[0]) << b;
  EXPECT_GT(blocks.box(level, 1).low[0], blocks.box(level, 1).high[0]);
}

/// A block that is bent more and more, cut, pierced and sewn, with blocks that follow.
class BentBlock : public testing::Test {
 protected:
  explicit BentBlock(unsigned seed = 11) : random_(seed) {
    blocks_.emplace(block_.complex, Places{block_.rows.data()});
  }

  double number(double low, double high) {
    return std::uniform_real_distribution(low, high)(random_);
  }
  Vec3 place() { return {number(-2, 18), number(-2, 18), number(-2, 26)}; }

  void bend() {
    const double angle = number(0, 6), size = number(0, 1);
    for (Index v = 0; v < block_.complex.count(0); ++v) {
      double* x = block_.rows.data() + 4 * std::size_t{v};
      x[0] += size * std::sin(angle + 0.2 * x[2]) + number(-0.01, 0.01);
      x[1] += size * std::cos(angle + 0.3 * x[0]);
    }
    blocks_->read(0, block_.complex.count(0), {block_.rows.data()});
  }
  void follow(const TopologyChange& change) {
    for (const Split& split : change.splits[0])
      for (std::size_t c = 0; c < 4; ++c)
        block_.rows.push_back(block_.rows[4 * std::size_t{split.old_cell} + c]);
    for (const Merge& merge : change.merges[0]) block_.rows[4 * std::size_t{merge.kept}] += 0.1;
    blocks_->follow(block_.complex, change, {block_.rows.data()});
  }
  bool holds(const Box& box, Index element) const {
    return std::ranges::all_of(block_.complex.vertices_of(element), [&](Index v) {
      const double* x = block_.rows.data() + 4 * std::size_t{v};
      return contains(box, {x[0], x[1], x[2]});
    });
  }
  /// The first element whose corners, or those of its neighbours, are not in the box of its block.
  Index first_outside(std::size_t level) const {
    const CellComplex& complex = block_.complex;
    for (Index e = 0; e < complex.element_count(); ++e) {
      if (!complex.exists(3, e)) continue;
      const Box box = blocks_->box(level, e / ElementBlocks::sizes[level]);
      if (!holds(box, e)) return e;
      for (int f = 0; f < hexahedron::faces; ++f)
        if (const Index n = complex.neighbour(e, f); n != none && !holds(box, n)) return e;
    }
    return none;
  }
  /// Cuts the faces, and sews half of them again.
  void cut(const std::vector<Dart>& faces) {
    std::vector<Seam> seams;
    for (const Dart d : faces)
      if (seams.size() < faces.size() / 2) seams.push_back({d, block_.complex.beta3(d)});
    follow(block_.complex.cut(faces));
    if (!seams.empty()) follow(block_.complex.sew(seams));
  }

  Block block_{grid(16, 16, 24)};
  std::optional<ElementBlocks> blocks_;
  std::mt19937 random_;
};

class BentBlocks : public BentBlock, public testing::WithParamInterface<unsigned> {
 protected:
  BentBlocks() : BentBlock(GetParam()) {}
};
INSTANTIATE_TEST_SUITE_P(Seeds, BentBlocks, testing::Values(4u, 6u, 11u));

TEST_P(BentBlocks, AreSearchedInBlocksWithTheSameResult) {
  SCOPED_TRACE(GetParam());
  std::size_t faces = 0, elements = 0;
  for (int round = 0; round < 40; ++round) {
    if (round % 3 == 0) bend();
    PlanePatch patch{place(), place()};
    if (round % 4 != 0) patch.radius = number(0, 8);
    const std::vector<Vec3> triangle{place(), place(), place()};
    if (round % 5 == 0) patch.polygon = triangle;
    const double* rows = block_.rows.data();
    const auto across = faces_across_patch(block_.complex, rows, patch);
    EXPECT_EQ(faces_across_patch(block_.complex, rows, patch, 4, &*blocks_), across);

    Diagnostics diagnostics;
    const SurfaceBlade blade({"triangle", triangle, {{0, 1, 2}}}, diagnostics);
    EXPECT_EQ(blade.faces_cut(block_.complex, {rows}, nullptr, &*blocks_),
              blade.faces_cut(block_.complex, {rows}));

    const std::vector<Vec3> path{place(), place()};
    const auto along = elements_along_path(block_.complex, rows, path, 1);
    EXPECT_EQ(elements_along_path(block_.complex, rows, path, 1, 4, &*blocks_), along);
    faces += across.size();
    elements += along.size();
    cut(across);
    if (!along.empty()) follow(block_.complex.pierce(along));
    for (std::size_t level = 0; level < ElementBlocks::levels && round % 4 == 3; ++level)
      ASSERT_EQ(first_outside(level), none) << "level " << level << ", round " << round;
  }
  EXPECT_GT(faces, 500u);
  EXPECT_GT(elements, 100u);
}

TEST(ElementsOfIslands, AreSmallOnesAndThoseThatLeft) {
  // Bars of 5, 2 and 1 elements at x = 0, 10, 20.
  Block block(voxels(21, 5, 1, [](int x, int y, int) {
    return (x == 0) || (x == 10 && y < 2) || (x == 20 && y == 0);
  }));
  const auto removed = [&](const RemoveIslands& which) {
    std::vector<double> xs;
    for (const Index e :
         elements_of_islands(block.complex, Islands(block.complex), block.rows.data(), which))
      xs.push_back(block.mesh.points[block.complex.vertices_of(e)[0]][0]);
    std::ranges::sort(xs);
    return xs;
  };
  RemoveIslands which;
  which.below = 2;
  EXPECT_EQ(removed(which), (std::vector<double>{20}));
  which.below = 3;
  EXPECT_EQ(removed(which), (std::vector<double>{10, 10, 20}));
  which.below = 0;
  which.outside = Selection::InBox{{-1, 4.5, -1}, {10, 9, 9}};  // the tip of the long bar
  EXPECT_EQ(removed(which), (std::vector<double>{10, 10, 20}));
  which.outside = Selection::InBox{{9.5, -1, -1}, {10.5, 0, 9}};  // a corner of the second
  which.below = 3;
  EXPECT_EQ(removed(which).size(), 8u) << "either reason suffices";
  which.below = 0;
  EXPECT_EQ(removed(which), (std::vector<double>{0, 0, 0, 0, 0, 20}));
  which.outside->max = {9, 9, 9};
  which.outside->min = {-1, -1, -1};
  block.complex.pierce(std::array<Index, 1>{0});
  EXPECT_EQ(removed(which), (std::vector<double>{10, 10, 20})) << "holes are skipped";
}

}  // namespace
}  // namespace suture
