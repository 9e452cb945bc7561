// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values that are valid by themselves, but contradict each other or cannot be computed with.
#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

using BadScenes = Program;

// The block has 27 nodes; sides share edges of 3.
TEST_F(BadScenes, ConstraintsThatOverlapMustAgree) {
  const auto check = [&](const std::string& constraints) {
    return scene("check", ",\n  \"constraints\": [\n" + constraints + "]");
  };
  const auto move = [](const std::string& motion, const char* ramp, const char* set) {
    return "{\"move\": {" + motion + "}, \"ramp\": " + ramp + ", \"where\": {\"set\": \"" + set +
           "\"}}";
  };
  const auto fix = [](const char* components, const char* set) {
    return std::string("{\"fix\": \"") + components + "\", \"where\": {\"set\": \"" + set + "\"}}";
  };
  const std::string along = R"("translation": [0.1, 0, 0])",
                    turn = R"("rotation": {"axis": [1, 0, 0], "angle": 20, "centre": [0, 1, 1]})";
  for (const std::string& good :
       {fix("xyz", "x0") + "," + fix("xy", "y0"), move(along, "1", "x1") + "," + fix("yz", "y0"),
        move(along, "1", "x1") + "," + move(along, "1", "y1"),
        move(turn, "1", "x1") + "," + fix("x", "y0"),
        move(along, "1", "x1") + "," + fix("xyz", "x0")})
    EXPECT_EQ(check(good).code, 0) << good;
  struct Case {
    std::string constraints;
    const char* words;
  };
  const Case cases[] = {
      {move(along, "1", "x1") + "," + move(R"("translation": [-0.1, 0, 0])", "1", "x1"),
       "another motion than /constraints/0 for 9 nodes, the first is node 2 at (1, 0, 0) m"},
      {move(along, "1", "x1") + "," + move(along, R"({"from": 1, "to": 2})", "y0"),
       "for 3 nodes, the first is node 2"},
      {fix("x", "y0") + "," + move(along, "1", "x1"), "for 3 nodes"},
      {fix("yz", "y1") + "," + move(turn, "1", "x1"), "for 2 nodes, the first is node 8"},
      {move(turn, "1", "x1") + "," +
           move(R"("rotation": {"axis": [1, 0, 0], "angle": 380, "centre": [0, 1, 1]})", "1", "x1"),
       "for 8 nodes"}};
  for (const Case& bad : cases) {
    const Outcome outcome = check(bad.constraints);
    EXPECT_EQ(outcome.code, 3) << bad.constraints << outcome;
    EXPECT_TRUE(outcome.says("s.json:7:") && outcome.says("/constraints/1: prescribes another") &&
                outcome.says(bad.words))
        << bad.constraints << outcome;
  }
  const Outcome both = check(fix("x", "x1") + "," + fix("y", "x1") + "," +
                             move(R"("translation": [1, 1, 0])", "1", "x1"));
  EXPECT_TRUE(both.says("2 mistakes")) << both;
}

// Squares of smaller and larger lengths are zero and infinite.
TEST_F(BadScenes, LengthsThatCannotBeComputedWith) {
  const std::string obstacle = R"(/contact={"obstacles": [{"name": "o", )";
  write("far.obj",
        "v 0 0 2e150\nv 1e150 0 2e150\nv 0 1e150 2e150\nv 0 0 3e150\n"
        "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string large = "must be at most 1e+30 m in magnitude, is ",
                    small = "must be at least 1e-30 m, is ", direction = "largest component";
  const struct {
    std::string set, path, words;
  } cases[] = {
      {"/mesh/box/size=[1e-170, 1, 1]", "/mesh/box/size/0", small + "1e-170 m"},
      {"/mesh/box/origin=[0, -1e150, 0]", "/mesh/box/origin/1", large + "-1e+150 m"},
      {obstacle + R"("sphere": {"centre": [0, 0, 3], "radius": 1e160}}]})", "/sphere/radius",
       large},
      {obstacle + R"("half_space": {"point": [0, 0, 0], "normal": [0, 1e-170, 0]}}]})",
       "/half_space/normal", direction},
      {obstacle + R"("box": {"min": [0, 0, 2], "max": [1, 1, 3]}, "axis": [0, 0, 1e-170],
          "path": [{"at": 0, "angle": 9}]}]})",
       "/obstacles/0/axis", direction},
      {obstacle + R"("capsule": {"from": [0, 0, 0], "to": [0, 0, 1e-170], "radius": 1}}]})",
       "/capsule/to", "is the same point as 'from'"},
      {obstacle + R"("surface": {"file": "far.obj"}}]})", "/surface/file",
       "far.obj: point 0 has a coordinate that is larger than 1e30 m"},
      {obstacle + R"("surface": {"file": "far.obj", "scale": 1e-200}}]})", "/surface/file",
       "the surface is smaller than 1e-30 m"},
      {R"(/events=[{"at": 0, "cut": {"plane": {"point": [0, 0, 0], "normal": [1e200, 0, 0]}}}])",
       "/plane/normal", direction}};
  for (const auto& bad : cases) {
    const Outcome outcome = scene("check", "", {bad.set});
    EXPECT_EQ(outcome.code, 3) << bad.set << outcome;
    EXPECT_TRUE(outcome.says(bad.path) && outcome.says(bad.words)) << bad.set << outcome;
  }
  write("far.mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n"
        "0 0 0 0\n1e150 0 0 0\n1e150 1e150 0 0\n0 1e150 0 0\n0 0 1e150 0\n"
        "1e150 0 1e150 0\n1e150 1e150 1e150 0\n0 1e150 1e150 0\n"
        "Hexahedra\n1\n1 2 3 4 5 6 7 8 0\nEnd\n");
  const auto with_scale = [&](const char* scale) {
    return scene("check", "",
                 {std::string(R"(/mesh={"file": "far.mesh", "scale": )") + scale + "}"});
  };
  EXPECT_TRUE(with_scale("1").says("has 7 points with a coordinate that is larger than 1e30 m"));
  EXPECT_TRUE(with_scale("1e-200").says("is smaller than 1e-30 m in all directions"));
  EXPECT_EQ(with_scale("1e-150").code, 0);
}

// Values of the scene that only overflow in sums.
TEST_F(BadScenes, ForcesThatOverflowEndTheRunWithoutARow) {
  for (const std::string table :
       {R"("energies": {})", R"("probes": {"at": [{"name": "end", "where": {"set": "x1"}}]})"}) {
    const Outcome run =
        scene("run", ",\n  \"output\": {\"directory\": \"o\", \"frames\": false, " + table + "}",
              {"/gravity=[1e300, 0, 0]", "/mesh/box/size=[1e10, 1, 1]"});
    EXPECT_EQ(run.code, 5) << run;
    EXPECT_TRUE(run.says("not finite")) << run;
    for (const char* file : {"o/energies.csv", "o/probes.csv"})
      EXPECT_EQ(read(file).find(",-inf"), std::string::npos) << read(file);
  }
}

}  // namespace
}  // namespace suture::testing
