// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "kernel/scene/json_document.hpp"
#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

using Commands = Program;

TEST_F(Commands, HelpAndVersionAreNoErrors) {
  for (const char* option : {"--help", "-h"}) {
    const Outcome help = suture({option});
    EXPECT_EQ(help.code, 0) << help;
    for (const char* command :
         {"run", "live", "check", "explain", "modes", "sweep", "fit", "replay", "models",
          "check-model", "new-model", "describe", "schema", "mesh"}) {
      EXPECT_TRUE(help.out.find(command) != std::string::npos) << command << help;
      const Outcome page = suture({command, "--help"});  // what all have in common is said once
      EXPECT_EQ(page.code, 0) << page;
      EXPECT_FALSE(page.says("Exit codes")) << page;
    }
    EXPECT_TRUE(help.says("Exit codes:")) << help;
  }
  const Outcome version = suture({"--version"});
  EXPECT_EQ(version.code, 0) << version;
  EXPECT_EQ(version.out.find("suture "), 0u) << version;
  EXPECT_TRUE(suture({"run", "--help"}).says("--set")) << suture({"run", "--help"});
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Without a command, it leads to a first run: literally.
TEST_F(Commands, TheGuideLeadsToAFirstRun) {
  const Outcome guide = suture({});
  EXPECT_EQ(guide.code, 0) << guide;
  const Outcome made = suture({"new-scene", "beam.json"});
  EXPECT_EQ(made.code, 0) << made;
  for (const char* step : {"suture new-scene beam.json", "suture run beam.json"})
    EXPECT_TRUE(guide.says(step)) << step << guide;
  EXPECT_TRUE(guide.says("suture plot out/beam") && made.says("suture plot out/beam")) << made;
  const Outcome run = suture({"run", "beam.json"});
  EXPECT_EQ(run.code, 0) << run;
  EXPECT_TRUE(std::filesystem::exists(folder() / "out/beam/run.pvd"));
  const Outcome again = suture({"new-scene"});
  EXPECT_EQ(again.code, 2) << again;
  EXPECT_TRUE(again.says("beam.json exists already")) << again;
}

/// What bash proposes for the last of some words.
std::string completed(const std::filesystem::path& folder, const std::string& words) {
  const std::string script = "cd '" + folder.string() + "' && export PATH='" +
                             std::filesystem::path(SUTURE_PROGRAM).parent_path().string() +
                             "':$PATH && suture completion bash >c.bash && . ./c.bash && "
                             "COMP_WORDS=(" +
                             words +
                             ") && COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) "
                             "&& _suture && echo \"${COMPREPLY[*]}\" >reply";
  EXPECT_EQ(
      std::system(
          ("bash -euc '" + std::regex_replace(script, std::regex("'"), "'\\''") + "'").c_str()),
      0);
  std::ifstream reply(folder / "reply");
  std::string text;
  std::getline(reply, text);
  return text;
}

TEST_F(Commands, BashCompletesCommandsOptionsChoicesAndModels) {
  EXPECT_EQ(completed(folder(), "suture ex"), "explain");
  EXPECT_EQ(completed(folder(), "suture mesh in"), "info");
  EXPECT_EQ(completed(folder(), "suture mesh generate b"), "box");
  EXPECT_EQ(completed(folder(), "suture run --o"), "--output");
  EXPECT_EQ(completed(folder(), "suture run s.json --no"), "--no-skip");
  EXPECT_EQ(completed(folder(), "suture modes --at e"), "equilibrium");
  EXPECT_EQ(completed(folder(), "suture describe tm"), "tm-faure");
  EXPECT_EQ(completed(folder(), "suture run s"), "");  // files, by bash itself
}

TEST_F(Commands, TheManualAndZshHaveEveryCommandAndOption) {
  const Outcome manual = suture({"man"}), zsh = suture({"completion", "zsh"});
  EXPECT_EQ(manual.code + zsh.code, 0) << manual << zsh;
  EXPECT_EQ(zsh.out.find("#compdef suture\n"), 0u);
  for (const char* words :
       {".SS suture mesh generate box", ".B \\-\\-check\\-plugins", ".SH EXIT STATUS"})
    EXPECT_TRUE(manual.says(words)) << words << manual;
  for (const char* words :
       {"'suture mesh generate box'", "'--check-plugins:", "compadd rest equilibrium"})
    EXPECT_TRUE(zsh.says(words)) << words << zsh;
  for (const std::string& line : lines_of(manual.out))  // what groff would take for a request
    if (line.starts_with(".") || line.starts_with("'")) {
      EXPECT_TRUE(std::regex_match(line, std::regex("\\.(TH|SH|SS|TP|B|I)( .*)?"))) << line;
    }
}

struct WrongCommand {
  std::vector<std::string> arguments;
  const char* words;
};

TEST_F(Commands, WrongUsageNamesWhatWasMeant) {
  const WrongCommand wrong[] = {
      {{"rnu", "s.json"}, "did you mean 'run'"},
      {{"run"}, "scene"},
      {{"run", "s.json", "--thread", "2"}, "did you mean '--threads'"},
      {{"run", "s.json", "--stet=/a=1"}, "did you mean '--set'"},
      {{"--quite", "run", "s.json"}, "did you mean '--quiet'"},
      {{"run", "s.json", "t.json"}, "unexpected argument"},
      {{"run", "-q", "-v", "s.json"}, "exclude"},
      {{"run", "s.json", "--threads=-1"}, "from 0 (as many as pay) to 1024, is '-1'"},
      {{"run", "s.json", "--threads", "-1"}, "'-1'"},
      {{"run", "s.json", "--threads", "two"}, "is 'two'"},
      {{"run", "s.json", "--threads", "2x"}, "is '2x'"},
      {{"run", "s.json", "--threads", "1025"}, "is '1025'"},
      {{"run", "s.json", "--threads", "99999999999999999999"}, "to 1024"},
      {{"modes", "s.json", "--count", "0"}, "--count must be a whole number from 1 to 10000"},
      {{"modes", "s.json", "--count", "ten"}, "is 'ten'"},
      {{"modes", "s.json", "--at", "equilibrum"}, "did you mean 'equilibrium'"},
      {{"modes"}, "scene"},
      {{"sweep"}, "study"},
      {{"fit"}, "study"},
      {{"compare", "a"}, "runs: At least 2 required"},
      {{"compare", "a", "b", "c", "d"}, "runs: At Most 3 required"},
      {{"plot"}, "what is required"},
      {{"plot", "a.obj", "b.obj"}, "a.obj: a mesh, a surface or a scene is drawn alone"},
      {{"sweep", "s.json", "--jobs", "0"}, "--jobs must be a whole number from 1 to 10000"},
      {{"fit", "s.json", "--jobs", "0"}, "--jobs must be a whole number from 1 to 10000"},
      {{"mesh"}, "subcommand"},
      {{"mesh", "inof", "a.vtu"}, "did you mean 'info'"},
      {{"mesh", "generate", "box", "a.vtu", "--size", "1", "1", "--cells", "1", "1", "1"},
       "--size"},
      {{"mesh", "info", "a.vtu", "--scale", "-1"}, "--scale"}};
  for (const WrongCommand& use : wrong) {
    const Outcome outcome = suture(use.arguments);
    EXPECT_EQ(outcome.code, 2) << use.words << outcome;
    EXPECT_TRUE(outcome.says(use.words)) << use.words << outcome;
    EXPECT_TRUE(outcome.out.empty()) << outcome;
  }
}

TEST_F(Commands, AnInstructionSetThatNobodyKnowsIsNamed) {
  setenv("SUTURE_ISA", "avx1024", 1);
  for (const char* command : {"--version", "models"}) {
    const Outcome outcome = suture({command});
    EXPECT_EQ(outcome.code, 2) << outcome;
    EXPECT_TRUE(outcome.says("SUTURE_ISA is 'avx1024'; set it to avx512, avx2 or base")) << outcome;
  }
  setenv("SUTURE_ISA", "base", 1);
  EXPECT_TRUE(suture({"--version"}).says("instruction set base"));
  unsetenv("SUTURE_ISA");
  EXPECT_TRUE(suture({"--help"}).says("SUTURE_ISA=avx512|avx2|base"));
}

TEST_F(Commands, ThreadsThatDoNotPayAreReported) {
  const Outcome small = scene("run", "", {"/output=false", "/solver/threads=2"});
  EXPECT_TRUE(small.says("1 of 2 threads used") && small.says("1 thread)")) << small;
  const Outcome one = scene("run", "", {"/output=false", "/solver/threads=1"});
  EXPECT_FALSE(one.says("used")) << one;
  const Outcome large = scene("run", "",
                              {"/output=false", "/solver/threads=2", "/mesh/box/cells=[20,20,20]",
                               "/solver/dt=1e-4", "/solver/end=2e-4"});
  EXPECT_TRUE(large.says("2 threads)")) << large;
  EXPECT_FALSE(large.says("used")) << large;
}

TEST_F(Commands, ListsAndDescribesModels) {
  const Outcome list = suture({"models"});
  EXPECT_EQ(list.code, 0) << list;
  EXPECT_TRUE(list.says("tm-faure") && list.says("mss-baudet")) << list;
  const Outcome model = suture({"describe", "mss-baudet"});
  EXPECT_EQ(model.code, 0) << model;
  for (const char* words : {"E Pa: ", "required", "number > -0.25 and < 0.5", "true or false",
                            "default false", "source: ", "MIT"}) {
    EXPECT_TRUE(model.says(words)) << words << model;
  }
  const Outcome solid = suture({"describe", "tm-faure"});
  EXPECT_TRUE(solid.says("number > 0; required; may differ from element to element")) << solid;
  EXPECT_FALSE(solid.says("jacobian") || solid.says("constants")) << solid;
  for (const char* wrong : {"tm-fuare", "faure", "TMFaure"}) {
    const Outcome unknown = suture({"describe", wrong});
    EXPECT_EQ(unknown.code, 4) << unknown;
    EXPECT_TRUE(unknown.says("did you mean 'tm-faure'?")) << unknown;
  }
}

// tests/house/schema.py compares it with scenes.
TEST_F(Commands, PrintASchemaWithTheParametersOfAllModels) {
  const Outcome outcome = suture({"schema"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const JsonValue schema = parse_json(outcome.out, "schema");
  const auto at = [](const JsonValue& object, std::string_view key) -> const JsonValue& {
    const auto found = std::ranges::find(object.members, key, &JsonMember::key);
    return found == object.members.end() ? object : found->value;
  };
  const JsonValue& rules = at(at(at(schema, "$defs"), "model"), "allOf");
  std::set<std::string> models;
  for (const JsonValue& rule : rules.items) {
    const JsonValue& when = at(at(at(at(rule, "if"), "properties"), "model"), "const");
    models.insert(when.text);
    if (when.text != "tm-faure") continue;
    const JsonValue& parameters = at(at(at(rule, "then"), "properties"), "parameters");
    EXPECT_EQ(at(parameters, "required").items.size(), 3u);
    const JsonValue& young = at(at(parameters, "properties"), "E");
    EXPECT_EQ(at(young, "description").text, "Young's modulus, Pa");
    EXPECT_EQ(at(at(young, "anyOf").items.at(0), "exclusiveMinimum").number, 0);
  }
  EXPECT_TRUE(models.contains("tm-faure") && models.contains("mss-baudet"));
  for (const char* internal : {"inverse_jacobian", "constants"})
    EXPECT_EQ(outcome.out.find(internal), std::string::npos) << internal;
}

// A terminal obeys what a name holds: neither one of a file nor of a plugin reaches it raw.
TEST_F(Commands, NamesWithControlCharactersAreEscaped) {
  const std::string name = "\x1b[2J\nsuture: error: \xff\u202e";
  const std::string shown = R"(\x1b[2J\nsuture: error: \xff\u202e)";
  write("m.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"" + name.substr(0, 4) +
            name.substr(5) +
            "\"\n$EndPhysicalNames\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n"
            "6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n1\n"
            "1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n");
  const Outcome info = suture({"mesh", "info", "m.msh"});
  EXPECT_TRUE(info.says(R"("\x1b[2Jsuture: error: \xff\u202e": 1)")) << info;
  const std::string json = R"("\u001b[2J\nsuture: error: \u202e")";
  const std::string of_json = R"(\x1b[2J\nsuture: error: \u202e)";
  for (const std::string& mistake :
       {R"(, "constraints": [{"fix": "xyz", "where": {"set": )" + json + "}}]", ", " + json + ": 1",
        R"(, "output": {"fields": [)" + json + "]}", R"(, "loads": [)" + json + "]"}) {
    const Outcome outcome = scene("check", mistake);
    EXPECT_EQ(outcome.code, 3) << outcome;
    EXPECT_TRUE(outcome.says(of_json)) << outcome;
    EXPECT_FALSE(outcome.says("\x1b")) << outcome;
  }
  const Outcome usage = suture({"check", name});
  EXPECT_TRUE(usage.says(shown)) << usage;
  EXPECT_FALSE(usage.says("\x1b")) << usage;
  setenv("SUTURE_PLUGIN_PATH", TEST_PLUGINS, 1);
  const Outcome plugin = suture({"describe", "moody"});
  unsetenv("SUTURE_PLUGIN_PATH");
  EXPECT_TRUE(plugin.says("Fails \\x1b[5mfor a while")) << plugin;
  EXPECT_FALSE(plugin.says("\x1b")) << plugin;
}

TEST_F(Commands, MeshesAreMadeConvertedAndMeasured) {
  const Outcome made = suture(
      {"mesh", "generate", "box", "a.vtu", "--size", "1", "0.5", "0.25", "--cells", "4", "2", "1"});
  EXPECT_EQ(made.code, 0) << made;
  for (const char* format : {"b.vtk", "c.mesh", "d.msh"}) {
    const Outcome converted = suture({"mesh", "convert", "a.vtu", format, "--scale", "2"});
    EXPECT_EQ(converted.code, 0) << converted;
    const Outcome info = suture({"mesh", "info", format});
    EXPECT_EQ(info.code, 0) << info;
    for (const char* words : {"30 points, 8 hexahedra", "[0, 0, 0] to [2, 1, 0.5] m", "30 vertices",
                              "(28 on the boundary)", "1 island", "volume: 1 m^3"}) {
      EXPECT_TRUE(info.says(words)) << words << info;
    }
  }
  const Outcome unknown = suture({"mesh", "convert", "a.vtu", "a.xyz"});
  EXPECT_EQ(unknown.code, 2) << unknown;
}

TEST_F(Commands, SurfacesAreFilled) {
  write("cube.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  const Outcome filled = suture({"mesh", "voxelize", "cube.obj", "--cells", "1000", "-o", "f.vtu"});
  EXPECT_EQ(filled.code, 0) << filled;
  const Outcome info = suture({"mesh", "info", "f.vtu"});
  EXPECT_TRUE(info.says("1 island")) << info;
  EXPECT_FALSE(info.says("warning")) << info;

  const Outcome neither = suture({"mesh", "voxelize", "cube.obj", "-o", "f.vtu"});
  EXPECT_EQ(neither.code, 2) << neither;
  write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome open = suture({"mesh", "voxelize", "open.obj", "--cells", "9", "-o", "o.vtu"});
  EXPECT_EQ(open.code, 3) << open;
  EXPECT_TRUE(open.says("3 edges have a face on one side only")) << open;
  EXPECT_FALSE(std::filesystem::exists(folder() / "o.vtu"));
}

TEST_F(Commands, SurfacesAreFilledUpToThem) {
  write("cube.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  const Outcome filled = suture({"mesh", "fill", "cube.obj", "--edge", "0.13", "-o", "f.vtu"});
  EXPECT_EQ(filled.code, 0) << filled;
  EXPECT_TRUE(filled.says("elements that the surface crosses: ")) << filled;
  EXPECT_TRUE(std::filesystem::exists(folder() / "f.vtu"));
  // The surface that the elements hold is closed, and a little smaller.
  EXPECT_EQ(suture({"mesh", "fill", "cube.obj", "--edge", "0.13", "-o", "f.off"}).code, 0);
  const Outcome info = suture({"mesh", "info", "f.off"});
  EXPECT_TRUE(info.says("closed; volume: 0.9")) << info;

  EXPECT_EQ(suture({"mesh", "fill", "cube.obj", "-o", "g.vtu"}).code, 2);
  const Outcome format = suture({"mesh", "fill", "cube.obj", "--edge", "0.1", "-o", "g.msh"});
  EXPECT_EQ(format.code, 2) << format;
  EXPECT_TRUE(format.says("expected .vtu for the mesh")) << format;
  const Outcome large = suture({"mesh", "fill", "cube.obj", "--edge", "3", "-o", "g.vtu"});
  EXPECT_EQ(large.code, 3) << large;
  EXPECT_TRUE(large.says("has a corner inside the body of 1 x 1 x 1 m")) << large;
  EXPECT_FALSE(std::filesystem::exists(folder() / "g.vtu"));

  const auto checked = [&](const std::string& mesh) {
    return scene("check", "", {"/mesh=" + mesh});
  };
  const Outcome scene_of = checked(R"({"surface": "cube.obj", "cells": 100})");
  EXPECT_EQ(scene_of.code, 0) << scene_of;
  const Outcome no_size = checked(R"({"surface": "cube.obj"})");
  EXPECT_EQ(no_size.code, 3) << no_size;
  EXPECT_TRUE(no_size.says("/mesh: must have exactly one of 'cells', 'edge', has none")) << no_size;
  const Outcome both = checked(R"({"surface": "cube.obj", "cells": 9, "edge": 1})");
  EXPECT_TRUE(both.says("/mesh: must have exactly one of 'cells', 'edge', has")) << both;
  write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  const Outcome open = checked(R"({"surface": "open.obj", "cells": 9})");
  EXPECT_EQ(open.code, 3) << open;
  EXPECT_TRUE(open.says("/mesh/surface: ")) << open;
  EXPECT_TRUE(open.says("use \"repair\": true in /mesh to fill each hole")) << open;
}

TEST_F(Commands, SurfacesAreMeasuredAndTheirHolesNamed) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  write("closed.obj", points + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const Outcome closed = suture({"mesh", "info", "closed.obj", "--scale", "6"});
  EXPECT_EQ(closed.code, 0) << closed;
  for (const char* line : {"closed.obj: a surface of 4 points, 4 triangles, 1 component",
                           "bounding box: [0, 0, 0] to [6, 6, 6] m", "closed; volume: 36 m^3"})
    EXPECT_TRUE(closed.says(line)) << line << closed;
  write("open.obj", points + "f 1 3 2\nf 1 2 4\nf 1 4 3\n");
  const Outcome open = suture({"mesh", "info", "open.obj"});
  EXPECT_EQ(open.code, 0) << open;
  const char* hole = "a hole of 3 edges, 4.243 m around, at [0.333333, 0.333333, 0.333333] m";
  EXPECT_TRUE(open.says(hole)) << open;
  EXPECT_TRUE(open.says("not closed: 1 hole, 3 edges with a face on one side only")) << open;
  const Outcome refused = suture({"mesh", "voxelize", "open.obj", "-o", "m.vtu", "--cells", "9"});
  EXPECT_EQ(refused.code, 3) << refused;
  EXPECT_TRUE(refused.says(hole)) << refused;
}

TEST_F(Commands, CheckRunsNothing) {
  const Outcome good = scene("check", "");
  EXPECT_EQ(good.code, 0) << good;
  EXPECT_TRUE(good.says("valid")) << good;
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

TEST_F(Commands, ExplainReportsWhatIsSkippedAndCosts) {
  const Outcome text = scene("explain", "");
  EXPECT_EQ(text.code, 0) << text;
  for (const char* words : {"skipped", "cost", "steps: 10", "memory"}) {
    EXPECT_TRUE(text.says(words)) << words << text;
  }
  const Outcome json = suture({"explain", "--json", "s.json"});
  EXPECT_EQ(json.code, 0) << json;
  const JsonValue root = parse_json(json.out, "explain");
  EXPECT_EQ(root.find("steps")->natural, 10u);
  EXPECT_GT(root.find("decisions")->items.size(), 3u);
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

TEST_F(Commands, ArraysOfAMeshAreListedWithWhatReadsThem) {
  write("m.vtk",
        "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
        "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\n"
        "CELL_TYPES 1\n12\nCELL_DATA 1\nSCALARS modulus double\nLOOKUP_TABLE default\n1e5\n"
        "SCALARS age double 2\nLOOKUP_TABLE default\n1 2\n");
  const Outcome info = suture({"mesh", "info", "m.vtk"});
  EXPECT_TRUE(info.says("array of elements \"modulus\": 1 component, 100000 to 100000")) << info;
  EXPECT_TRUE(info.says("array of elements \"age\": 2 components, 1 to 2")) << info;
  const Outcome explained =
      scene("explain", "",
            {R"(/mesh={"file": "m.vtk"})", R"(/models/0/parameters/E={"array": "modulus"})",
             R"(/constraints=[{"fix": "xyz", "where": {"nearest": [0, 0, 0]}}])"});
  EXPECT_TRUE(
      explained.says("array 'modulus' of elements of the mesh: gives the values of "
                     "/models/0/parameters/E"))
      << explained;
  EXPECT_TRUE(explained.says("array 'age' of elements of the mesh: no value of the scene is read"))
      << explained;
}

// The text and the JSON of explain name the same decisions, each with a reason.
TEST_F(Commands, NoSkipLeavesNothingOut) {
  scene("explain", "");
  const auto skipped = [&](std::vector<std::string> arguments) {
    std::vector<std::string> subjects;
    const std::string json = suture(arguments).out;
    const JsonValue root = parse_json(json, "explain");
    for (const JsonValue& decision : root.find("decisions")->items) {
      EXPECT_FALSE(decision.find("reason")->text.empty());
      if (decision.find("skipped")->boolean) subjects.push_back(decision.find("subject")->text);
    }
    return subjects;
  };
  const std::vector<std::string> less = skipped({"explain", "--json", "s.json"}),
                                 all = skipped({"explain", "--json", "--no-skip", "s.json"});
  const Outcome text = suture({"explain", "s.json"}), run = suture({"run", "--no-skip", "s.json"});
  for (const std::string subject : {"edge ids", "face ids", "other fields"}) {
    EXPECT_EQ(std::count(less.begin(), less.end(), subject), 1) << subject;
    EXPECT_EQ(std::count(all.begin(), all.end(), subject), 0) << subject;
    EXPECT_TRUE(text.says(subject + ": ")) << text;
  }
  EXPECT_EQ(run.code, 0) << run;
}

TEST_F(Commands, ReplayRepeatsAJournal) {
  const std::string mesh =
      "suture-journal 1\npoints 12\n0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0\n"
      "0 0 1 1 0 1 2 0 1 0 1 1 1 1 1 2 1 1\n"
      "hexahedra 2\n0 1 3 4 6 7 9 10\n1 2 4 5 7 8 10 11\n";
  write("a.journal",
        mesh +
            "operations 5\ncut 1  8\nsew 1  8 24\npierce 2  0 1\n"
            "clone 2  0 0  sew 0  cut 0  absorb 0\nclone 1  0  sew 0  cut 0  absorb 0\n");
  const Outcome good = suture({"replay", "a.journal"});
  EXPECT_EQ(good.code, 0) << good;
  EXPECT_TRUE(good.says("operation 1: cut of 1 face; splits 4 vertices, 4 edges, 1 face; 2 isl"))
      << good;
  EXPECT_TRUE(good.says("operation 2: sew of 1 face; merges 4 vertices, 4 edges, 1 face; 1 isl"))
      << good;
  EXPECT_TRUE(good.says("operation 3: pierce of 1 element (1 impossible)")) << good;
  EXPECT_TRUE(good.says("operation 4: clone of 1 element, copies: 2")) << good;
  EXPECT_TRUE(good.says("operation 5: clone of 1 element, copies: 1: refused: element 0 does not"))
      << good;
  EXPECT_TRUE(good.says("a.journal: valid (5 operations on 4 elements")) << good;
  EXPECT_TRUE(suture({"-q", "replay", "a.journal"}).err.empty());

  write("b.journal", mesh + "operations 1\ncut 1  800\n");
  const Outcome damaged = suture({"replay", "b.journal"});
  EXPECT_EQ(damaged.code, 3) << damaged;
  EXPECT_TRUE(damaged.says("b.journal:9: dart 800")) << damaged;
  EXPECT_EQ(suture({"replay", "c.journal"}).code, 3);
}

TEST_F(Commands, CiteWhatASceneUses) {
  const Outcome force = suture({"cite", SUTURE_SCENES "/cutting-force.json"});
  EXPECT_EQ(force.code, 0) << force;
  EXPECT_TRUE(force.says("force of a blade")) << force;
  const Outcome arc = suture({"cite", SUTURE_SCENES "/arc-cut.json"});
  EXPECT_FALSE(arc.says("force of a blade")) << arc;
  EXPECT_TRUE(arc.says("elements of which only a part is material")) << arc;
}

}  // namespace
}  // namespace suture::testing
