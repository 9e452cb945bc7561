// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs that fail, and runs that only appear to fail: what the program reports and what it leaves
// behind.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

class FailedRuns : public Program {
 protected:
  /// A scene of a block of 0.1 m elements, all but its mesh and model given.
  Outcome block(const std::string& size, const std::string& cells, const std::string& model,
                const std::string& rest) const {
    write("b.json", R"({"suture": 1, "mesh": {"box": {"size": )" + size + R"(, "cells": )" + cells +
                        "}},\n\"models\": [" + model + "],\n" + rest + "}\n");
    return suture({"run", "b.json"});
  }
  /// The line of a summary or a message that has these words.
  static std::string line_with(const Outcome& run, const std::string& words) {
    std::istringstream text(run.out + run.err);
    for (std::string line; std::getline(text, line);)
      if (line.find(words) != std::string::npos) return line;
    return "";
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder() / name); }
};

std::string tm(double young, double nu = 0.3, double rho = 1000) {
  std::ostringstream text;
  text << R"({"model": "tm-faure", "parameters": {"E": )" << young << ", \"nu\": " << nu
       << ", \"rho\": " << rho << "}}";
  return text.str();
}

const std::string held = R"({"fix": "xyz", "where": {"set": "x0"}})";

// ------------------------------------------------------- right runs that finish --

TEST_F(FailedRuns, SoftTissueHangsUnderItsOwnWeight) {
  const Outcome run = block("[0.3, 0.1, 0.1]", "[12, 4, 4]", tm(1e4, 0.25),
                            R"("gravity": [9.8, 0, 0], "constraints": [)" + held +
                                R"(], "solver": {"end": 0.4}, "output": {"directory": "o"})");
  EXPECT_EQ(run.code, 0) << run;
  EXPECT_FALSE(exists("o/failed.pvd"));
}

TEST_F(FailedRuns, PulledTissueFollowsItsStiffening) {
  const Outcome run =
      block("[1, 0.5, 0.5]", "[6, 3, 3]", tm(1e5), R"("constraints": [)" + held + R"(,
        {"move": {"translation": [0.4, 0, 0]}, "ramp": 2, "where": {"set": "x1"}}],
        "solver": {"until": "rest"}, "output": false)");
  EXPECT_EQ(run.code, 0) << run;
}

TEST_F(FailedRuns, ASuddenTractionIsBorne) {
  // True stress over rest area of a stretch s: E/2 (s^2 - 1) s; overshoots to about twice.
  const double s = 1.15, traction = 1e5 / 2 * (s * s - 1) * s;
  std::ostringstream loads;
  loads << R"("loads": [{"traction": [)" << traction << R"(, 0, 0], "where": {"set": "x1"}}],)";
  const Outcome run = block("[1, 0.25, 0.25]", "[12, 3, 3]", tm(1e5, 0),
                            R"("constraints": [)" + held + "]," + loads.str() +
                                R"("solver": {"end": 1}, "output": false)");
  EXPECT_EQ(run.code, 0) << run;
}

TEST_F(FailedRuns, ATwistByPrescribedRotationIsNoAlarm) {
  const Outcome run = block("[1, 0.25, 0.25]", "[16, 4, 4]", tm(4e5),
                            R"("constraints": [)" + held +
                                R"(,
        {"move": {"rotation": {"axis": [1, 0, 0], "angle": 15, "centre": [0, 0.125, 0.125]}},
         "ramp": 1, "where": {"set": "x1"}}], "solver": {"end": 1.2}, "output": false)");
  EXPECT_EQ(run.code, 0) << run;
  EXPECT_FALSE(run.says("warning")) << run;
}

TEST_F(FailedRuns, APullThatIsThenCutIsNoAlarm) {
  const Outcome run =
      block("[1, 1, 1]", "[8, 4, 4]", tm(3000, 0.25, 1), R"("constraints": [)" + held + R"(,
        {"move": {"translation": [0.1, 0, 0]}, "ramp": 0.3, "where": {"set": "x1"}}],
        "events": [{"at": 0.5, "cut": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}}],
        "solver": {"end": 0.8}, "output": false)");
  EXPECT_EQ(run.code, 0) << run;
  EXPECT_TRUE(run.says("2 islands")) << run;
}

TEST_F(FailedRuns, ShortMovesAreNoAlarm) {
  for (const char* ramp : {"0.02", "1e-6"}) {
    const Outcome run = block("[1, 0.5, 0.5]", "[4, 2, 2]", tm(1e5),
                              R"("constraints": [)" + held +
                                  R"(,
        {"move": {"translation": [0.02, 0, 0]}, "ramp": )" +
                                  ramp +
                                  R"(, "where": {"set": "x1"}}],
        "solver": {"end": 0.5}, "output": false)");
    EXPECT_EQ(run.code, 0) << ramp << run;
  }
}

TEST_F(FailedRuns, ASpinKeepsItsEnergyOrSaysSo) {
  const Outcome run = block("[0.5, 0.2, 0.2]", "[5, 2, 2]", tm(1e5), R"("constraints": [
        {"move": {"rotation": {"axis": [0.1, 0.3, 1], "angle": 180, "centre": [0.3, 0.1, 0.1]}},
         "ramp": 0.5, "where": {"set": "x0"}}],
        "events": [{"at": 0.45, "shape": "rest",
                    "pierce": {"where": {"box": {"min": [-1, -1, -1], "max": [0.11, 1, 1]}}}}],
        "solver": {"end": 30, "on_inversion": "warn"},
        "output": {"directory": "o", "energies": {"every_steps": 100}})");
  EXPECT_EQ(run.code, 0) << run;
  // The last row against the one after the event: 2 % at most without a word.
  std::istringstream table(read("o/energies.csv"));
  std::string line;
  std::vector<std::vector<double>> rows;
  std::getline(table, line);
  ASSERT_EQ(line.find("step"), line.find_first_not_of('"')) << line;
  while (std::getline(table, line)) {
    std::istringstream words(line);
    rows.emplace_back();
    for (std::string word; std::getline(words, word, ',');) rows.back().push_back(std::stod(word));
  }
  const double begin = 0.46;
  const auto first = std::ranges::find_if(rows, [&](const auto& row) { return row[1] > begin; });
  ASSERT_NE(first, rows.end());
  const double before = (*first)[3] + (*first)[4], after = rows.back()[3] + rows.back()[4];
  if (after > 1.02 * before) {
    EXPECT_TRUE(run.says("of the energy exchanged is unexplained")) << run;
  }
  EXPECT_LT(after, 1.1 * before);
}

// ------------------------------------------------------------- wrong runs that end --

const char* const falling = R"("gravity": [0, -9.8, 0], "constraints": [)";

TEST_F(FailedRuns, AFixedStepThatIsTooLongNeverFinishesWithOutputOrWithout) {
  for (const char* output : {"false", R"({"directory": "o"})"}) {
    const Outcome run =
        block("[1, 0.25, 0.25]", "[8, 2, 2]", tm(4e5),
              falling + held + R"(], "solver": {"dt": 0.03, "end": 60}, "output": )" + output);
    EXPECT_EQ(run.code, 5) << run;
    EXPECT_FALSE(run.says("finished")) << run;
    const std::string error = line_with(run, "set it to \"auto\"");
    EXPECT_NE(error.find("/solver/dt is 0.03 s"), std::string::npos) << run;
  }
  EXPECT_TRUE(exists("o/failed.pvd"));
}

TEST_F(FailedRuns, AutomaticStepsAreNeverAdvisedToBeAutomatic) {
  for (const char* force : {"1e300", "1e9"}) {
    const Outcome run = block("[0.2, 0.2, 0.2]", "[2, 2, 2]", tm(1e5),
                              R"("constraints": [)" + held + R"(], "loads": [{"force": [)" + force +
                                  R"(, 0, 0], "where": {"set": "x1"}}],
        "solver": {"end": 1}, "output": {"directory": "o"})");
    EXPECT_EQ(run.code, 5) << force << run;
    EXPECT_FALSE(run.says("finished")) << run;
    EXPECT_FALSE(run.says("\"auto\"")) << run;
    EXPECT_TRUE(run.says("load")) << "advice on loads: " << run;
  }
}

TEST_F(FailedRuns, AForceBeyondAllMeasureStopsAFixedStepToo) {
  const Outcome run = block("[0.2, 0.2, 0.2]", "[2, 2, 2]", tm(1e5),
                            R"("constraints": [)" + held +
                                R"(],
        "loads": [{"force": [1e300, 0, 0], "where": {"set": "x1"}}],
        "solver": {"dt": 1e-4, "end": 0.1}, "output": false)");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("finite")) << run;
}

// The element that failed has the number of one that is gone.
TEST_F(FailedRuns, APlaceIsThatOfTheCopyOfAnElementThatABladeHasDivided) {
  const Outcome run = block("[0.2, 0.2, 0.2]", "[2, 2, 2]", tm(1e5),
                            R"("constraints": [)" + held +
                                R"(],
        "events": [{"at": 0, "cut": {"along": "blade", "plane": {
          "point": [0.15, 0.1, 0.1], "normal": [1, 0.2, 0.1]}}}],
        "loads": [{"force": [1e300, 0, 0], "where": {"set": "x1"}}],
        "solver": {"dt": 1e-4, "end": 0.1}, "output": false)");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("the element is at (0.1")) << run;
}

TEST_F(FailedRuns, AnEndThatNoRunReachesStartsStepping) {
  const Outcome run = block("[0.2, 0.2, 0.2]", "[2, 2, 2]", tm(1e5),
                            R"("solver": {"end": 1e19, "max_steps": 50}, "output": false)");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("after 50 steps") && run.says("/solver/max_steps")) << run;
}

// ------------------------------------------------------------------ evidence --

std::string moody(const std::string& parameters) {
  return tm(1e5) + R"(, {"model": "moody", "name": "sutures", "parameters": {)" + parameters + "}}";
}

TEST_F(FailedRuns, ANumberThatIsNotFiniteNamesModelFunctorCellTimeAndPlace) {
  for (const char* dt : {"1e-4", "\"auto\""}) {
    const Outcome run =
        block("[0.2, 0.2, 0.2]", "[2, 2, 2]", moody(R"("how": "nan", "from": 0.0099)"),
              std::string(R"("plugins": [")") + TEST_PLUGINS + R"(/moody.so"], )" + falling + held +
                  R"(], "solver": {"end": 0.1, "dt": )" + dt +
                  R"(}, "output": {"directory": "o", "every": 0.001})");
    EXPECT_EQ(run.code, 5) << run;
    for (const char* words : {"sutures", "edge", "finite", "t = 0.0", "failed.pvd contains"})
      EXPECT_TRUE(run.says(words)) << words << run;
    EXPECT_TRUE(exists("o/failed_0000.vtu") && exists("o/failed_0001.vtu"));
    const std::string error = line_with(run, "suture: error");
    EXPECT_EQ(error.find("\"auto\""), std::string::npos) << error;
  }
}

TEST_F(FailedRuns, InvertedElementsAreMarkedInTheLastFrames) {
  const Outcome run =
      block("[0.4, 0.1, 0.1]", "[4, 1, 1]", tm(1e4), R"("constraints": [)" + held + R"(,
        {"move": {"translation": [-0.5, 0, 0]}, "ramp": 0.5, "where": {"set": "x1"}}],
        "solver": {"end": 1, "damping": 20}, "output": {"directory": "o", "compression": "none"})");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("inverted") && run.says(" m.") && run.says("t = 0.")) << run;
  EXPECT_TRUE(run.says("on_inversion")) << run;
  const std::string pvd = read("o/failed.pvd");
  EXPECT_NE(pvd.find("failed_0000.vtu"), std::string::npos) << pvd;
  EXPECT_NE(pvd.find("failed_0001.vtu"), std::string::npos) << pvd;
  for (const char* frame : {"o/failed_0000.vtu", "o/failed_0001.vtu"})
    EXPECT_NE(read(frame).find("Name=\"failure\""), std::string::npos) << frame;
  const Outcome borne =
      block("[0.4, 0.1, 0.1]", "[4, 1, 1]", tm(1e4).insert(1, R"("on_inversion": "warn", )"),
            R"("constraints": [)" + held + R"(,
        {"move": {"translation": [-0.5, 0, 0]}, "ramp": 0.5, "where": {"set": "x1"}}],
        "solver": {"end": 0.45, "damping": 20}, "output": false)");
  EXPECT_FALSE(borne.code == 5 && borne.says("on_inversion of the model")) << borne;
}

TEST_F(FailedRuns, EvidenceIsNotWrittenWithoutOutput) {
  const Outcome run = block("[0.2, 0.2, 0.2]", "[2, 2, 2]", moody(R"("how": "stop", "from": 0.01)"),
                            std::string(R"("plugins": [")") + TEST_PLUGINS + R"(/moody.so"], )" +
                                falling + held + R"(], "solver": {"end": 0.1}, "output": false)");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(run.says("the edges have had enough") && run.says("sutures")) << run;
  EXPECT_FALSE(run.says("shows")) << run;
  EXPECT_FALSE(exists("out"));
}

TEST_F(FailedRuns, ABodyWithAHoleIsShown) {
  const Outcome run = block("[0.4, 0.2, 0.2]", "[4, 2, 2]", tm(1e4),
                            R"("gravity": [900, 0, 0], "constraints": [)" + held +
                                R"(], "events": [{"at": 0, "pierce": {"where": {"ids": [6]}}}],
        "solver": {"end": 1}, "output": {"directory": "o"})");
  EXPECT_EQ(run.code, 5) << run;
  EXPECT_TRUE(exists("o/failed.pvd")) << run;
}

}  // namespace
}  // namespace suture::testing
