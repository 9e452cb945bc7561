// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

// The unit cube and a second one on its x = 1 side, corners in Medit's order.
const std::vector<std::string> cube_points{"0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1",
                                           "1 1 1", "0 1 1", "2 0 0", "2 1 0", "2 0 1", "2 1 1"};
constexpr const char* first = "1 2 3 4 5 6 7 8";
constexpr const char* second = "2 9 10 3 6 11 12 7";

std::string medit(const std::vector<std::string>& vertices,
                  const std::vector<std::string>& hexahedra,
                  const std::vector<std::string>& references = {"0", "0", "0"}) {
  std::string text = "MeshVersionFormatted 2\nDimension 3\nVertices\n";
  text += std::to_string(vertices.size()) + "\n";
  for (const std::string& vertex : vertices) text += vertex + " 0\n";
  text += "Hexahedra\n" + std::to_string(hexahedra.size()) + "\n";
  for (std::size_t i = 0; i < hexahedra.size(); ++i)
    text += hexahedra[i] + " " + references[i] + "\n";
  return text + "End\n";
}

class BadMeshes : public Program {
 public:
  Outcome run(const std::string& mesh, const std::vector<std::string>& sets = {}) const {
    write("m.mesh", mesh);
    std::vector<std::string> all{"/mesh={\"file\": \"m.mesh\"}"};
    all.insert(all.end(), sets.begin(), sets.end());
    return scene("run", "", all);
  }
  void expect_refused(const std::string& mesh, const std::string& words) const {
    const Outcome outcome = run(mesh);
    EXPECT_EQ(outcome.code, 3) << words << "\n" << outcome;
    EXPECT_TRUE(outcome.says(words)) << words << "\n" << outcome;
    EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << words;
  }
  static std::vector<std::string> points_with(std::size_t index, const std::string& point) {
    std::vector<std::string> changed = cube_points;
    changed[index] = point;
    return changed;
  }
};

TEST_F(BadMeshes, TheSoundOneRuns) {
  const Outcome outcome = run(medit(cube_points, {first, second}));
  EXPECT_EQ(outcome.code, 0) << outcome;
}

TEST_F(BadMeshes, FilesThatHoldNoMesh) {
  expect_refused("", "m.mesh");
  expect_refused("garbage", "m.mesh");
  expect_refused(medit(cube_points, {}), "m.mesh");
  const std::string sound = medit(cube_points, {first, second});
  expect_refused(sound.substr(0, sound.size() / 2), "m.mesh");
  expect_refused(
      "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n"
      "0 0 1 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n",
      "etrahedr");
}

TEST_F(BadMeshes, NumbersThatAreNone) {
  expect_refused(medit(points_with(3, "nan 1 0"), {first, second}), "m.mesh");
  expect_refused(medit(points_with(3, "inf 1 0"), {first, second}), "m.mesh");
  expect_refused(medit(points_with(3, "0 one 0"), {first, second}), "m.mesh");
  expect_refused(medit(cube_points, {first, "2 9 10 3 6 11 99 7"}), "99");
  expect_refused(medit(cube_points, {first, "2 9 10 3 6 11 0 7"}), "0");
}

TEST_F(BadMeshes, ElementsThatFormNoMap) {
  expect_refused(medit(cube_points, {first, "2 9 10 3 6 11 12 12"}), "1");  // a node twice
  expect_refused(medit(cube_points, {first, second, second}), "2");         // one element twice
  expect_refused(medit(cube_points, {first, "2 9 3 10 6 11 12 7"}), "1");   // nodes across
  std::vector<std::string> more = cube_points;
  for (const char* p : {"2 0 0.5", "2 1 0.5", "3 0 1", "3 1 1"}) more.emplace_back(p);
  expect_refused(medit(more, {first, second, "2 13 14 3 6 15 16 7"}), "2");  // a face in three
}

TEST_F(BadMeshes, RestShapesThatAreInsideOut) {
  expect_refused(medit(points_with(6, "0.1 0.1 -1"), {first}), "acobian");
  expect_refused(medit(points_with(4, "0 0 0"), {first}), "m.mesh");
  // Flat: all nodes in one plane.
  std::vector<std::string> flat = cube_points;
  for (std::size_t i = 4; i < 8; ++i) flat[i] = flat[i - 4];
  expect_refused(medit(flat, {first}), "acobian");
}

TEST_F(BadMeshes, WhatAUserWouldExpectToBeRepairedIs) {
  std::vector<std::string> unused = cube_points;
  unused.emplace_back("7 7 7");
  const Outcome dropped = run(medit(unused, {first, second}));
  EXPECT_EQ(dropped.code, 0) << dropped;
  EXPECT_TRUE(dropped.says("1 warning")) << dropped;
  const Outcome mirrored = run(medit(cube_points, {first, "6 11 12 7 2 9 10 3"}));
  EXPECT_EQ(mirrored.code, 0) << mirrored;
  EXPECT_TRUE(mirrored.says("mirror")) << mirrored;
}

TEST_F(BadMeshes, NonManifoldCellsAreSplitOrRefused) {
  std::vector<std::string> more = cube_points;
  for (const char* p : {"2 2 0", "1 2 0", "2 2 1", "1 2 1"}) more.emplace_back(p);
  // Second cube on the edge x = y = 1 of the first.
  const std::string mesh = medit(more, {first, "3 10 13 14 7 12 15 16"});
  const Outcome split = run(mesh);
  EXPECT_EQ(split.code, 0) << split;
  EXPECT_TRUE(split.says("non-manifold")) << split;
  const Outcome refused = run(mesh, {"/mesh/pinched=refuse"});
  EXPECT_EQ(refused.code, 3) << refused;
}

/// Three cubes in a row, elements 1 and 2 in "ref 7", element 3 in "ref 8".
class BadElements : public BadMeshes {
 public:
  /// `corner`: node 1, which only the first cube has.
  static std::string row(const std::string& corner, const std::string& middle = second) {
    std::vector<std::string> nodes = points_with(0, corner);
    for (const char* p : {"3 0 0", "3 1 0", "3 0 1", "3 1 1"}) nodes.emplace_back(p);
    return medit(nodes, {first, middle, "9 13 14 10 11 15 16 12"}, {"7", "7", "8"});
  }
  /// The cube is pushed through itself at node 1.
  static std::string inverted() { return row("0.95 0.95 0.95"); }
  Outcome drop(const std::string& mesh, std::vector<std::string> sets = {}) const {
    sets.insert(sets.begin(), "/mesh/bad_elements=drop");
    return run(mesh, sets);
  }
};

TEST_F(BadElements, AreLeftOutOnRequestOnly) {
  const std::string torn = row("0 0 0", "2 9 10 3 6 11 12 12");  // a node twice
  expect_refused(torn, "\"bad_elements\": \"drop\" in /mesh");
  expect_refused(inverted(), "1 element with a corner Jacobian <= 0 at rest: 1");
  expect_refused(inverted(), "\"bad_elements\": \"drop\" in /mesh");
  const Outcome dropped = drop(inverted());
  EXPECT_EQ(dropped.code, 0) << dropped;
  EXPECT_TRUE(dropped.says("1 bad element of 3, left out: 1 (1) with a corner Jacobian <= 0"))
      << dropped;

  const Outcome pieces = drop(torn);
  EXPECT_EQ(pieces.code, 0) << pieces;
  EXPECT_TRUE(pieces.says("left out: 1 (2) with the same point twice")) << pieces;
  EXPECT_TRUE(pieces.says("falls into 2 separate pieces")) << pieces;
}

TEST_F(BadElements, LeaveTheOthersTheirNumbersAndSets) {
  const Outcome ids = drop(inverted(), {R"(/models/0/region={"ids": [2, 3]})",
                                        R"(/constraints=[{"fix": "xyz", "where": {"ids": [16]}}])",
                                        R"(/output={"fields": ["element_id"]})"});
  EXPECT_EQ(ids.code, 0) << ids;
  suture({"mesh", "convert", "out/s/frame_0001.vtu", "frame.msh"});
  EXPECT_NE(read("frame.msh").find("3 1 5 2\n2 "), std::string::npos) << read("frame.msh");
  const Outcome gone = drop(inverted(), {R"(/models/0/region={"ids": [1]})"});
  EXPECT_EQ(gone.code, 3) << gone;
  EXPECT_TRUE(gone.says("/models/0/region: the mesh has no element with id 1")) << gone;
  const Outcome node =
      drop(inverted(), {R"(/constraints=[{"fix": "xyz", "where": {"ids": [1]}}])"});
  EXPECT_TRUE(node.says("contains no node")) << node;

  const std::string model =
      R"({"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1},)";
  const Outcome sets = drop(inverted(), {"/models=[" + model + R"("region": {"set": "ref 7"}},)" +
                                         model + R"("region": {"set": "ref 8"}}])"});
  EXPECT_EQ(sets.code, 0) << sets;
}

TEST_F(BadElements, AreAnErrorIfNoneIsLeft) {
  std::vector<std::string> flat = cube_points;
  for (std::string& point : flat) point.back() = '0';
  const Outcome outcome = drop(medit(flat, {first, second}));
  EXPECT_EQ(outcome.code, 3) << outcome;
  EXPECT_TRUE(outcome.says("all 2 are bad")) << outcome;
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

TEST_F(BadElements, AreLeftOutOfConvertedMeshes) {
  write("m.mesh", inverted());
  const Outcome kept = suture({"mesh", "convert", "m.mesh", "all.msh"});
  EXPECT_EQ(kept.code, 0) << kept;
  EXPECT_NE(read("all.msh").find("$Elements\n2 3 1 3\n"), std::string::npos) << read("all.msh");
  const Outcome dropped = suture({"mesh", "convert", "m.mesh", "good.msh", "--drop-bad"});
  EXPECT_EQ(dropped.code, 0) << dropped;
  EXPECT_NE(read("good.msh").find("$Elements\n2 2 2 3\n"), std::string::npos) << read("good.msh");
  EXPECT_EQ(suture({"mesh", "info", "m.mesh"}).code, 3);
  EXPECT_EQ(suture({"mesh", "info", "good.msh"}).code, 0);
}

}  // namespace
}  // namespace suture::testing
