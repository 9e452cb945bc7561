// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/inputs.hpp"

#include <algorithm>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/live/json_text.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

using Json = nlohmann::json;

/// Refuses keys that nothing reads.
void check_keys(const Json& object, const std::vector<std::string>& known) {
  for (const auto& [key, value] : object.items())
    if (std::ranges::find(known, key) == known.end())
      throw InputError("'" + key + "': unknown key" + did_you_mean(key, known));
}

void move(const Json& move, Simulation& simulation) {
  check_keys(move, {"grasp", "translation", "during"});
  simulation.move_grasp(move.at("grasp"), move.at("translation").get<Vec3>(), move.at("during"));
}

void steer(const Json& steer, Simulation& simulation) {
  check_keys(steer, {"obstacle", "translation", "rotation", "during", "at"});
  PoseTarget target{steer.contains("at") ? steer["at"].get<double>()
                                         : simulation.time() + steer.at("during").get<double>()};
  if (steer.contains("translation")) target.translation = steer["translation"].get<Vec3>();
  if (steer.contains("rotation")) target.rotation = steer["rotation"].get<Vec3>();
  simulation.steer(steer.at("obstacle"), target);
}

Instance& instance_named(const std::string& name, Simulation& simulation) {
  std::vector<std::string> names;
  for (const auto& instance : simulation.attributes().instances()) {
    if (instance->name() == name) return *instance;
    names.push_back(instance->name());
  }
  throw InputError("the scene has no model '" + name + "'" + did_you_mean(name, names));
}

void set_parameters(const Json& change, Simulation& simulation, Observer& observer) {
  check_keys(change, {"model", "values"});
  Instance& instance = instance_named(change.at("model"), simulation);
  const std::string values = json_text(change.at("values"));
  simulation.set_parameters(
      instance, read_parameters(values, "parameters of '" + instance.name() + "'", instance.model(),
                                instance.parameters()));
  observer.on_message(timed(simulation.time(), "model '" + instance.name() + "' has " + values));
}

void set_gravity(const Json& value, Simulation& simulation, Observer& observer) {
  simulation.set_gravity(value.get<Vec3>());
  observer.on_message(timed(simulation.time(), "gravity is " + json_text(value) + " m/s^2"));
}

TriangleSurface surface_of(const Json& sweep) {
  TriangleSurface surface{
      "the surface that the blade has swept", sweep.at("points").get<std::vector<Vec3>>(), {}};
  for (const auto& corners : sweep.at("triangles").get<std::vector<std::array<Json, 3>>>()) {
    Triangle& triangle = surface.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t corner = whole_number(corners[k], "a corner in 'sweep'");
      if (corner >= surface.points.size())
        throw InputError("a triangle of 'sweep' has corner " + std::to_string(corner) + ", but " +
                         std::to_string(surface.points.size()) + " points are given");
      triangle[k] = static_cast<Index>(corner);
    }
  }
  return surface;
}

/// A cut by triangles that the input itself holds.
Event sweep_event(const Json& sweep) {
  check_keys(sweep, {"points", "triangles", "along"});
  const std::string along = sweep.value("along", "faces");
  if (along != "faces" && along != "blade")
    throw InputError("'along' of 'sweep' is \"faces\" or \"blade\", not \"" + along + '"');
  CutSurface cut;
  cut.surface = std::make_shared<TriangleSurface>(surface_of(sweep));
  cut.along_blade = along == "blade";
  Event event;
  event.what = std::move(cut);
  event.path = "input";
  return event;
}

}  // namespace

void apply_input(const std::string& value, const Scene& scene, Simulation& simulation,
                 Observer& observer, Diagnostics& diagnostics) {
  try {
    const Json input = Json::parse(value);
    if (input.is_object() && input.size() == 1) {
      const std::string what = input.begin().key();
      const Json& how = input.begin().value();
      if (what == "move") return move(how, simulation);
      if (what == "steer") return steer(how, simulation);
      if (what == "parameters") return set_parameters(how, simulation, observer);
      if (what == "sweep") return void(simulation.apply(sweep_event(how), observer));
      if (what == "gravity") return set_gravity(how, simulation, observer);
    }
  } catch (const Json::exception& error) {
    throw InputError("this input is not understood: " + value + ": " + error.what());
  }
  simulation.apply(read_event(value, "input", scene, diagnostics), observer);
}

}  // namespace suture
