// SPDX-License-Identifier: GPL-3.0-or-later
//
// The boundary surface after random operations, compared with one that is built from scratch.
#include "kernel/contact/boundary_surface.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "kernel/mesh/box.hpp"
#include "kernel/topology/seam.hpp"
#include "tests/base/same_state.hpp"
#include "tests/topology/operations.hpp"

namespace suture {
namespace {

CellComplex block(Index nx, Index ny, Index nz) {
  BoxOptions box;
  box.cells = {nx, ny, nz};
  box.size = {1, 1, 1};
  Mesh mesh = make_box(box);
  return {std::move(mesh.hexahedra), static_cast<Index>(mesh.points.size())};
}

/// Each face with its corners; the vertices; independent of the history.
struct Contents {
  std::map<Index, BoundarySurface::Corners> faces;
  std::set<Index> vertices;
  explicit Contents(const BoundarySurface& surface)
      : vertices(surface.vertices().begin(), surface.vertices().end()) {
    for (std::size_t i = 0; i < surface.faces().size(); ++i)
      faces[surface.faces()[i]] = surface.corners()[i];
  }
  bool operator==(const Contents&) const = default;
};

Contents rebuilt(const CellComplex& complex) { return Contents(BoundarySurface(complex)); }

/// By a look at every face and vertex.
void expect_whole_boundary(const CellComplex& complex, const BoundarySurface& surface) {
  const Contents contents(surface);
  ASSERT_EQ(contents.faces.size(), surface.faces().size()) << "a face is listed twice";
  ASSERT_EQ(contents.vertices.size(), surface.vertices().size()) << "a vertex is listed twice";
  std::set<Index> vertices;
  std::size_t faces = 0;
  for (Index face = 0; face < 6 * complex.element_count(); ++face) {
    if (!complex.exists(3, face / 6) || complex.neighbour(face / 6, face % 6) != none) continue;
    ++faces;
    ASSERT_TRUE(contents.faces.contains(face));
    for (Dart d = 4 * face; d < 4 * face + 4; ++d) vertices.insert(complex.origin(d));
  }
  EXPECT_EQ(contents.faces.size(), faces);
  EXPECT_EQ(contents.vertices, vertices);
}

void expect_edges_in_pairs(const CellComplex& complex, const BoundarySurface& surface) {
  const std::set<Index> faces(surface.faces().begin(), surface.faces().end());
  for (const Index face : faces)
    for (Dart d = 4 * face; d < 4 * face + 4; ++d) {
      const Dart other = across_edge(complex, d);
      ASSERT_TRUE(faces.contains(other / 4));
      ASSERT_NE(other, d);
      EXPECT_EQ(across_edge(complex, other), d);
      EXPECT_EQ(complex.origin(other), complex.origin(CellComplex::beta1(d)))
          << "the two faces run along their edge in opposite directions";
    }
}

TEST(BoundarySurface, OfABlockIsItsSixSides) {
  const CellComplex complex = block(4, 3, 2);
  const BoundarySurface surface(complex);
  EXPECT_EQ(surface.faces().size(), 2u * (12 + 8 + 6));
  EXPECT_EQ(surface.vertices().size(), 5u * 4 * 3 - 3u * 2 * 1);
  expect_whole_boundary(complex, surface);
  expect_edges_in_pairs(complex, surface);
}

TEST(BoundarySurface, CornersRunCounterclockwiseFromOutside) {
  const CellComplex complex = block(1, 1, 1);
  const BoundarySurface surface(complex);
  const auto place = [](Index v) {
    return Vec3{double(v & 1), double(v >> 1 & 1), double(v >> 2)};
  };
  for (const auto& c : surface.corners()) {
    Vec3 a = place(c[0]), b = place(c[1]), d = place(c[3]), normal{}, out{};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      normal[i] = (b[j] - a[j]) * (d[k] - a[k]) - (b[k] - a[k]) * (d[j] - a[j]);
      for (const Index v : c) out[i] += place(v)[i] / 4;
      out[i] -= 0.5;
    }
    EXPECT_GT(normal[0] * out[0] + normal[1] * out[1] + normal[2] * out[2], 0.4);
  }
}

TEST(BoundarySurface, FollowsRandomCutsRemovalsAndSutures) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    CellComplex complex = block(5, 4, 3);
    BoundarySurface surface(complex);
    Operations operations(random);
    for (int i = 0; i < 25; ++i) {
      surface.follow(complex, apply(complex, operations.next(complex)));
      ASSERT_EQ(Contents(surface), rebuilt(complex)) << "after operation " << i;
    }
    expect_whole_boundary(complex, surface);
    expect_edges_in_pairs(complex, surface);
  }
}

TEST(BoundarySurface, ContinuesAfterItWasSavedAndLoaded) {
  std::mt19937 random(7);
  CellComplex complex = block(5, 4, 3);
  BoundarySurface surface(complex);
  Operations operations(random);
  for (int i = 0; i < 10; ++i) surface.follow(complex, apply(complex, operations.next(complex)));
  StateTree tree;
  save_state(tree, surface);
  BoundarySurface loaded(block(5, 4, 3));
  load_state(tree, loaded);
  for (int i = 0; i < 10; ++i) {
    const TopologyChange change = apply(complex, operations.next(complex));
    surface.follow(complex, change);
    loaded.follow(complex, change);
  }
  EXPECT_TRUE(std::ranges::equal(loaded.faces(), surface.faces())) << "in the same order";
  EXPECT_TRUE(std::ranges::equal(loaded.vertices(), surface.vertices()));
  EXPECT_EQ(Contents(loaded), rebuilt(complex));
}

}  // namespace
}  // namespace suture
