// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

using BadScenes = Program;

// The block of the scene reaches from 0 to 1 m.
TEST_F(BadScenes, Obstacles) {
  struct Case {
    std::string set, where, words;
  };
  const std::string at = "/contact={\"obstacles\": [{\"name\": \"o\", ";
  const std::string floor = R"("half_space": {"point": [0, 0, 0], "normal": [0, 0, 1]})";
  const std::string ball = R"("sphere": {"centre": [0.5, 0.5, 1.5], "radius": 0.5})";
  const auto one = [&](const std::string& members) { return at + members + "}]}"; };
  const Case cases[] = {
      {"/contact={}", "/contact", "touches nothing"},
      {"/contact={\"obstacles\": []}", "/contact", "touches nothing"},
      {"/contact={\"self\": true, \"pieces\": false}", "/contact/pieces", "touches itself"},
      {"/contact={\"friktion\": 1, \"obstacles\": []}", "/contact/friktion", "'friction'"},
      {one(floor + ", \"friction\": -0.1"), "/obstacles/0/friction", "must be >= 0"},
      {one(R"("sphere": {"centre": [0, 0, 3], "radius": 0})"), "/sphere/radius", "must be > 0 m"},
      {one(R"("half_space": {"point": [0, 0, 0], "normal": [0, 0, 0]})"), "/half_space/normal",
       "must not be [0, 0, 0]"},
      {one(R"("capsule": {"from": [0, 0, 3], "to": [0, 0, 3], "radius": 1})"), "/capsule/to",
       "is the same point as 'from'"},
      {one(R"("box": {"min": [0, 0, 2], "max": [1, 1, 2]})"), "/box", "has no volume"},
      {one("\"friction\": 1"), "/contact/obstacles/0", "half_space"},
      {one(floor + ", " + ball), "/contact/obstacles/0", "sphere"},
      {one(ball + ", \"path\": [{\"at\": 0}, {\"at\": 0}]"), "/path/1/at", "must be later"},
      {one(ball + ", \"path\": [{\"at\": 0, \"angle\": 9}]"), "/path/0/angle", "needs an axis"},
      {at + floor + "}, {\"name\": \"o\", " + ball + "}]}", "/obstacles/1/name", "must be unique"},
      {one(R"("half_space": {"point": [0, 0, 0.125], "normal": [0, 0, 1]})"),
       "/contact/obstacles/0", "the deepest by 0.125 m"},
      {one(R"("sphere": {"centre": [0.25, 0.25, 0.25], "radius": 0.1})"), "/contact/obstacles/0",
       "lies inside the body: (0.25, 0.25, 0.25) m"},
      {one(ball + R"(, "path": [{"at": 0}, {"at": 1e-6, "translation": [0, 0, 1]}])"),
       "/contact/obstacles/0", "jump over the surface"},
      {"/contact={\"law\": \"penalti\", \"obstacles\": []}", "/contact/law", "'penalty'"},
      {"/contact={\"law\": \"penalty\", \"pieces\": true}", "/contact/law", "only obstacles"},
      {"/contact={\"law\": \"penalty\", \"friction\": 0.1, \"obstacles\": [{\"name\": \"o\", " +
           floor + "}]}",
       "/contact/law", "loses energy"},
      {one(ball + R"(, "coupling": {"mass": 1})"), "/contact/obstacles/0/coupling",
       "'stiffness' is missing"},
      {one(ball + R"(, "coupling": {"mass": 0, "stiffness": 1})"), "/coupling/mass",
       "must be > 0 kg"},
      {one(ball + R"(, "coupling": {"mass": 1, "stiffness": 1, "damping": -1})"),
       "/coupling/damping", "must be >= 0 N s/m"},
      {one(ball + R"(, "coupling": {"mass": 1, "stiffness": 1, "interia": 1})"),
       "/coupling/interia", "'inertia'"},
      {one(floor + R"(, "coupling": {"mass": 1, "stiffness": 1})"), "/contact/obstacles/0/coupling",
       "is not possible for a half_space"},
      {"/output={\"tools\": {}}", "/output/tools", "needs obstacles"},
      {"/output={\"obstacles\": true}", "/output/obstacles", "needs obstacles"},
      {"/output={\"fields\": [\"gap\"]}", "/output/fields/0", "and the scene has none"}};
  for (const Case& bad : cases) {
    const Outcome outcome = scene("check", "", {bad.set});
    EXPECT_EQ(outcome.code, 3) << bad.set << '\n' << outcome;
    EXPECT_TRUE(outcome.says(bad.where) && outcome.says(bad.words)) << bad.set << '\n' << outcome;
  }
}

TEST_F(BadScenes, BladesThatObstaclesCarry) {
  const std::string ball =
      "/contact={\"obstacles\": [{\"name\": \"knife\", \"sphere\": "
      "{\"centre\": [0.5, 0.5, 1.5], \"radius\": 0.5}}]}";
  const auto blade = [](const std::string& members) {
    return "/events=[{\"cut\": {\"blade\": {" + members + "}}}]";
  };
  const std::string points = R"("points": [[0, 0, 1], [1, 0, 1]])";
  struct Case {
    std::vector<std::string> sets;
    std::string where, words;
  };
  const Case cases[] = {
      {{blade("\"obstacle\": \"knife\", " + points)}, "/blade/obstacle", "needs obstacles"},
      {{ball, blade("\"obstacle\": \"knive\", " + points)}, "/blade/obstacle", "'knife'"},
      {{ball, blade("\"obstacle\": \"knife\"")}, "/cut/blade", "'points' is missing"},
      {{ball, blade(R"("obstacle": "knife", "points": [[0, 0, 1]])")}, "/blade/points", "2"},
      {{ball, blade(points)}, "/cut/blade", "obstacle"},
      {{ball, blade(R"("obstacle": "knife", "path": [], )" + points)}, "/cut/blade", "path"},
      {{ball, blade(R"("obstacle": "knife", "points": [[0, 0, 1], [0, 0, 1]])")},
       "/events/0",
       "coincident points"},
      {{ball, blade(R"("obstacle": "knife", "points": [[0, 0, 1], [0, 0, 9e18]], "resistance": )"
                    R"({"toughness": 300, "stress": 5e5, "thickness": 1e-3})")},
       "/events/0/cut/blade/points",
       "at most 1e+04: let it end near the body"}};
  for (const Case& bad : cases) {
    const Outcome outcome = scene("check", "", bad.sets);
    EXPECT_EQ(outcome.code, 3) << bad.sets.back() << '\n' << outcome;
    EXPECT_TRUE(outcome.says(bad.where) && outcome.says(bad.words)) << bad.sets.back() << '\n'
                                                                    << outcome;
  }
}

TEST_F(BadScenes, ObstaclesOfTriangles) {
  // A tetrahedron, without its last face, and through another.
  const std::string points = "v 0 0 2\nv 1 0 2\nv 0 1 2\nv 0 0 3\n";
  const std::string faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\n", last = "f 2 3 4\n";
  write("open.obj", points + faces);
  write("flat.obj", points + "f 1 2 3\nf 1 3 2\n");
  write("crossing.obj", points + faces + last +
                            "v 0.1 0.1 1.5\nv 0.3 0.1 1.5\nv 0.1 0.3 1.5\nv 0.2 0.2 2.5\n"
                            "f 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n");
  write("solid.obj", points + faces + last);
  struct Case {
    std::string surface, where, words;
  };
  const Case cases[] = {
      {R"({"scale": 1})", "/contact/obstacles/0/surface", "'file' is missing"},
      {R"({"file": "sold.obj"})", "/surface/file", "solid.obj"},
      {R"({"file": "."})", "/surface/file", "is a folder"},
      {R"({"file": "solid.obj", "scale": 0})", "/surface/scale", "must be > 0"},
      {R"({"file": "open.obj"})", "/surface/file", "so it has no inside: 3 edges"},
      {R"({"file": "crossing.obj"})", "/surface/file", "the surface intersects itself"},
      {R"({"file": "flat.obj"})", "/surface/file", "so it has no inside"},
      {R"({"file": "solid.obj", "translation": [0, 0, -1.5]})", "/contact/obstacles/0",
       "lies inside the body"}};
  for (const Case& bad : cases) {
    const Outcome outcome =
        scene("check", "",
              {"/contact={\"obstacles\": [{\"name\": \"o\", \"surface\": " + bad.surface + "}]}"});
    EXPECT_EQ(outcome.code, 3) << bad.surface << '\n' << outcome;
    EXPECT_TRUE(outcome.says(bad.where) && outcome.says(bad.words)) << bad.surface << '\n'
                                                                    << outcome;
  }
}

TEST_F(BadScenes, ObstaclesThatASolverDoesNotSee) {
  const std::string floor =
      "/contact={\"pieces\": true, \"obstacles\": [{\"name\": \"o\", \"half_space\": "
      "{\"point\": [0, 0, 0], \"normal\": [0, 0, 1]}}]}";
  for (const char* solver :
       {R"({"integrator": "newmark", "end": 1, "dt": 0.1})",
        R"({"end": 1, "dt": 0.01, "integrator": "implicit-euler",
            "sleep": {"acceleration": 1, "velocity": 1}})",
        R"({"integrator": "velocity-verlet", "end": 1, "step_error": 1e-3})"}) {
    const Outcome outcome = scene("check", "", {floor, std::string("/solver=") + solver});
    EXPECT_EQ(outcome.code, 3) << outcome;
    EXPECT_TRUE(outcome.says("/contact") && outcome.says("cannot be combined")) << outcome;
    EXPECT_TRUE(outcome.says("1 mistake")) << outcome;
  }
  scene("check", "", {});
  const Outcome modes = suture({"modes", "s.json", "--set", floor});
  EXPECT_EQ(modes.code, 3) << modes;
  EXPECT_TRUE(modes.says("modes do not include contact")) << modes;
  const Outcome far = scene("check", "",
                            {"/contact={\"obstacles\": [{\"name\": \"o\", \"sphere\": "
                             "{\"centre\": [0, 0, 900], \"radius\": 1}}]}"});
  EXPECT_EQ(far.code, 0) << far;
  EXPECT_TRUE(far.says("warning") && far.says("m away from the body")) << far;
}

TEST_F(BadScenes, ObstaclesThatJumpBetweenEquilibria) {
  const auto outcome_of = [&](const char* way, const char* solver) {
    return scene("check", "",
                 {std::string("/solver=") + solver,
                  std::string("/contact={\"obstacles\": [{\"name\": \"o\", \"sphere\": "
                              "{\"centre\": [0, 0, -2], \"radius\": 1}, \"path\": [{\"at\": 0}, "
                              "{\"at\": 0.1, \"translation\": [0, 0, ") +
                      way + "]}]}]}"});
  };
  const Outcome far = outcome_of("-9", R"({"static": {"frames": 2}, "end": 1})");
  EXPECT_EQ(far.code, 3) << far;
  EXPECT_TRUE(far.says("by up to 9 m between two equilibria") && far.says("\"frames\"")) << far;
  const Outcome implicit =
      outcome_of("-9", R"({"integrator": "implicit-euler", "dt": 0.1, "end": 1})");
  EXPECT_TRUE(implicit.says("reduce /solver/dt")) << implicit;
  EXPECT_FALSE(implicit.says("auto")) << implicit;
  const Outcome near =  // it stops within the step
      outcome_of("-0.2", R"({"integrator": "implicit-euler", "dt": 1, "end": 1})");
  EXPECT_FALSE(near.says("moves by up to")) << near;
}

}  // namespace
}  // namespace suture::testing
