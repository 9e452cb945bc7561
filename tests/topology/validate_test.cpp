// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {

/// Reaches into a map to break it.
struct CellComplexAccess {
  static std::vector<incidence::Link>& links(CellComplex& map) { return map.links_; }
  static std::vector<Hexahedron>& vertices(CellComplex& map) { return map.vertices_; }
  static std::vector<std::array<Index, 12>>& edges(CellComplex& map) { return map.edges_; }
  static std::vector<std::array<Index, 6>>& faces(CellComplex& map) { return map.faces_; }
  static std::vector<Dart>& some_dart(CellComplex& map, int dimension) {
    return map.first_dart_[dimension];
  }
  static std::array<Index, 4>& holes(CellComplex& map) { return map.holes_; }
  static std::vector<std::uint64_t>& marks(CellComplex& map) { return map.element_marks_; }
};

namespace {

using Access = CellComplexAccess;

class Validate : public ::testing::Test {
 protected:
  CellComplex map = meshes::complex_of(meshes::grid(2, 2, 2));

  void expect_broken(const std::string& law, const std::string& place) const {
    try {
      map.validate();
      ADD_FAILURE() << "nothing found";
    } catch (const TopologyError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(law), std::string::npos) << text;
      EXPECT_NE(text.find(place), std::string::npos) << text;
    }
  }
};

TEST_F(Validate, AcceptsASoundMap) { EXPECT_NO_THROW(map.validate()); }

TEST_F(Validate, FindsAFaceUnlinkedOnOneSide) {
  Access::links(map)[2] = none;  // face x1 of element 0; its mate is x0 of element 1
  expect_broken("beta3(beta3(d)) = d", "dart 24 (element 1, face 0, position 0)");
}

TEST_F(Validate, FindsAFaceGluedToItsOwnElement) {
  Access::links(map)[0] = 8;
  expect_broken("beta3 joins different elements", "dart 0 (element 0, face 0, position 0)");
}

TEST_F(Validate, FindsAMateThatDoesNotExist) {
  Access::links(map)[0] = incidence::link_of(8, 0);
  expect_broken("beta3 maps to a dart", "dart 0 ");
}

TEST_F(Validate, FindsATurnedFace) {
  incidence::Link& one = Access::links(map)[2];
  incidence::Link& other = Access::links(map)[6];
  one = (one & ~3u) | ((one + 1) & 3);
  other = (other & ~3u) | ((other + 1) & 3);
  expect_broken("one id per vertex", "dart 8 (element 0, face 2, position 0)");
}

TEST_F(Validate, FindsAVertexWithTwoIds) {
  Access::vertices(map)[0][7] = 0;
  expect_broken("one id per vertex", "element 0");
}

TEST_F(Validate, FindsAnIdBeyondTheCount) {
  Access::edges(map)[3][5] = 1000;
  expect_broken("every edge id is below the count", "element 3");
}

TEST_F(Validate, FindsTwoVerticesWithOneId) {
  const Index a = map.vertices_of(0)[0], b = map.vertices_of(7)[7];
  Access::vertices(map)[7][7] = a;
  Access::some_dart(map, 0)[b] = Access::some_dart(map, 0)[a];
  expect_broken("dart_of(vertex id) lies on it", "dart 3 ");
}

TEST_F(Validate, FindsAnIdOfTwoOrbits) {
  const Index a = map.vertices_of(0)[0];
  const Index last = map.count(0) - 1;
  ASSERT_EQ(map.vertices_of(7)[7], last);
  Access::vertices(map)[7][7] = a;
  Access::some_dart(map, 0).pop_back();
  expect_broken("one vertex per id", "element 7");
}

TEST_F(Validate, FindsADartThatIsNotTheSmallest) {
  Access::some_dart(map, 2)[map.faces_of(0)[2]] = 24;
  expect_broken("is its smallest dart", "dart 24 ");
}

TEST_F(Validate, FindsFaceIdsThatDiffer) {
  Access::faces(map)[0][2] = Access::faces(map)[0][1];
  expect_broken("one id per face", "dart 8 ");
}

TEST_F(Validate, FindsWhatIsLeftOfARemovedElement) {
  map.pierce(std::array<Index, 1>{5});
  EXPECT_NO_THROW(map.validate());
  Access::edges(map)[5][2] = 0;
  expect_broken("a removed element has no cells", "element 5, face 1, position 1");
}

TEST_F(Validate, FindsHolesThatAreNotCounted) {
  map.pierce(std::array<Index, 1>{5});
  ++Access::holes(map)[1];
  expect_broken("existing() counts the edge ids", "3 do not exist");
}

TEST_F(Validate, FindsForgottenMarks) {
  Access::marks(map)[0] = 1;
  expect_broken("marked", "dart 0 ");
}

}  // namespace
}  // namespace suture
