// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/scene_reader.hpp"

#include <algorithm>

#include "kernel/base/checksum.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/input_file.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/scene/json_override.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture {
namespace {

using namespace scene_parts;

void read_version(ObjectReader& top, Scene& scene) {
  top.require("suture", "the version of the format, \"suture\": 2");
  const auto version = top.natural("suture", 1);
  if (version && *version > 2) {
    top.complain("suture", "is version " + std::to_string(*version) +
                               " of the scene format; this program reads versions 1 and 2");
  }
  scene.cuts_follow_blade = version == 2u;
}

// A ramp that is still rising when the run ends never shows its full value.
void warn_of_late_ramps(const Reading& reading) {
  const Scene& scene = reading.scene;
  if (!scene.solver.end) return;
  const auto check = [&](const TimeRamp& ramp, const std::string& what) {
    if (ramp.to > *scene.solver.end) {
      reading.diagnostics.warn(what +
                               ": the ramp ends after the run, so its full value is never reached");
    }
  };
  check(scene.gravity_ramp, "/gravity");
  for (const Load& load : scene.loads) check(load.ramp, load.where.path);
  for (const Constraint& constraint : scene.constraints) {
    check(constraint.ramp, constraint.where.path);
    if (!constraint.path.empty() && constraint.path.stations.back().at > *scene.solver.end)
      reading.diagnostics.warn(constraint.where.path +
                               ": the motion ends after the run, so its end is never reached");
  }
}

void read_top(const JsonValue& root, Reading& reading) {
  ObjectReader top(root, "", reading.mistakes);
  if (!top.is_object()) return;
  read_version(top, reading.scene);
  reading.scene.title = top.string("title").value_or("");
  top.string("$schema");  // for editors
  const char* source = "where the elements come from";
  const JsonValue* mesh = reading.scene.mesh.given ? top.find("mesh") : top.require("mesh", source);
  if (mesh != nullptr) read_mesh(*mesh, reading);
  read_sets(top, reading);
  read_models(top, reading);
  read_gravity(top, reading);
  read_constraints(top, reading);
  read_initial_motion(top, reading);
  read_foundations(top, reading);
  read_loads(top, reading);
  const JsonValue* solver = top.require("solver", "how to run, and for how long");
  if (solver != nullptr) read_solver(*solver, reading);
  if (!reading.scene.initial_motion.empty() && reading.scene.solver.integrator == "static")
    top.complain("initial_motion",
                 "an equilibrium has no velocity: remove it, or replace /solver/static by an "
                 "integrator");
  if (!reading.scene.foundations.empty() && reading.scene.solver.integrator == "xpbd")
    top.complain("foundations",
                 "\"xpbd\" knows stiffness of models only; choose another integrator");
  read_field_conditions(top, reading);
  read_contact(top, reading);
  reading.scene.is_divisible = top.boolean("divisible").value_or(false);
  read_events(top, reading);
  read_debris(top, reading);
  read_output(top.find("output"), reading);
  read_checkpoint(top.find("checkpoint"), reading);
  top.finish();
}

std::string read_text(const std::filesystem::path& file) {
  InputFile input(file);
  if (!input.problem().empty())
    throw IoError("the scene " + quote(file.string()) + ' ' + input.problem() +
                  (input.is_folder() ? "; give the scene file in it" : ""));
  return input.read_text();
}

void drop(JsonValue& object, std::string_view key) {
  std::erase_if(object.members, [&](const JsonMember& member) { return member.key == key; });
}

/// Drops a key of a member, and with its last key the member.
void drop(JsonValue& object, std::string_view member, std::string_view key) {
  const auto found = std::ranges::find(object.members, member, &JsonMember::key);
  if (found == object.members.end() || found->value.kind != JsonValue::Kind::object) return;
  drop(found->value, key);
  if (found->value.members.empty()) object.members.erase(found);
}

/// Without what changes no result: where it runs, where it writes, and when it is saved.
JsonValue what_counts(JsonValue root) {
  drop(root, "$schema");
  drop(root, "checkpoint");
  drop(root, "solver", "threads");
  drop(root, "output", "directory");
  return root;
}

/// Tells runs apart that may give different results: the scene without what changes none, and a
/// mesh that is not in the scene.
std::string hash_of(const std::string& text, const Mesh* mesh) {
  Checksum sum;
  sum.add(text);
  if (mesh == nullptr) return sum.text();
  const auto add = [&](const auto& values) { sum.add(std::as_bytes(std::span(values))); };
  add(mesh->points);
  add(mesh->hexahedra);
  for (const auto* sets : {&mesh->point_sets, &mesh->element_sets})
    for (const auto& [name, cells] : *sets) {
      sum.add(name);
      add(cells);
    }
  for (const MeshArray& array : mesh->arrays) {
    sum.add(array.name);
    add(array.values);
  }
  return sum.text();
}

/// The text of a scene with all sets; names the output folder, unless there is to be no output.
JsonValue parse_with(std::vector<std::string>& sets, const std::string& text,
                     const std::string& shown, const std::filesystem::path& output_folder) {
  JsonValue root = parse_json(text, shown);
  std::uint32_t number = 0;
  for (const std::string& set : sets) apply_override(root, set, ++number);
  const JsonValue* output = root.find("output");
  const bool writes = output == nullptr || output->kind == JsonValue::Kind::object;
  if (output_folder.empty() || !writes) return root;
  sets.push_back("/output/directory=" + output_folder.string());
  apply_override(root, sets.back(), ++number);
  return root;
}

/// The scene that `source` says; `shown` is the name of its text in messages.
Scene read_source(const SceneSource& source, const std::string& shown,
                  std::vector<std::string> sets, const ModelLookup& lookup,
                  Diagnostics& diagnostics, std::shared_ptr<const Mesh> mesh = {},
                  const std::filesystem::path& output_folder = {}) {
  const JsonValue root = parse_with(sets, source.text, shown, output_folder);
  Scene scene;
  scene.file = source.file;
  scene.source = {canonical_json(root), source.file, source.working_folder};
  scene.places = ScenePlaces(root, shown, sets);
  scene.text_that_counts = canonical_json(what_counts(root));
  scene.hash = hash_of(scene.text_that_counts, mesh.get());
  scene.mesh.given = std::move(mesh);
  Mistakes mistakes(shown, sets);
  Reading reading{scene,
                  source.file.parent_path(),
                  source.working_folder,
                  source.resumed_folder,
                  lookup,
                  mistakes,
                  diagnostics};
  read_top(root, reading);
  mistakes.throw_if_any();
  warn_of_late_ramps(reading);
  return scene;
}

}  // namespace

ModelLookup lookup_of(PluginHost& host) {
  return {[&](std::string_view id) -> const suture_model& { return host.model(id); },
          [&](const std::filesystem::path& plugin) { host.add_file(plugin); }};
}

Scene read_scene_text(std::string_view text, const std::filesystem::path& file,
                      const std::vector<std::string>& sets, const ModelLookup& lookup,
                      Diagnostics& diagnostics, std::shared_ptr<const Mesh> mesh,
                      const std::filesystem::path& output_folder) {
  const SceneSource source{
      std::string(text), std::filesystem::absolute(file), std::filesystem::current_path(), {}};
  return read_source(source, file.string(), sets, lookup, diagnostics, std::move(mesh),
                     output_folder);
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& sets,
                 const ModelLookup& lookup, Diagnostics& diagnostics,
                 std::shared_ptr<const Mesh> mesh, const std::filesystem::path& output_folder) {
  return read_scene_text(read_text(file), file, sets, lookup, diagnostics, std::move(mesh),
                         output_folder);
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& sets,
                 PluginHost& host, Diagnostics& diagnostics) {
  return read_scene(file, sets, lookup_of(host), diagnostics, nullptr);
}

Scene read_scene_source(const SceneSource& source, const std::vector<std::string>& sets,
                        const ModelLookup& lookup, Diagnostics& diagnostics) {
  return read_source(source, source.file.string() + " (as it was run)", sets, lookup, diagnostics);
}

Scene read_scene_source(const SceneSource& source, const std::vector<std::string>& sets,
                        PluginHost& host, Diagnostics& diagnostics) {
  return read_scene_source(source, sets, lookup_of(host), diagnostics);
}

Event read_event(std::string_view text, const std::string& name, const Scene& scene,
                 Diagnostics& diagnostics) {
  const JsonValue root = parse_json(text, name);
  Scene around;  // what events refer to
  around.models = scene.models;
  around.solver = scene.solver;
  around.contact = scene.contact;
  around.cuts_follow_blade = scene.added_cuts_follow_blade();
  Mistakes mistakes(name, {});
  Reading reading{
      around, scene.file.parent_path(), scene.source.working_folder, {}, {}, mistakes, diagnostics};
  ObjectReader object(root, "", mistakes);
  Event event = read_event_now(object, reading);
  mistakes.throw_if_any();
  return event;
}

std::vector<double> read_parameters(std::string_view text, const std::string& name,
                                    const suture_model& model, std::span<const double> now) {
  const JsonValue root = parse_json(text, name);
  std::vector<double> values(now.begin(), now.end());
  Mistakes mistakes(name, {});
  ObjectReader object(root, "", mistakes);
  read_changes(object, model, values);
  mistakes.throw_if_any();
  return values;
}

const std::vector<std::string>& standard_fields() {
  static const std::vector<std::string> fields{
      "displacement", "velocity",  "force",   "reaction",        "reaction_moment",
      "mass",         "fixed",     "node_id", "element_id",      "island",
      "model",        "hourglass", "strain",  "principal_strain"};
  return fields;
}

const std::vector<std::string>& stress_fields() {
  static const std::vector<std::string> fields{"principal_stress", "nodal_stress",
                                               "nodal_von_mises"};
  return fields;
}

const std::vector<std::string>& contact_fields() {
  static const std::vector<std::string> fields{"contact_force", "gap"};
  return fields;
}

}  // namespace suture
