// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/inputs.hpp"

#include <algorithm>
#include <span>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/live/json_text.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

using Json = nlohmann::json;

constexpr std::size_t most_repeated = 200;  // characters of what was sent

struct Form {
  std::string_view name, text;
};
/// The forms of the inputs of a page ("do"), and of the values that "apply" takes beside events.
constexpr Form page_forms[] = {{"play", R"({"do": "play"})"},
                               {"pause", R"({"do": "pause"})"},
                               {"step", R"({"do": "step"})"},
                               {"reset", R"({"do": "reset"})"},
                               {"back", R"({"do": "back"}, {"do": "back", "to": ID})"},
                               {"remove_piece", R"({"do": "remove_piece"})"},
                               {"field", R"({"do": "field", "name": NAME})"},
                               {"speed", R"({"do": "speed", "value": NUMBER})"},
                               {"scene", R"({"do": "scene"})"},
                               {"checkpoint", R"({"do": "checkpoint"})"},
                               {"keep", R"({"do": "keep", "name": TEXT})"},
                               {"apply", R"({"do": "apply", "event": {...}})"},
                               {"aim", R"({"do": "aim"})"},
                               {"grab", R"({"do": "grab", "at": [x, y, z]})"},
                               {"take", R"({"do": "take", "tool": NAME, "at": [x, y, z]})"},
                               {"drag", R"({"do": "drag", "to": [x, y, z]})"},
                               {"let_go", R"({"do": "let_go"})"}};
constexpr Form value_forms[] = {
    {"move", R"({"move": {"grasp": NAME, "translation": [x, y, z], "during": SECONDS}})"},
    {"steer",
     R"({"steer": {"obstacle": NAME, "translation": [x, y, z], "rotation": [x, y, z], "during": SECONDS}})"},
    {"parameters", R"({"parameters": {"model": NAME, "values": {NAME: NUMBER}}})"},
    {"sweep", R"({"sweep": {"points": [[x, y, z], ...], "triangles": [[i, j, k], ...]}})"},
    {"gravity", R"({"gravity": [x, y, z]})"}};

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
  std::string what;
  try {
    const Json input = Json::parse(value);
    if (input.is_object() && input.size() == 1) {
      what = input.begin().key();
      const Json& how = input.begin().value();
      if (what == "move") return move(how, simulation);
      if (what == "steer") return steer(how, simulation);
      if (what == "parameters") return set_parameters(how, simulation, observer);
      if (what == "sweep") return void(simulation.apply(sweep_event(how), observer));
      if (what == "gravity") return set_gravity(how, simulation, observer);
    }
  } catch (const Json::exception&) {
    throw InputError(not_understood(value, what));
  }
  simulation.apply(read_event(value, "input", scene, diagnostics), observer);
}

std::string not_understood(const std::string& given, const std::string& name) {
  std::string_view form = R"(an object such as {"do": "step"})";
  for (const std::span<const Form> forms :
       {std::span<const Form>(page_forms), std::span<const Form>(value_forms)})
    for (const Form& known : forms)
      if (known.name == name) form = known.text;
  return "this input is not understood: " + given.substr(0, most_repeated) +
         (given.size() > most_repeated ? "..." : "") + "; expected " + std::string(form);
}

std::string similar_input(const std::string& name) {
  std::vector<std::string> names;
  for (const Form& known : page_forms) names.emplace_back(known.name);
  return did_you_mean(name, names);
}

}  // namespace suture
