// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <csignal>
#include <regex>

#include "kernel/scene/json_document.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/apps/program.hpp"
#include "tests/run/csv_table.hpp"

namespace suture::testing {
namespace {

using Runs = Program;

std::size_t frame_count(const std::filesystem::path& folder) {
  std::size_t frames = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    frames += entry.path().extension() == ".vtu" ? 1 : 0;
  }
  return frames;
}

TEST_F(Runs, WriteFramesTablesAndASummary) {
  const Outcome run = scene("run", R"(, "gravity": [0, -9.8, 0],
    "output": {"directory": "o", "every_steps": 5, "energies": {"every_steps": 1},
               "probes": {"every_steps": 2, "at": [{"name": "top", "point": [0, 1, 0]}]}})");
  EXPECT_EQ(run.code, 0) << run;
  EXPECT_TRUE(run.says("10 steps") && run.says("3 frames") && run.says(".pvd")) << run;
  EXPECT_EQ(frame_count(folder() / "o"), 3u);
  const std::string energies = read("o/energies.csv"), probes = read("o/probes.csv");
  EXPECT_EQ(std::count(energies.begin(), energies.end(), '\n'), 12) << energies;
  EXPECT_EQ(std::count(probes.begin(), probes.end(), '\n'), 7) << probes;
}

TEST_F(Runs, TellHowTheyWereMade) {
  write("pull.csv", "t [s],u [m]\n0,0\n1,0.1\n");
  const std::string more = R"(, "constraints": [{"move": {"table": {"file": "pull.csv",
    "columns": {"time": "t", "x": "u"}}}, "where": {"set": "x1"}}])";
  EXPECT_EQ(scene("run", more, {"/output/directory=one", "/solver/threads=1"}).code, 0);
  const std::string text = read("one/provenance.json");
  const JsonValue all = parse_json(text, "provenance.json");
  EXPECT_EQ(all.find("files")->items.size(), 1u);
  EXPECT_EQ(all.find("files")->items[0].find("bytes")->natural, 22u);
  EXPECT_EQ(all.find("models")->items[0].find("id")->text, "tm-faure");
  // The scene that it holds gives the same run, with any threads in any folder.
  write("again.json", canonical_json(*all.find("scene")->find("text")));
  const Outcome again =
      suture({"run", "again.json", "--set", "/output/directory=two", "--threads", "3"});
  EXPECT_EQ(again.code, 0) << again;
  const auto without_name = [](std::string of) {
    const std::size_t name = of.find("\"file\": \"", of.find("\"scene\""));
    return of.erase(name, of.find(',', name) - name);
  };
  EXPECT_EQ(without_name(read("two/provenance.json")), without_name(text));
  write("pull.csv", "t [s],u [m]\n0,0\n1,0.2\n");
  EXPECT_EQ(suture({"run", "again.json", "--set", "/output/directory=two"}).code, 0);
  EXPECT_NE(without_name(read("two/provenance.json")), without_name(text));
}

TEST_F(Runs, WriteTablesWithoutFrames) {
  const Outcome run = scene("run", R"(, "output": {"directory": "o", "frames": false,
    "probes": {"at": [{"name": "top", "point": [0, 1, 0]}]}})");
  EXPECT_EQ(run.code, 0) << run;
  EXPECT_FALSE(run.says(".pvd")) << run;
  EXPECT_EQ(frame_count(folder() / "o"), 0u);
  const std::string probes = read("o/probes.csv");
  EXPECT_EQ(std::count(probes.begin(), probes.end(), '\n'), 12) << probes;
  const Outcome both = suture({"check", "s.json", "--set", "/output/fields=[]"});
  EXPECT_EQ(both.code, 3) << both;
  EXPECT_TRUE(both.says("/output/fields: is about frames, but \"frames\" is false")) << both;
}

TEST_F(Runs, SayWhatTheFunctorsCostIfAsked) {
  const Outcome verbose = scene("run", "", {"/output=false"});
  EXPECT_FALSE(verbose.says("ns per cell")) << verbose;
  const Outcome run = suture({"run", "-v", "s.json", "--set", "/output=false"});
  EXPECT_EQ(run.code, 0) << run;
  const std::regex cost(
      "tm-faure/parallelepipeds, force: [0-9]+ x 8 cells, [0-9.e+]+ ns per cell, "
      "[0-9.e-]+ % of the run\n");
  EXPECT_TRUE(std::regex_search(run.out, cost)) << run;
}

// Every name that the reader lets pass is one that the run can write.
TEST_F(Runs, WriteEveryFieldThatTheReaderKnows) {
  std::vector<std::string> known = standard_fields();
  known.insert(known.end(), stress_fields().begin(), stress_fields().end());
  std::string names = "\"stress\"";
  for (const std::string& name : known) names += ", \"" + name + "\"";
  const Outcome run =
      scene("run", ", \"output\": {\"directory\": \"o\", \"fields\": [" + names + "]}");
  EXPECT_EQ(run.code, 0) << run;
  const std::string frame = read("o/frame_0001.vtu");
  for (const std::string& name : known) {
    EXPECT_NE(frame.find("Name=\"" + name + "\""), std::string::npos) << name;
  }
  for (const char* component : {"ComponentName0=\"1\"", "ComponentName5=\"XZ\""})
    EXPECT_NE(frame.find(component), std::string::npos) << component;
}

TEST_F(Runs, ExplainNamesTheFieldsThatAreComputed) {
  const Outcome some = scene("explain", R"(, "output": {"fields": ["nodal_stress"],
      "probes": {"at": [{"name": "a", "where": "all", "fields": ["principal_strain"]}]}})");
  EXPECT_EQ(some.code, 0) << some;
  EXPECT_TRUE(some.says("with nodal_stress\n") && some.says("with principal_strain\n")) << some;
  EXPECT_TRUE(some.says("nodal_von_mises: not requested")) << some;
}

TEST_F(Runs, StressAtNodesNeedsAModelWithStress) {
  const Outcome run = scene("check", R"(, "output": {"fields": ["nodal_stress"],
      "probes": {"at": [{"name": "a", "where": "all", "fields": ["principal_strss"]}]}})",
                            {"/models/0/model=mss-baudet"});
  EXPECT_EQ(run.code, 3) << run;
  EXPECT_TRUE(
      run.says("/output/fields/0: 'nodal_stress' is computed from the element field "
               "'stress', which no model of this scene provides; use a model that does, "
               "such as tm-faure, or remove this name"))
      << run;
  EXPECT_TRUE(run.says("did you mean 'principal_strain'")) << run;
  const Outcome known = suture({"check", "s.json", "--set", "/output/fields=[\"nodal_stres\"]"});
  EXPECT_TRUE(known.says("did you mean 'nodal_stress'")) << known;
}

TEST_F(Runs, ValuesOfSpringsAreNoFieldsOfFramesOrProbes) {
  const Outcome run = scene("check", R"(, "output": {"fields": ["tension"],
      "probes": {"at": [{"name": "a", "where": "all", "fields": ["tension", "mas"]}]}})",
                            {"/models/0/model=mss-baudet"});
  EXPECT_EQ(run.code, 3) << run;
  const std::string words =
      ": 'tension' is a value on springs, not on nodes or elements; set \"springs\": true in "
      "/output to write it for every spring";
  EXPECT_TRUE(run.says("/output/fields/0" + words)) << run;
  EXPECT_TRUE(run.says("/output/probes/at/0/fields/0" + words)) << run;
  EXPECT_TRUE(run.says("/output/probes/at/0/fields/1: ") && run.says("did you mean 'mass'")) << run;
}

TEST_F(Runs, SpringsOfASceneWithoutThemAreRefused) {
  const Outcome run = scene("check", R"(, "output": {"springs": true})");
  EXPECT_EQ(run.code, 3) << run;
  EXPECT_TRUE(run.says("s.json:5:") && run.says("/output/springs: no model of this scene has"))
      << run;
  EXPECT_EQ(suture({"check", "s.json", "--set", "/models/0/model=mss-baudet"}).code, 0);
}

// The patch test: the map x -> x + 0.1 x e_x given at every node of a body of 2 x 2 x 2
// elements. F = diag(1.1, 1, 1), E_xx = 0.105, and with St Venant-Kirchhoff
// sigma_xx = F_xx^2 (lambda + 2 mu) E_xx / det F.
TEST_F(Runs, EveryNodeMayBePrescribed) {
  const Outcome run = scene("run", R"(, "constraints": [
      {"fix": "xyz", "where": {"set": "x0"}},
      {"move": {"translation": [0.05, 0, 0]}, "ramp": 0.5,
       "where": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}},
      {"move": {"translation": [0.1, 0, 0]}, "ramp": 0.5, "where": {"set": "x1"}}],
    "output": {"directory": "o",
               "probes": {"at": [{"name": "a", "where": "all", "fields": ["stress"]}]}})",
                            {"/solver/dt=auto", "/solver/end=1"});
  EXPECT_EQ(run.code, 0) << run;
  const double lambda = 1e5 * 0.3 / (1.3 * 0.4), mu = 1e5 / 2.6;
  const double stress = 1.1 * 1.1 / 1.1 * (lambda + 2 * mu) * 0.105;
  const test::CsvTable table(folder() / "o/probes.csv");
  EXPECT_NEAR(table.last("a stress xx [Pa]"), stress, 1e-9 * stress);
  const Outcome rest = suture({"run", "s.json", "--set", "/solver={\"until\": \"rest\"}"});
  EXPECT_EQ(rest.code, 0) << rest;
  EXPECT_TRUE(rest.says("every node is prescribed")) << rest;
}

TEST_F(Runs, QuietSaysNothingAndNoOutputWritesNothing) {
  write("unused", "");
  scene("run", "");
  const Outcome quiet = suture({"run", "-q", "s.json", "--set", "/output=false"});
  EXPECT_EQ(quiet.code, 0) << quiet;
  EXPECT_EQ(quiet.out + quiet.err, "") << quiet;
  std::filesystem::remove_all(folder() / "out");
  suture({"run", "s.json", "--set", "/output=false"});
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

TEST_F(Runs, CtrlCFinishesTheStepAndWritesAFrame) {
  scene("run", "");
  const Outcome run = interrupted(
      {"run", "s.json", "--set", "/solver/end=1e7", "--set", "/solver/max_steps=40000000000",
       "--set", "/output={\"directory\": \"o\", \"energies\": {\"every_steps\": 1000}}"},
      SIGINT, "o/energies.csv");
  EXPECT_EQ(run.code, 130) << run;
  EXPECT_TRUE(run.says("interrupted")) << run;
  EXPECT_EQ(frame_count(folder() / "o"), 2u);
}

TEST_F(Runs, FoldersThatCannotBeWritten) {
  write("file", "");
  const Outcome run = scene("run", ", \"output\": {\"directory\": \"file/inside\"}");
  EXPECT_EQ(run.code, 6) << run;
  EXPECT_TRUE(run.says("/file: cannot be made") && run.says("Not a directory")) << run;
}

// Standing still is stable at any step: gravity and a held side make it move.
constexpr const char* moving = R"(, "gravity": [0, -9.8, 0],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}], "output": {"directory": "o"})";

TEST_F(Runs, StepsThatAreTooLongWarnAndStop) {
  const Outcome run = scene("run", moving, {"/solver/dt=0.5", "/solver/end=200"});
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("warning") && run.says("stable")) << run;
  EXPECT_TRUE(run.says("step") && run.says("dt")) << run;
}

TEST_F(Runs, RestThatIsNotReachedIsAnError) {
  const Outcome run = scene(
      "run", moving, {"/solver={\"until\": \"rest\", \"max_steps\": 20, \"tolerance\": 1e-9}"});
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("20")) << run;
}

// A straight column at five times its Euler load balances, but does not stand.
TEST_F(Runs, AnUnstableEquilibriumIsReportedWithItsMode) {
  const std::vector<std::string> column{
      R"(/mesh={"box": {"size": [1, 0.1, 0.1], "cells": [10, 2, 2]}})",
      R"(/models/0/parameters={"E": 1e6, "nu": 0.3, "rho": 1000})", "/gravity=[0, 0, 0]",
      R"(/loads=[{"traction": [-1e4, 0, 0], "where": {"set": "x1"}, "ramp": 1}])",
      R"(/solver={"until": "rest"})"};
  const Outcome run = scene("run", moving, column);
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("unstable") && run.says("mode.pvd") && run.says("/solver/kick")) << run;
  EXPECT_NE(read("o/mode_0000.vtu").find("Name=\"unstable_mode\""), std::string::npos);
  EXPECT_EQ(frame_count(folder() / "o"), 3u) << "first and last, and the mode";
  std::vector<std::string> kicked = column;
  kicked.emplace_back("/solver/kick=1e-3");
  const Outcome buckled = scene("run", moving, kicked);
  EXPECT_EQ(buckled.code, 0) << buckled;
  EXPECT_TRUE(buckled.says("at rest") && buckled.says("displaced along the mode")) << buckled;
}

TEST_F(Runs, MoreStepsThanAllowedAreAnError) {
  const Outcome run = scene("run", moving, {"/solver/max_steps=3"});
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("3 steps") && run.says("/solver/max_steps")) << run;
}

// At the end it is back where it began, and gravity has given nothing on balance.
TEST_F(Runs, ABodyThatSwingsBackIsNoAlarm) {
  const Outcome run = scene("run", moving,
                            {R"(/mesh={"box": {"size": [0.125, 0.05, 0.025], "cells": [5, 2, 1]}})",
                             R"(/models/0/parameters={"E": 1e5, "nu": 0.3, "rho": 1000})",
                             R"(/constraints/0/where={"set": "z0"})", R"(/solver={"end": 0.02})"});
  EXPECT_EQ(run.code, 0) << run;
}

// Nothing acts on it: what moves is rounding.
TEST_F(Runs, ABodyWithoutLoadsStaysAsItIs) {
  const std::string mesh = R"(/mesh={"box": {"size": [1, 0.25, 0.25], "cells": [20, 5, 5]}})";
  for (const char* solver : {R"(/solver={"end": 1})", R"(/solver={"until": "rest"})"}) {
    const Outcome run = scene("run", "", {mesh, solver, "/solver/max_steps=1000"});
    EXPECT_EQ(run.code, 0) << run;
  }
}

// It turns inside out where the event would have stopped it.
TEST_F(Runs, ExplainBearsAForceThatAnEventWouldEnd) {
  const char* pulled = R"(, "gravity": [0, -1e5, 0],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}])";
  EXPECT_EQ(scene("run", pulled, {"/solver/end=1"}).code, 5);
  const Outcome explained = scene("explain", pulled, {"/solver/end=1"});
  EXPECT_EQ(explained.code, 0) << explained;
}

// Vertices on the blade's way have less mass behind it, and the step is shorter.
TEST_F(Runs, ExplainCountsTheStepsThatABladeTakes) {
  const std::string file = SUTURE_SCENES "/blade-sweep.json";
  const auto steps = [&](const std::vector<std::string>& sets) {
    std::vector<std::string> arguments{"explain", file, "--json", "--set", "/output=false"};
    arguments.insert(arguments.end(), sets.begin(), sets.end());
    const Outcome explained = suture(arguments);
    const auto at = explained.out.find("\"steps\": ");
    EXPECT_NE(at, std::string::npos) << explained;
    return at == std::string::npos ? 0 : std::stoi(explained.out.substr(at + 9));
  };
  EXPECT_GT(steps({}), steps({"--set", "/events=[]"}));
}

struct Cut {
  const char* what;
  const char* event;
  const char* words;
};

TEST_F(Runs, OddCutsAreDoneOrReported) {
  const Cut cuts[] = {
      {"meets no face",
       R"({"at": 0.005, "cut": {"plane": {"point": [9, 0, 0], "normal": [1, 0, 0]}}})", "no face"},
      {"at time 0", R"({"at": 0, "cut": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}})",
       "4 faces cut"},
      {"at the end",
       R"({"at": 0.01, "cut": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}})",
       "4 faces cut"},
      {"into single elements",
       R"({"at": 0.005, "cut": {"faces": [[0,1],[2,3],[4,5],[6,7],[0,2],[1,3],[4,6],[5,7],[0,4],[1,5],[2,6],[3,7]]}})",
       "12 faces cut"},
      {"a face twice at once", R"({"at": 0.005, "cut": {"faces": [[0,1],[1,0]]}})", "1 face cut"},
      {"a face twice in turn",
       R"({"at": 0.005, "cut": {"faces": [[0,1]]}}, {"at": 0.006, "cut": {"faces": [[0,1]]}})",
       "1 face cut"}};
  for (const Cut& cut : cuts) {
    const Outcome run = scene("run", std::string(moving) + ", \"events\": [" + cut.event + "]");
    EXPECT_EQ(run.code, 0) << cut.what << "\n" << run;
    EXPECT_TRUE(run.says(cut.words)) << cut.what << "\n" << run;
  }
}

// Two of eight cubes go: frames before show them, frames after do not, and what is
// shown is whole; fields, springs and probes follow.
TEST_F(Runs, FramesLeaveOutWhatWasRemoved) {
  const Outcome run =
      scene("run", R"(, "gravity": [0, -9.8, 0],
    "events": [{"at": 0.005, "pierce": {"where": {"ids": [0, 7]}}}],
    "output": {"directory": "o", "every_steps": 5, "springs": true,
               "fields": ["displacement", "node_id", "element_id", "island", "strain"],
               "probes": {"every_steps": 5, "at": [{"name": "gone", "point": [0, 0, 0]},
                                                   {"name": "left", "point": [1, 0, 0]}]}})",
            {"/models/0/model=mss-baudet", "/output/fields=[\"island\", \"element_id\"]"});
  ASSERT_EQ(run.code, 0) << run;
  EXPECT_TRUE(run.says("removed 2 elements") && run.says("2 elements removed")) << run;
  EXPECT_TRUE(suture({"mesh", "info", "o/frame_0000.vtu"}).says("8 hexahedra"));
  const Outcome after = suture({"mesh", "info", "o/frame_0001.vtu"});
  EXPECT_EQ(after.code, 0) << after;
  EXPECT_TRUE(after.says("6 hexahedra") && after.says("25 points")) << after;
  const std::string probes = read("o/probes.csv");
  EXPECT_NE(probes.find("nan"), std::string::npos) << probes;
  EXPECT_TRUE(std::filesystem::exists(folder() / "o/springs_0002.vtu"));
}

// Every scene that we ship is good; what it is warned of, its header says.
TEST_F(Runs, ShippedScenesAreGood) {
  std::size_t scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SUTURE_SCENES)) {
    if (entry.path().extension() != ".json") continue;
    const Outcome outcome = suture({"check", entry.path().string()});
    EXPECT_EQ(outcome.code, 0) << entry.path() << "\n" << outcome;
    ++scenes;
  }
  EXPECT_GE(scenes, 6u);
}

}  // namespace
}  // namespace suture::testing
