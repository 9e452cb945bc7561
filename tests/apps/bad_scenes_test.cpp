// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

using BadScenes = Program;

TEST_F(BadScenes, FilesThatCannotBeRead) {
  const Outcome missing = suture({"run", "nowhere.json"});
  EXPECT_EQ(missing.code, 6) << missing;
  EXPECT_TRUE(missing.says("nowhere.json") && missing.says("No such file")) << missing;
  const Outcome directory = suture({"run", "."});
  EXPECT_EQ(directory.code, 6) << directory;
  EXPECT_TRUE(directory.says("folder")) << directory;
}

// None of them is waited for, or read for ever.
TEST_F(BadScenes, FilesThatAreNotRegular) {
  const std::string fifo = (folder() / "fifo").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0644), 0);
  for (const char* extension : {".vtu", ".msh", ".stl", ".h5", ".so"})
    std::filesystem::create_symlink("fifo", fifo + extension);
  const std::string device = "is a device, not a regular file";
  const std::string pipe = "is a pipe, not a regular file";
  struct Case {
    std::vector<std::string> arguments;
    int code;
    std::string words;
  };
  const Case cases[] = {{{"check", "/dev/zero"}, 6, "/dev/zero' " + device},
                        {{"run", "fifo"}, 6, pipe},
                        {{"run", "--resume", "fifo.h5"}, 3, pipe},
                        {{"run", "--resume", "/dev/zero"}, 3, device},
                        {{"replay", "fifo"}, 3, pipe},
                        {{"mesh", "info", "fifo.vtu"}, 3, pipe},
                        {{"mesh", "info", "fifo.msh"}, 3, pipe},
                        {{"mesh", "voxelize", "fifo.stl", "--cells", "9", "-o", "m.vtu"}, 3, pipe}};
  for (const Case& bad : cases) {
    const Outcome outcome = suture(bad.arguments);
    EXPECT_EQ(outcome.code, bad.code) << outcome;
    EXPECT_TRUE(outcome.says(bad.words)) << outcome;
  }
  const Outcome mesh = scene("check", "", {"/mesh={\"file\": \"fifo.vtu\"}"});
  EXPECT_EQ(mesh.code, 3) << mesh;
  EXPECT_TRUE(mesh.says("fifo.vtu' is a pipe") && !mesh.says("did you mean")) << mesh;
  EXPECT_EQ(scene("check", "", {"/plugins=[\"fifo.so\"]"}).code, 4);
}

TEST_F(BadScenes, SyntaxErrorsHaveALineAndAHint) {
  write("empty.json", "");
  write("comma.json", "{\n  \"suture\": 1,\n}\n");
  write("binary.json", std::string("\x7f\x45\x4c\x46\0\0\1", 7));
  EXPECT_EQ(suture({"run", "empty.json"}).code, 3);
  const Outcome comma = suture({"run", "comma.json"});
  EXPECT_EQ(comma.code, 3) << comma;
  EXPECT_TRUE(comma.says("comma.json:3:1: ") && comma.says("extra comma")) << comma;
  EXPECT_EQ(suture({"run", "binary.json"}).code, 3);
}

TEST_F(BadScenes, FiveMistakesAreReportedAtOnceAndNothingRuns) {
  const Outcome five = scene("run", R"(,
  "gravty": [0, -9.8, 0],
  "constraints": [{"fix": "xyz", "were": {"set": "x0"}}],
  "events": [{"at": 1, "cut": {"faces": [[0, 1]]}}],
  "output": {"fields": ["strss"]})");
  EXPECT_EQ(five.code, 3) << five;
  for (const char* words : {"s.json:6:3: /gravty", "'gravity'", "s.json:7:34: /constraints/0/were",
                            "'where' is missing", "s.json:8:21: /events/0/at",
                            "s.json:9:25: /output/fields/0", "'stress'", "5 mistakes"}) {
    EXPECT_TRUE(five.says(words)) << words << five;
  }
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

struct BadValue {
  const char* set;
  int code;
  const char* words;
};

// What only the mesh shows is reported like a mistake of the text: all at once, with places.
TEST_F(BadScenes, MistakesThatOnlyTheMeshShowsAreReportedAtOnce) {
  const Outcome outcome = scene("check", R"(,
  "constraints": [
    {"fix": "xyz", "where": {"set": "x00"}},
    {"fix": "xyz", "where": {"box": {"min": [5, 5, 5], "max": [6, 6, 6]}}}],
  "loads": [{"pressure": 1, "where": {"sphere": {"centre": [0.5, 0.5, 0.5], "radius": 0.1}}}],
  "events": [
    {"at": 0, "cut": {"faces": [[0, 1],
      [4, 99]]}},
    {"when": {"where": {"ids": [777]}, "of": "displacement", "above": 1},
     "pierce": {"where": {"set": "y9"}}}],
  "output": {"probes": {"at": [{"name": "p", "where": {"ids": [1000]}}]}})",
                                {R"(/models/0/region={"ids": [99]})"});
  EXPECT_EQ(outcome.code, 3) << outcome;
  for (const char* line :
       {"s.json:7:29: /constraints/0/where: the mesh has no set 'x00' (did you mean 'x0'?)",
        "s.json:8:29: /constraints/1/where: the selection contains no node",
        "s.json:9:38: /loads/0/where: the selection contains no boundary face",
        "s.json:12:7: /events/0/cut/faces/1: the mesh has no element 99",
        "s.json:13:24: /events/1/when/where: the mesh has no node with id 777",
        "s.json:14:26: /events/1/pierce/where: the mesh has no set 'y9'",
        "s.json:15:55: /output/probes/at/0/where: the mesh has no node with id 1000",
        "--set '/models/0/region={\"ids\": [99]}': /models/0/region: the mesh has no element with "
        "id 99",
        "\n8 mistakes in s.json"})
    EXPECT_TRUE(outcome.says(line)) << line << outcome;
}

// What other programs run with all the same: a misspelt model or parameter, values
// out of range, nothing to run on.
TEST_F(BadScenes, WhatOthersRunWithAllTheSame) {
  const BadValue values[] = {
      {"/models/0/model=tm-fauer", 4, "tm-faure"},
      {"/models/0/parameters/young=5", 3, "unknown key"},
      {"/models/0/parameters/Nu=0.3", 3, "did you mean 'nu'"},
      {"/models/0/parameters/E=-5000", 3, "must be > 0 Pa, is -5000 Pa"},
      {"/models/0/parameters/E=abc", 3, "must be a number (Pa)"},
      {"/models/0/parameters/nu=0.7", 3, "< 0.5, is 0.7"},
      {"/models/0/parameters/nu=0.5", 3, "< 0.5, is 0.5"},
      {"/models/0/parameters/quadrature=gauss3", 3, "did you mean 'gauss2'"},
      {"/models/0/parameters/rho=0", 3, "> 0 kg/m^3"},
      {"/constraints=[{\"fix\": \"xyz\", \"where\": {\"ids\": [99]}}]", 3, "99"},
      {"/constraints=[{\"fix\": \"xyz\", \"where\": {\"set\": \"x2\"}}]", 3, "x2"},
      {R"(/initial_motion=[{"where": "all"}])", 3, "needs 'velocity'"},
      {R"(/initial_motion=[{"where": "all", "velocity": [1, 0]}])", 3,
       "/initial_motion/0/velocity"},
      {R"(/initial_motion=[{"where": "all", "velocity": [1, 0, 0], "centre": [0, 0, 0]}])", 3,
       "that of a 'spin'"},
      {R"(/initial_motion=[{"where": {"set": "x2"}, "spin": [1, 0, 0]}])", 3, "x2"},
      {R"(/initial_motion=[{"where": "all", "speed": [1, 0, 0]}])", 3, "speed"},
      {R"(/foundations=[{"where": {"set": "x0"}}])", 3, "needs 'normal' or 'tangential'"},
      {R"(/foundations=[{"where": {"set": "x0"}, "normal": -1}])", 3, "/foundations/0/normal"},
      {R"(/foundations=[{"where": {"ids": [1]}, "normal": 1}])", 3, "no boundary face"},
      {R"(/loads=[{"force": [1, 0, 0], "where": "all", "profile": {"along": [0, 0, 1],
          "values": [[0, 1], [1, 0]]}}])",
       3, "is only allowed with 'traction' and 'pressure'"},
      {R"(/loads=[{"pressure": 1, "where": "all", "profile": {"along": [0, 0, 1],
          "values": [[1, 1], [1, 0]]}}])",
       3, "larger coordinate than the pair before"},
      {R"(/loads=[{"pressure": 1, "where": "all", "profile": {"along": [0, 0, 0],
          "values": [[0, 1], [1, 0]]}}])",
       3, "/loads/0/profile/along"},
      {R"(/foundations=[{"normal": 1}])", 3, "/foundations/0: 'where' is missing"},
      {"/constraints=[{\"fix\": \"xyz\", \"where\": {\"sphere\": {\"centre\": [9, 9, 9], "
       "\"radius\": 1}}}]",
       3, "/constraints/0/where"},
      {"/solver/dt=0", 3, "must be > 0 s"},
      {"/solver/dt=-1e-3", 3, "must be > 0 s"},
      {"/solver/end=0", 3, "> 0 s"},
      {"/solver/integrator=newmarck", 3, "did you mean 'newmark'"},
      {"/solver/integrator=static", 3, "replace it by \"static\": {}"},
      {"/solver={\"integrator\": \"implicit-euler\", \"end\": 1}", 3,
       "'dt' must be a number (s) for"},
      {"/solver={\"integrator\": \"newmark\", \"end\": 1, \"step_error\": 1e-12}", 3, ">= 1e-09"},
      {"/solver={\"integrator\": \"newmark\", \"end\": 1, \"dt\": 0.1, \"step_error\": 1e-3}", 3,
       "is only used with \"dt\": \"auto\""},
      {"/solver={\"integrator\": \"newmark\", \"end\": 1, \"safety\": 0.5}", 3, "use 'step_error'"},
      {"/solver={\"end\": 1, \"step_error\": 1e-3}", 3, "choose \"velocity-verlet\""},
      {"/solver={\"integrator\": \"implicit-euler\", \"dt\": 0.1, \"end\": 1, \"budget\": {}}", 3,
       "is empty; give \"iterations\""},
      {"/solver={\"integrator\": \"implicit-euler\", \"end\": 1, \"budget\": {\"iterations\": 3}}",
       3, "by the accuracy that you need"},
      {"/solver={\"dt\": 0.001, \"end\": 1, \"budget\": {\"iterations\": 3}}", 3,
       "is only used by \"implicit-euler\""},
      {"/solver={\"integrator\": \"xpbd\", \"dt\": 0.001, \"end\": 1, \"softness\": 0.1}", 3,
       "is only used with \"dt\": \"auto\""},
      {"/solver={\"end\": 1, \"softness\": 0.1}", 3, "is only used by \"xpbd\""},
      {"/solver={\"end\": 1, \"compensate\": true}", 3, "is only used by \"xpbd\""},
      {"/solver={\"static\": {}, \"dt\": 0.1}", 3, "cannot be combined with"},
      {"/solver={\"static\": {\"frames\": 0}}", 3, "/solver/static/frames"},
      {"/solver={\"static\": {\"steps\": 3}}", 3, "unknown key"},
      {"/solver={\"static\": {\"free_pieces\": \"holt\"}}", 3, "did you mean 'hold'"},
      {"/solver={\"static\": {\"path\": \"arclength\"}}", 3, "did you mean 'arc-length'"},
      {"/solver={\"static\": {\"path\": \"arc-length\", \"free_pieces\": \"hold\"}}", 3,
       "cannot be combined with \"free_pieces\""},
      {"/solver={\"static\": {}}", 3, "is free to move and turn in every direction"},
      {"/models=[]", 3, "at least one model"},
      {R"(/models/-={"model": "tie", "parameters": {"stiffness": 1e6}})", 3,
       "'between' is missing"},
      {R"(/models/0/between=["all", "all"])", 3, "acts in one, which \"region\" names"},
      {R"(/models/-={"model": "tie", "parameters": {"stiffness": 1e6}, "between": ["all"]})", 3,
       "must be two selections of elements [A, B], has 1"},
      {R"(/models/-={"model": "tie", "parameters": {"stiffness": 1e6}, "between": ["all", "all"]})",
       3, "is in both regions"},
      {R"(/models/-={"model": "tie", "parameters": {"stiffness": 1e6}, "region": "all", )"
       R"("between": [{"ids": [0]}, {"ids": [1]}]})",
       3, "is not allowed for a model that acts between two regions"},
      {"/mesh={}", 3, "exactly one of"},
      {"/mesh/file=nowhere.vtu", 3, "exactly one of"},
      {"/mesh={\"file\": \"nowhere.vtu\"}", 3, "no file"},
      {"/plugins=[\"nowhere.so\"]", 4, "nowhere"},
      {"/events=[{\"at\": 0.005, \"cut\": {\"faces\": [[0, 99]]}}]", 3, "99"},
      {"/events=[{\"at\": 0.005, \"cut\": {\"faces\": [[0, 7]]}}]", 3, "7"},
      {"solver/dt=1", 2, "/PATH/TO/KEY=VALUE"},
      {"/solver/dt/x=1", 2, "inside the number"}};
  for (const BadValue& value : values) {
    const Outcome outcome = scene("run", "", {value.set});
    EXPECT_EQ(outcome.code, value.code) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says(value.words)) << value.set << "\n" << outcome;
    EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << value.set;
    const Outcome checked = scene("check", "", {value.set});
    EXPECT_EQ(checked.code, value.code) << "check " << value.set << "\n" << checked;
  }
}

// Blades, seams and holes that cannot be: one message with the event's path, before the
// first step where it can be known, and no file is written then.
TEST_F(BadScenes, OperationsThatCannotBeMeant) {
  write("empty.obj", "");
  write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
  write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  write("noise.stl", std::string("\x7f\x45\x4c\x46\0\0\1", 7));
  write("blade.step", "ISO-10303-21;");
  const std::string surface = "/events=[{\"at\": 0, \"cut\": {\"surface\": {\"file\": \"";
  const BadValue surfaces[] = {
      {"empty.obj", 3, "/events/0/cut"},  {"points.obj", 3, "/events/0/cut"},
      {"quad.obj", 3, "/events/0/cut"},   {"nan.obj", 3, "/events/0/cut"},
      {"line.obj", 3, "/events/0/cut"},   {"noise.stl", 3, "/events/0/cut"},
      {"blade.step", 3, "/events/0/cut"}, {"nowhere.obj", 3, "/events/0/cut/surface/file"}};
  for (const BadValue& value : surfaces) {
    for (const char* command : {"run", "check"}) {
      const Outcome outcome = scene(command, "", {surface + value.set + "\"}}}]"});
      EXPECT_EQ(outcome.code, value.code) << command << ' ' << value.set << "\n" << outcome;
      EXPECT_TRUE(outcome.says(value.words)) << value.set << "\n" << outcome;
      EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << value.set;
    }
  }
  const BadValue values[] = {
      {"{\"at\": -1, \"pierce\": {\"where\": \"all\"}}", 3, "/events/0/at: must be >= 0 s"},
      {"{\"at\": 0, \"pierce\": {\"where\": {\"ids\": [99]}}}", 3,
       "/events/0/pierce/where: the mesh has no element with id 99"},
      {"{\"at\": 0, \"suture\": {\"faces\": [[0, 99]]}}", 3,
       "/events/0/suture/faces/0: the mesh has no element 99"},
      {"{\"at\": 0, \"suture\": {\"where\": {\"set\": \"B\"}}}", 3, "/events/0/suture/where"},
      {"{\"at\": 0, \"tear\": {\"by\": \"elongation\", \"above\": 1, \"where\": {\"sphere\": "
       "{\"centre\": [9, 9, 9], \"radius\": 1}}}}",
       3, "/events/0/tear/where: the selection contains no element"},
      {"{\"when\": {\"where\": {\"set\": \"B\"}, \"of\": \"velocity\", \"above\": 1}, \"suture\": "
       "{}}",
       3, "/events/0/when/where"}};
  for (const BadValue& value : values) {
    for (const char* command : {"run", "check"}) {
      const Outcome outcome = scene(command, "", {std::string("/events=[") + value.set + "]"});
      EXPECT_EQ(outcome.code, value.code) << command << ' ' << value.set << "\n" << outcome;
      EXPECT_TRUE(outcome.says(value.words)) << value.set << "\n" << outcome;
      EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << value.set;
    }
  }
}

// What shows only on the way is skipped, and the run goes on.
TEST_F(BadScenes, OperationsThatFailOnTheWayAreSkipped) {
  const BadValue values[] = {
      {R"({"at": 0.005, "pierce": {"where": "all"}})", 0,
       "t = 0.005 s: /events/0: pierce would remove all 8 remaining elements; nothing was removed. "
       "Make the selection smaller; the event is skipped"},
      {R"({"at": 0.005, "grasp": {"name": "grip", "where": {"sphere":
          {"centre": [9, 9, 9], "radius": 1}}}})",
       0, "/events/0/grasp/where: selects no node of the deformed body"},
      {R"({"at": 0.005, "grasp": {"name": "grip", "where": {"sphere":
          {"centre": [9, 9, 9], "radius": 1}}}}, {"at": 0.007, "release": "grip"})",
       0, "/events/1/release: nothing named 'grip' holds a node at that time"},
      {R"({"every": 1, "tear": {"by": "principal-strain", "above": 1e-9, "most": 0.1}})", 0,
       "/events/0/tear: would tear"}};
  const std::string moving = R"(, "gravity": [0, -9.8, 0],
    "constraints": [{"fix": "xyz", "where": {"set": "x0"}}], "events": [)";
  for (const BadValue& value : values) {
    const Outcome outcome = scene("run", moving + value.set + "]");
    EXPECT_EQ(outcome.code, 0) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says(value.words)) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says("event skipped") || outcome.says("events skipped")) << outcome;
  }
  const Outcome stopped =
      scene("run", moving + values[1].set + "]", {"/solver/on_failure=\"stop\""});
  EXPECT_EQ(stopped.code, 3) << stopped;
  const Outcome wrong = scene("check", "", {"/solver/on_failure=\"halt\""});
  EXPECT_TRUE(wrong.says("/solver/on_failure: must be one of 'skip', 'stop'")) << wrong;
}

// Or it stops the run, if the scene says so; the frames before it stay whole.
TEST_F(BadScenes, OperationsThatFailOnTheWayLoseNothing) {
  const std::string moving = R"(, "gravity": [0, -9.8, 0],
    "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
    "output": {"directory": "o", "every_steps": 1}, "events": [)";
  const BadValue values[] = {
      {R"({"at": 0.005, "pierce": {"where": "all"}, "on_failure": "stop"})", 3,
       "t = 0.005 s: /events/0: pierce would remove all 8 remaining elements"},
      {R"({"at": 0.005, "remove_islands": {"below": 100}, "on_failure": "stop"})", 3,
       "/events/0: remove_islands would remove all 8 remaining elements"},
      {R"({"at": 0.005, "tear": {"by": "principal-strain", "above": 1e-9, "most": 0.1},
          "on_failure": "stop"})",
       5, "/events/0/tear: would tear"},
      // Two corner cubes are gone, and sides that face across their places are to be sewn:
      // an element between them would be folded.
      {R"({"at": 0.005, "pierce": {"where": {"ids": [0, 7]}}},
          {"at": 0.005, "suture": {"faces": [[1, 6]]}, "on_failure": "stop"})",
       3, "/events/1/suture/faces/0: elements 1 and 6 cannot be sewn: nodes "}};
  for (const BadValue& value : values) {
    std::filesystem::remove_all(folder() / "o");
    const Outcome outcome = scene("run", moving + value.set + "]");
    EXPECT_EQ(outcome.code, value.code) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says(value.words)) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says("nothing was")) << value.set << "\n" << outcome;
    const std::string list = read("o/run.pvd");
    for (const char* frame : {"frame_0000.vtu", "frame_0004.vtu"}) {
      EXPECT_NE(list.find(frame), std::string::npos) << list;
      EXPECT_NE(read(std::string("o/") + frame).find("</VTKFile>"), std::string::npos) << frame;
    }
    EXPECT_EQ(list.find("frame_0006"), std::string::npos) << list;
  }
}

// Far away, or with nothing to do: a warning, and the run continues.
TEST_F(BadScenes, OperationsWithoutEffectAreReported) {
  write("far.obj", "v 9 0 0\nv 9 1 0\nv 9 0 1\nf 1 2 3\n");
  const BadValue values[] = {
      {R"({"at": 0.005, "cut": {"surface": {"file": "far.obj"}}})", 0, "cut no face"},
      {R"({"cut": {"blade": {"path": [{"at": 0, "points": [[9, 0, 0], [9, 1, 0]]}]}}})", 0,
       "cut had no effect in the whole run"},
      {R"({"at": 0.005, "pierce": {"path": [[9, 0, 0], [9, 1, 0]], "radius": 0.5}})", 0,
       "removed no element"},
      {R"({"at": 0.005, "tear": {"by": "elongation", "above": 1}})", 0, "tore no face"},
      {R"({"every": 2, "tear": {"by": "elongation", "above": 1}})", 0,
       "tear had no effect in the whole run"},
      {R"({"at": 0, "pierce": {"where": {"ids": [0]}}}, {"at": 0.005, "cut": {"faces": [[0, 1]]}})",
       0, "1 of the faces was removed with an element, the first between elements 0 and 1"},
      {R"({"at": 0, "cut": {"faces": [[0, 1]]}}, {"at": 0.005, "cut": {"faces": [[0, 1]]}})", 0,
       "1 of the faces has already been cut"},
      {R"({"at": 0.005, "suture": {}})", 0, "no cut face is open"},
      {R"({"at": 0.005, "suture": {"faces": [[0, 1]]}})", 0, "already share a face"},
      {R"({"at": 0.005, "suture": {"between": ["all", "all"], "gap": 0.01}})", 0,
       "no face of one side is within the gap"},
      {R"({"at": 0, "pierce": {"where": {"ids": [0, 7]}}}, {"at": 0.005, "suture":
          {"between": [{"ids": [1, 2]}, {"ids": [4, 5, 6]}], "gap": 0.9}})",
       0, "2 pairs of faces stay open"},
      {R"({"at": 0.005, "remove_islands": {"below": 3}})", 0, "removed no island"}};
  for (const BadValue& value : values) {
    const Outcome outcome = scene("run", std::string(", \"events\": [") + value.set + "]");
    EXPECT_EQ(outcome.code, 0) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says(value.words)) << value.set << "\n" << outcome;
    EXPECT_TRUE(outcome.says("1 warning")) << value.set << "\n" << outcome;
  }
}

TEST_F(BadScenes, PluginsThatAreNone) {
  write("text.so", "this is no library");
  const Outcome text = scene("run", ", \"plugins\": [\"text.so\"]");
  EXPECT_EQ(text.code, 4) << text;
  EXPECT_TRUE(text.says("text.so")) << text;
}

TEST_F(BadScenes, OverlappingModelsShareElementsAndGapsAreReported) {
  const Outcome gap = scene("run", "",
                            {"/models/0/region={\"half_space\": {\"point\": [0.5, 0, 0], "
                             "\"normal\": [1, 0, 0]}}"});
  // Elements without a model have no mass: nothing can be said of their motion.
  EXPECT_EQ(gap.code, 3) << gap;
}

TEST_F(BadScenes, ModesThatDoNotExist) {
  const std::string plugin = std::string(R"(, "plugins": [")") + TEST_PLUGINS + R"(/mistakes.so"])";
  struct Case {
    std::string more;
    std::vector<std::string> arguments;
    std::string words;
  };
  const Case cases[] = {
      {"", {"--count", "82"}, "the body has 81 free components"},
      {R"(, "constraints": [{"fix": "xyz", "where": "all"}])", {}, "every node is prescribed"},
      {R"(, "gravity": [0, -1, 0])", {"--at", "equilibrium"}, "constrain it, or use --at rest"},
      {plugin,
       {"--set", R"(/models/0={"model": "mistakes", "parameters": {"how": "nothing"}})"},
       "modes need the derivatives of all forces, and "}};
  for (const Case& bad : cases) {
    scene("check", bad.more);
    std::vector<std::string> arguments{"modes", "s.json"};
    arguments.insert(arguments.end(), bad.arguments.begin(), bad.arguments.end());
    const Outcome outcome = suture(arguments);
    EXPECT_EQ(outcome.code, 3) << outcome;
    EXPECT_TRUE(outcome.says(bad.words)) << outcome;
    EXPECT_FALSE(std::filesystem::exists(folder() / "out")) << outcome;
  }
}

// Values of parameters that are neither numbers nor fit.
TEST_F(BadScenes, ValuesThatDifferFromElementToElement) {
  struct Case {
    const char *set, *where, *words;
  };
  const Case cases[] = {
      {"/models/0/parameters/E={\"aray\": \"m\"}", "/models/0/parameters/E", "'array'"},
      {"/models/0/parameters/E={\"array\": 3}", "/E/array", "must be a string"},
      {"/models/0/parameters/E={\"array\": \"m\"}", "/E: ", "the mesh has no arrays"},
      {"/models/0/parameters/E={\"regions\": []}", "/E/regions", "is empty"},
      {"/models/0/parameters/E={\"regions\": [{\"region\": \"all\", \"value\": -1}]}",
       "/E/regions/0/value", "must be > 0 Pa"},
      {"/models/0/parameters/E={\"regions\": [{\"region\": {\"ids\": [0]}, \"value\": 1}]}",
       "/E: ", "is in no region"},
      {R"(/models/0={"model": "mss-baudet",
        "parameters": {"E": 1e5, "rho": 1, "nu": {"array": "m"}}})",
       "/models/0/parameters/nu", "must be the same in all elements"},
      {"/models/0/parameters/quadrature={\"array\": \"m\"}", "/quadrature", "must be one of"},
      {"/models/0/start={\"mas\": 3}", "/models/0/start", "no attribute that a scene sets"}};
  for (const Case& bad : cases) {
    const Outcome outcome = scene("check", "", {bad.set});
    EXPECT_EQ(outcome.code, 3) << bad.set << '\n' << outcome;
    EXPECT_TRUE(outcome.says(bad.where) && outcome.says(bad.words)) << bad.set << '\n' << outcome;
  }
}

}  // namespace
}  // namespace suture::testing
