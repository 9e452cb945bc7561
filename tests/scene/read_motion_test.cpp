// SPDX-License-Identifier: GPL-3.0-or-later
//
// Motion in phases: stations in the scene, and measured tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/mesh/temporary_folder.hpp"
#include "tests/scene/fake_model.hpp"

namespace suture::testing {
namespace {

std::string moved(const std::string& move) {
  return scene_with(R"(, "constraints": [{"where": {"set": "x1"}, "move": {)" + move + "}}]");
}

MotionPath path_of_table(const std::string& text, const std::string& table,
                         const std::string& more = "") {
  const TemporaryFolder folder;
  folder.write("pull.csv", text);
  Diagnostics diagnostics;
  const std::string move = R"("table": {"file": "pull.csv", )" + table + "}" + more;
  return read_scene_text(moved(move), folder / "s.json", {}, jelly_only(), diagnostics)
      .constraints.at(0)
      .path;
}

std::string error_of_table(const std::string& text, const std::string& table,
                           const std::string& more = "") {
  try {
    path_of_table(text, table, more);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadMotion, OfStationsInTheScene) {
  const Scene scene = read(moved(R"("path": [{"at": 0.1}, {"at": 0.5, "translation": [1, 2, 3],
      "angle": 90}, {"at": 2}], "rotation": {"axis": [1, 0, 0], "centre": [0, 0, 1]},
      "shape": "smooth")"));
  const Constraint& constraint = scene.constraints.at(0);
  ASSERT_EQ(constraint.path.stations.size(), 3u);
  EXPECT_EQ(constraint.path.stations[0].at, 0.1);
  const std::array<double, 4> there{1, 2, 3, std::numbers::pi / 2};
  EXPECT_EQ(constraint.path.stations[1].place, there);
  EXPECT_EQ(constraint.path.stations[2].place, (std::array<double, 4>{}));
  EXPECT_FALSE(constraint.path.is_linear);
  EXPECT_EQ(constraint.axis, (Vec3{1, 0, 0}));
  EXPECT_EQ(constraint.centre, (Vec3{0, 0, 1}));
}

TEST(ReadMotion, OfTables) {
  // Separators, comments, quotes, blanks, line ends of Windows, signs, units in names.
  const char* const texts[] = {
      "t,stroke,phi\n0,0,0\n500,1.5,90\n1000,-2,0\n1500,+3,0\n",
      "# machine 7\n\"t [ms]\" ; stroke [mm]; phi [deg]\r\n0;0;0\r\n500; 1.5 "
      ";90\r\n\r\n1000;-2;0\r\n"
      "1500;+3;0\r\n",
      "t\tstroke\tphi\n0\t0\t0\n5e2\t1.5\t90\n# pause\n1000\t-2\t0\n1500\t3\t0"};
  for (const std::string text : texts)
    for (const char* shape : {"linear", "smooth", "cubic"}) {
      const bool has_units = text.find('[') != std::string::npos;
      const std::string columns = R"("columns": {"time": "t", "y": "stroke", "angle": "phi"})",
                        units = R"(, "units": {"time": "ms", "length": "mm", "angle": "degrees"})";
      const MotionPath path = path_of_table(
          text, columns + (has_units ? "" : units),
          std::string(R"(, "shape": ")") + shape + R"(", "rotation": {"axis": [0, 0, 1]})");
      ASSERT_EQ(path.stations.size(), 4u) << text;
      EXPECT_DOUBLE_EQ(path.stations[3].at, 1.5);
      EXPECT_EQ(path.stations[1].place[0], 0);
      EXPECT_DOUBLE_EQ(path.stations[1].place[1], 1.5e-3);
      EXPECT_DOUBLE_EQ(path.stations[1].place[3], std::numbers::pi / 2);
      EXPECT_DOUBLE_EQ(path.stations[2].place[1], -2e-3);
      EXPECT_EQ(path.is_linear, std::string(shape) == "linear");
    }
}

TEST(ReadMotion, RelativeToTheFirstRow) {
  const MotionPath path = path_of_table("t [s],x [m]\n1,5\n2,7\n3,4\n",
                                        R"("columns": {"time": "t", "x": "x"}, "relative": true)");
  EXPECT_EQ(path.stations[0].place[0], 0);
  EXPECT_EQ(path.stations[1].place[0], 2);
  EXPECT_EQ(path.stations[2].place[0], -1);
}

TEST(ReadMotion, NamesWhatIsWrongInATable) {
  const std::string columns = R"("columns": {"time": "t", "x": "u"})";
  struct Bad {
    std::string text, table, words, more = "";
  };
  const Bad tables[] = {
      {"t [s],u [mm]\n0,0\n2,1\n1,2\n", columns, "pull.csv:4: the time is not later"},
      {"t [s],u [mm]\n0,0\n1,\n", columns, "pull.csv:3: column 'u [mm]': is empty"},
      {"t [s],u [mm]\n0,0\n1,a\n", columns, "'a' is not a finite number"},
      {"t [s],u [mm]\n0,0\n1,nan\n", columns, "'nan' is not a finite number"},
      {"t [s],u [mm]\n0,0\n1,1,5\n", columns, "pull.csv:3: has 3 cells, and the first row names 2"},
      {"t [s],u [mm]\n-1,0\n1,1\n", columns, "the time is negative"},
      {"t [s],u [mm]\n0,1\n1,1\n", columns, "\"relative\": true subtracts the first row"},
      {"t [s],u [mm]\n", columns, "has no rows of numbers"},
      {"t,u [mm]\n0,0\n1,1\n", columns, "column 't' has no unit"},
      {"t [s],u [inch]\n0,0\n1,1\n", columns, "has the unit 'inch', expected one of 'm'"},
      {"t [s],u [mm]\n0,0\n1,1\n", columns + R"(, "units": {"length": "m"})",
       "differs from the unit of column 'u [mm]'"},
      {"t [s],stroke [mm]\n0,0\n1,1\n", R"("columns": {"time": "t", "x": "strok"})",
       "no column 'strok' (did you mean 'stroke'?)", R"(, "shape": "smooth")"},
      {"t [s],u [mm]\n0,0\n", columns, "/table: has one row of numbers; a motion has at least two",
       R"(, "shape": "cubic")"},
      {"t [s],strokes [mm]\n0,0\n1,1\n", R"("columns": {"time": "t", "x": "stroke"})",
       "the file has no column 'stroke'"},
      {"t [s],u [mm]\n0,0\n1,1\n", R"("columns": {"time": "t"})",
       "names no column of displacements"},
      {"t [s],u [deg]\n0,0\n1,1\n", R"("columns": {"time": "t", "angle": "u"})", "has no axis"},
      {"t [s],u [mm]\n0,0\n1,1\n", columns, "\"cubic\" needs at least 4 stations; there are 2",
       R"(, "shape": "cubic")"}};
  for (const Bad& bad : tables) {
    const std::string error = error_of_table(bad.text, bad.table, bad.more);
    EXPECT_NE(error.find(bad.words), std::string::npos) << bad.text << error;
    EXPECT_NE(error.find("/constraints/0/move"), std::string::npos) << error;
    EXPECT_NE(error.find("\n1 mistake in"), std::string::npos) << error;
  }
}

TEST(ReadMotion, NamesWhatIsWrongInAPath) {
  const std::string stations = R"("path": [{"at": 0}, {"at": 1, "translation": [1, 0, 0]}])";
  const std::pair<std::string, const char*> paths[] = {
      {R"("path": [{"at": 0}])", "must have at least 2 stations"},
      {R"("path": [{"at": 1}, {"at": 1}])", "later than the previous"},
      {R"("path": [{"at": 0, "translation": [1, 0, 0]}, {"at": 1}])", "begins away from"},
      {stations + R"(, "translation": [1, 0, 0])", "/move/translation: unknown key"},
      {stations + R"(, "table": {})", "both 'path' and 'table'"},
      {R"("path": [{"at": 0}, {"at": 1, "angle": 5}])", "has no axis"}};
  for (const auto& [move, words] : paths) {
    const std::string error = error_of(moved(move));
    EXPECT_NE(error.find(words), std::string::npos) << move << '\n' << error;
  }
}

}  // namespace
}  // namespace suture::testing
