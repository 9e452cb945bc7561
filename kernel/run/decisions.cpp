// SPDX-License-Identifier: GPL-3.0-or-later
//
// What was decided when a scene was compiled, in the order of the flow.
#include "kernel/run/decisions.hpp"

#include <sstream>

namespace suture {
namespace {

std::string count_text(std::size_t n, const char* one) {
  return std::to_string(n) + ' ' + one + (n == 1 ? "" : "s");
}

std::string reads_text(std::uint32_t reads) {
  std::string text;
  const auto add = [&](std::uint32_t bit, const char* word) {
    if (reads & bit) text += (text.empty() ? "" : ", ") + std::string(word);
  };
  add(SUTURE_READ_REST, "rest positions");
  add(SUTURE_READ_POSITION, "positions");
  add(SUTURE_READ_VELOCITY, "velocities");
  return text.empty() ? "nothing" : text;
}

void decide_plugins(const Scene& scene, PluginHost& host, std::vector<Decision>& list) {
  for (const ModelUse& use : scene.models) {
    const suture_plugin& plugin = host.plugin_of(*use.model);
    list.push_back({"plugin " + std::string(plugin.id), false,
                    std::string(plugin.version) + " from " +
                        host.file_of(*use.model).filename().string() + ", for model " +
                        use.model->id + " as '" + use.name + "'"});
  }
  list.push_back({"other plugins", true, "only those that the scene names are loaded"});
}

void decide_cells(World& world, std::vector<Decision>& list) {
  const CellComplex& complex = world.complex();
  list.push_back({"3-map", false,
                  count_text(complex.element_count(), "element") + ", " +
                      std::to_string(complex.count(0)) + " vertices, from " + world.mesh_source});
  const auto ids = [&](const char* subject, bool built, int dimension, const char* cells) {
    list.push_back({subject, !built,
                    built ? std::to_string(complex.count(dimension)) + " " + cells
                          : std::string("no model works on ") + cells});
  };
  ids("edge ids", complex.has_edges(), 1, "edges");
  ids("face ids", complex.has_faces(), 2, "faces");
}

void decide_columns(World& world, std::vector<Decision>& list) {
  for (const auto& instance : world.attributes.instances()) {
    for (int dimension = 1; dimension <= 3; ++dimension) {
      for (const Column& column : instance->table(dimension).columns) {
        list.push_back({"column " + instance->name() + "/" + column.spec().name,
                        column.is_constant(),
                        column.is_constant() ? "the same everywhere: stored once"
                                             : count_text(column.size(), "row")});
      }
    }
  }
}

void decide_functors(World& world, std::vector<Decision>& list) {
  for (const ForceLoop::Summary& functor : world.dynamics->forces().summary()) {
    std::string text = functor.reason;
    if (!functor.skipped) {
      text = count_text(functor.cells, "cell") + " in " + std::to_string(functor.batches) +
             " batches, " + count_text(functor.colours, "colour") + "; gathers " +
             reads_text(functor.reads);
    }
    list.push_back({"functor " + functor.instance + "/" + functor.functor, functor.skipped, text});
  }
  const unsigned threads = world.dynamics->forces().threads();
  list.push_back({"threads", threads == 1,
                  threads == 1
                      ? "one: more would not pay for a loop of this size, or the scene asks for one"
                      : std::to_string(threads) + " for the force loop"});
  list.push_back({"instruction set", false, std::string(world.dynamics->forces().isa())});
}

void decide_physics(const Scene& scene, World& world, std::vector<Decision>& list) {
  const bool weight = scene.gravity != Vec3{};
  list.push_back({"gravity", !weight,
                  weight ? "an acceleration in the integrator's pass" : "the scene has none"});
  list.push_back({"loads", world.dynamics->loads().empty(),
                  world.dynamics->loads().empty() ? "the scene has none"
                                                  : count_text(scene.loads.size(), "load")});
  list.push_back({"constraints", world.dynamics->constraints().empty(),
                  world.dynamics->constraints().empty()
                      ? "the scene has none"
                      : std::to_string(world.dynamics->constraints().vertex_count()) +
                            " vertices, a pass over their list"});
  list.push_back(
      {"events", scene.events.empty(),
       scene.events.empty() ? "the scene has none" : count_text(scene.events.size(), "cut")});
}

void decide_output(const Scene& scene, const Recorder& recorder, std::vector<Decision>& list) {
  if (!recorder.writes_frames()) {
    list.push_back({"writer", true, "the scene asks for no output"});
    return;
  }
  std::string fields;
  for (const FieldChoice& field : recorder.fields())
    fields += (fields.empty() ? "" : ", ") + field.name;
  list.push_back({"frames", false,
                  "to " + scene.output.directory.string() + ", with " +
                      (fields.empty() ? "no fields" : fields) + "; other fields are not computed"});
  list.push_back({"energies.csv", !recorder.writes_energies(),
                  recorder.writes_energies()
                      ? "every " + count_text(scene.output.energies_every, "step")
                      : "not asked for"});
  list.push_back({"probes.csv", !recorder.writes_probes(),
                  recorder.writes_probes()
                      ? "every " + count_text(scene.output.probes_every, "step")
                      : "not asked for"});
  list.push_back({"springs", !scene.output.springs,
                  scene.output.springs ? "a second file per frame" : "not asked for"});
}

}  // namespace

std::vector<Decision> decide(const Scene& scene, PluginHost& host, World& world,
                             const Recorder& recorder) {
  std::vector<Decision> list;
  decide_plugins(scene, host, list);
  decide_cells(world, list);
  decide_columns(world, list);
  decide_functors(world, list);
  decide_physics(scene, world, list);
  decide_output(scene, recorder, list);
  return list;
}

}  // namespace suture
