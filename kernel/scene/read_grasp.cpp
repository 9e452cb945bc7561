// SPDX-License-Identifier: GPL-3.0-or-later
//
// Grasps, and the names by which events release them and constraints.
#include <algorithm>
#include <array>

#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

// The obstacle that holds what it touches.
void read_obstacle(ObjectReader& grasp, const std::vector<Obstacle>& obstacles, Grasp& result) {
  std::vector<std::string> names;
  for (const Obstacle& obstacle : obstacles) names.push_back(obstacle.name);
  if (names.empty())
    grasp.complain("obstacle", "needs obstacles, and the scene has none; add /contact/obstacles");
  else
    result.obstacle = grasp.choice("obstacle", names);
  if (result.obstacle && obstacles[*result.obstacle].coupling)
    grasp.complain("obstacle",
                   "is compliant, and only obstacles that follow their path exactly "
                   "can hold; remove its 'coupling', or give 'where' and 'move'");
  result.reach = grasp.number("reach", Limits::positive("m"));
  if (grasp.find("move") != nullptr)
    grasp.complain("move", "is not allowed here: what an obstacle holds moves with it; remove it");
  if (grasp.find("components") != nullptr)
    grasp.complain("components",
                   "is not allowed here: an obstacle holds all components; remove it");
}

}  // namespace

std::string read_name(ObjectReader& object) {
  const std::string name = object.string("name").value_or("");
  if (object.find("name") != nullptr && !is_good_name(name))
    object.complain("name", "must consist of letters, digits and '_', '-', '.'; is " + quote(name));
  return name;
}

Grasp read_grasp(ObjectReader grasp, Reading& reading) {
  Grasp result;
  grasp.require("name", "a name, by which an event releases it");
  result.held.name = read_name(grasp);
  static const std::array<std::string, 2> kinds{"where", "obstacle"};
  const auto kind = grasp.one_of(kinds);
  if (kind == 0u)
    result.held.where =
        read_selection(*grasp.find("where"), grasp.path_of("where"), grasp.mistakes());
  if (kind == 1u) read_obstacle(grasp, reading.scene.contact.obstacles, result);
  if (grasp.find("move") != nullptr) {
    read_motion(grasp, reading, result.held);
  } else {
    result.held.components = read_components(grasp, "components");
    if (grasp.find("ramp") != nullptr) grasp.complain("ramp", "is only allowed with 'move'");
  }
  grasp.finish();
  return result;
}

void check_grasps(ObjectReader& top, const Scene& scene) {
  std::vector<std::string> names;
  const auto complain = [&](const char* list, const std::string& path, const std::string& text) {
    if (const JsonValue* value = top.find(list)) top.mistakes().add(value->at, path, text);
  };
  const auto add = [&](const char* list, const std::string& name, const std::string& path) {
    if (name.empty()) return;
    if (std::ranges::find(names, name) != names.end())
      complain(list, path + "/name", quote(name) + " is the name of another one; choose another");
    names.push_back(name);
  };
  for (const Obstacle& obstacle : scene.contact.obstacles) names.push_back(obstacle.name);
  const std::size_t tools = names.size();
  for (std::size_t i = 0; i < scene.constraints.size(); ++i)
    add("constraints", scene.constraints[i].name, "/constraints/" + std::to_string(i));
  for (const Event& event : scene.events)
    if (const auto* grasp = std::get_if<Grasp>(&event.what))
      add("events", grasp->held.name, event.path + "/grasp");
  names.erase(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(tools));
  for (const Event& event : scene.events) {
    const auto* release = std::get_if<Release>(&event.what);
    if (release && std::ranges::find(names, release->name) == names.end())
      complain("events", event.path + "/release",
               "no grasp or constraint is named " + quote(release->name) +
                   did_you_mean(release->name, names));
  }
}

}  // namespace suture::scene_parts
