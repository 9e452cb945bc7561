// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/resume/cases.hpp"

#include <algorithm>
#include <fstream>

#include "tests/mesh/temporary_folder.hpp"

namespace suture::test {
namespace {

namespace fs = std::filesystem;

constexpr int most_steps = 20000;  // some seconds of any trial

bool uses(const Json& scene, const char* model) {
  return std::ranges::any_of(scene["models"], [&](const Json& m) { return m["model"] == model; });
}

/// Every file of the folder that the scene may name.
Case documented(const fs::path& file) {
  Case result{file.stem(), Json::parse(read_text(file), nullptr, true, true)};
  const auto add_file = [&](const Json& reader, const char* key = "file") {
    if (!reader.contains(key)) return;
    const std::string name = reader[key];
    result.files[name] = read_text(file.parent_path() / name);
  };
  add_file(result.scene["mesh"]);
  add_file(result.scene["mesh"], "surface");
  if (result.scene.contains("contact"))
    for (const Json& obstacle : result.scene["contact"].value("obstacles", Json::array()))
      if (obstacle.contains("surface")) add_file(obstacle["surface"]);
  result.scene["output"]["directory"] = "out";
  return result;
}

/// A crack takes most of its time where it grows fast; its bands are resolved no worse here.
Json coarse_crack() {
  return Json::parse(
      R"({"mesh": {"box": {"cells": [16, 10, 1]}}, "solver": {"static": {"frames": 20}},
    "models": [{"model": "gradient-damage", "parameters":
      {"mu": 4e5, "K": 8e5, "rho": 1000, "Gc": 20, "l": 0.0075, "r": 1e-3}}]})");
}

std::vector<Kind> documented_kinds() {
  std::vector<Kind> kinds;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(SUTURE_SCENES))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::ranges::sort(files);
  for (const fs::path& file : files)
    kinds.push_back(
        {"scene_" + file.stem().string(), 1, 3, [file](Random& random, unsigned, std::uint64_t) {
           Case result = documented(file);
           if (file.stem() == "crack") result.scene.merge_patch(coarse_crack());
           Json& solver = result.scene["solver"];
           // Steps of "xpbd" are chosen by a softness, which no other scheme has, and the field of
           // "porous" follows implicit steps alone.
           const bool may_change = !solver.contains("static") &&
                                   solver.value("integrator", "") != "xpbd" &&
                                   !uses(result.scene, "porous");
           if (may_change && random.chance(0.3)) solver["integrator"] = "velocity-verlet";
           return result;
         }});
  return kinds;
}

Kind tried(const Family& family) {
  return {family.name, 1, 6, [&family](Random& random, unsigned index, std::uint64_t seed) {
            const auto number =
                static_cast<unsigned>(random.between(0, static_cast<double>(family.size)));
            const Trial trial = make_trial(family, number, seed);
            Case result{trial.name + '-' + std::to_string(index), trial.scene};
            if (!trial.mesh.empty()) result.files["mesh.mesh"] = trial.mesh;
            // Stable steps of a wild law may shrink without end; where this stops a run, it stops
            // the resumed ones, too.
            if (Json& solver = result.scene["solver"]; !solver.contains("static"))
              solver["max_steps"] = most_steps;
            result.skips = random.chance(0.7);
            add_output(result.scene, random);
            return result;
          }};
}

}  // namespace

void add_output(Json& scene, Random& random) {
  std::vector<std::string> fields{"displacement", "velocity",  "force",           "reaction",
                                  "mass",         "fixed",     "node_id",         "element_id",
                                  "island",       "hourglass", "principal_strain"};
  const bool springs = uses(scene, "mss-baudet");
  if (uses(scene, "tm-faure") && !springs)
    fields.insert(fields.end(), {"stress", "von_mises", "nodal_stress"});
  std::erase_if(fields, [&](const std::string& field) {
    return field != "displacement" && random.chance(0.6);
  });
  Json output{{"directory", "out"}, {"fields", fields}};
  output["every_steps"] = 1 + static_cast<int>(random.decades(30, 1000));
  output["compression"] = random.pick(std::vector<std::string>{"none", "lz4", "zlib"});
  if (random.chance(0.8))
    output["energies"]["every_steps"] = 1 + static_cast<int>(random.decades(1, 100));
  if (random.chance(0.6)) {
    output["probes"]["every_steps"] = 1 + static_cast<int>(random.decades(1, 100));
    output["probes"]["at"] = {
        {{"name", "some"}, {"where", "all"}, {"fields", fields}, {"of", "sum"}}};
  }
  if (springs && random.chance(0.5)) output["springs"] = true;
  if (random.chance(0.5)) output["cuts"] = true;
  scene["output"] = output;
}

void write_case(const Case& what, const fs::path& folder) {
  fs::create_directories(folder);
  for (const auto& [name, text] : what.files)
    std::ofstream(folder / name, std::ios::binary) << text;
  std::ofstream(folder / "scene.json") << what.scene.dump(1) << '\n';
}

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds = documented_kinds();
  for (const Family& family : families())
    if (family.name != "named" && !family.is_stress() && !family.needs_test_plugins)
      kinds.push_back(tried(family));
  for (Kind& kind : own_kinds()) kinds.push_back(std::move(kind));
  return kinds;
}

}  // namespace suture::test
