// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/stability/trial.hpp"

namespace suture::test {

/// A scene that a run of is stopped. Its output folder is "out".
struct Case {
  std::string name;  ///< "cut-3"
  Json scene;
  std::map<std::string, std::string> files{};  ///< beside the scene
  bool skips = true;                           ///< not --no-skip
  std::string reports{};                       ///< what some message of the run must contain
};

/// Scenes of a kind.
struct Kind {
  std::string name;
  unsigned stops = 1, stops_full = 8;
  std::function<Case(Random&, unsigned index, std::uint64_t seed)> make;
};

/// Those of docs/scenes, those of the stability suite, and those that it lacks.
std::vector<Kind> all_kinds();
std::vector<Kind> own_kinds();

/// Bodies of some blocks of vertices, with operations and checkpoints; for several processes.
Case divided(Random& random, unsigned index);

/// A body of boxes and sheared elements that is cut, of some blocks of vertices, with this solver.
Case solved(const std::string& name, const Json& solver);

/// Frames, tables and fields of any kind.
void add_output(Json& scene, Random& random);
/// Writes scene.json and its files.
void write_case(const Case& what, const std::filesystem::path& folder);

}  // namespace suture::test
