// SPDX-License-Identifier: GPL-3.0-or-later
//
// What was decided when a scene was compiled, in the order of the flow.
#include "kernel/run/decisions.hpp"

#include <algorithm>
#include <sstream>
#include <variant>

#include "kernel/base/escape.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/build/cell_values.hpp"
#include "kernel/contact/contact.hpp"
#include "kernel/geometry/solid_surface.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture {
namespace {

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
  list.push_back({"other plugins", true, "only plugins used by the scene are loaded"});
}

// Why something is done although the scene does not need it.
constexpr const char* no_skip = "not needed; done because of --no-skip";

void decide_cells(BuiltScene& built, std::vector<Decision>& list) {
  const CellComplex& complex = built.body().complex();
  list.push_back({"3-map", false,
                  count_text(complex.element_count(), "element") + ", " +
                      std::to_string(complex.count(0)) + " vertices, from " + built.mesh_source()});
  const auto& instances = built.body().attributes().instances();
  const auto ids = [&](const char* subject, int dimension, const char* cells) {
    const bool used = std::any_of(instances.begin(), instances.end(),
                                  [&](const auto& i) { return i->uses(dimension); });
    if (!used && built.skips())
      list.push_back({subject, true, std::string("no model works on ") + cells});
    else
      list.push_back(
          {subject, false,
           used ? std::to_string(complex.count(dimension)) + " " + cells : std::string(no_skip)});
  };
  ids("edge ids", 1, "edges");
  ids("face ids", 2, "faces");
}

/// JSON paths of the values that are read from an array of the mesh file.
std::string readers_of(const MeshArray& array, const Scene& scene, const BuiltScene& built) {
  std::string readers;
  for (const ModelUse& use : scene.models)
    for (const CellValues& values : use.values) {
      const bool of_elements = use.model->attributes[values.attribute].dimension == 3;
      if (!values.array.empty() && find_array(built.names().arrays, values, of_elements) == &array)
        readers += (readers.empty() ? "" : ", ") + values.path;
    }
  return readers;
}

void decide_arrays(const Scene& scene, const BuiltScene& built, std::vector<Decision>& list) {
  for (const MeshArray& array : built.names().arrays) {
    const std::string readers = readers_of(array, scene, built);
    list.push_back({"array " + quote(array.name) + " of " +
                        (array.of_elements ? "elements" : "points") + " of the mesh",
                    readers.empty(),
                    readers.empty() ? "no value of the scene is read from it"
                                    : "gives the values of " + readers});
  }
}

void decide_column(const Instance& instance, std::uint32_t attribute, std::vector<Decision>& list) {
  const suture_attribute& declared = instance.model().attributes[attribute];
  const std::string subject = "column " + instance.name() + "/" + declared.name;
  const Column* column = instance.column(attribute);
  if (!instance.needs(attribute))
    list.push_back({subject, true, "not read by any active functor: neither summed nor stored"});
  else if (column != nullptr && column->is_constant())
    list.push_back({subject, true, "the same everywhere: stored once"});
  else if (column != nullptr)
    list.push_back({subject, false, count_text(column->size(), "row")});
}

void decide_columns(BuiltScene& built, std::vector<Decision>& list) {
  for (const auto& instance : built.body().attributes().instances())
    for (std::uint32_t a = 0; a < instance->model().attribute_count; ++a)
      decide_column(*instance, a, list);
}

void decide_functor(const ForceLoop::Summary& functor, std::vector<Decision>& list) {
  const std::string subject = "functor " + functor.instance + "/" + functor.functor;
  if (functor.skipped) {
    list.push_back({subject, true, functor.reason});
    return;
  }
  list.push_back({subject, false,
                  count_text(functor.cells, "cell") + " in " + std::to_string(functor.batches) +
                      " batches, " + count_text(functor.colours, "colour") + "; gathers " +
                      reads_text(functor.reads)});
  const bool velocities = (functor.reads & SUTURE_READ_VELOCITY) != 0;
  if (!velocities)
    list.push_back({"velocities for " + subject, true, "it does not read velocities"});
}

std::string steps_of(const FieldEquation& field, const Dynamics& dynamics) {
  if (!dynamics.is_implicit())
    return "forward Euler after each step of the motion, in stable parts";
  const bool takes_turns =
      dynamics.is_solved() && field.feels_motion() && dynamics.body().models().reads_fields();
  const std::string when = takes_turns
                               ? ", in turns with the motion until both agree"
                               : (dynamics.is_static() ? "" : " before each step of the motion");
  return (dynamics.is_static() ? "its steady state at each equilibrium" : "backward Euler") + when;
}

void decide_functors(BuiltScene& built, std::vector<Decision>& list) {
  for (const ForceLoop::Summary& functor : built.body().models().summary())
    decide_functor(functor, list);
  for (const FieldEquation& field : built.body().fields()) {
    list.push_back({"field " + field.field().name, false, steps_of(field, built.dynamics())});
    for (const ForceLoop::Summary& functor : field.rates().summary()) decide_functor(functor, list);
  }
  const unsigned threads = built.body().models().threads();
  list.push_back(
      {"threads", threads == 1,
       threads == 1 ? "one: more would not help for a loop of this size, or the scene requests one"
                    : std::to_string(threads) + " for the force loop"});
  list.push_back({"instruction set", false, std::string(built.body().models().isa())});
}

void decide_integrator(const Scene& scene, BuiltScene& built, std::vector<Decision>& list) {
  if (built.dynamics().is_implicit()) {
    list.push_back(
        {"integrator", false,
         built.dynamics().is_static() ? "static equilibria by Newton's method"
         : built.dynamics().is_solved()
             ? scene.solver.integrator + ", implicit: Newton's method in every step"
         : built.dynamics().newton()
             ? scene.solver.integrator + ", implicit: one linearised step within its budget"
         : built.dynamics().compensates()
             ? "position based, one pass over cells that are stiffer by what it leaves out"
             : "position based, one pass over the cells in every step"});
    return;
  }
  if (scene.solver.integrator == "symplectic-euler") {
    list.push_back({"integrator", false, "symplectic Euler, first order in dt"});
    return;
  }
  for (const ForceLoop::Summary& functor : built.body().models().summary()) {
    if (functor.skipped || (functor.reads & SUTURE_READ_VELOCITY) == 0) continue;
    list.push_back({"integrator", false,
                    "velocity Verlet, first order in dt: functor " + functor.instance + "/" +
                        functor.functor + " reads velocities, which lag half a step"});
    return;
  }
  list.push_back({"integrator", false, "velocity Verlet, second order in dt"});
}

/// How "auto" chooses dt; a number is not worth a line.
void decide_step(const Scene& scene, std::vector<Decision>& list) {
  if (!scene.solver.step_error) return;
  std::ostringstream text;
  text << "chosen such that the error of each step is at most " << *scene.solver.step_error
       << " of the largest displacement so far"
       << (is_implicit(scene.solver.integrator) ? "" : ", and the step stable");
  list.push_back({"dt", false, text.str()});
}

void decide_physics(const Scene& scene, BuiltScene& built, std::vector<Decision>& list) {
  const bool weight = scene.gravity != Vec3{};
  list.push_back(
      {"gravity", !weight, weight ? "added in the pass of the integrator" : "the scene has none"});
  list.push_back(
      {"loads", !built.body().has_loads(),
       !built.body().has_loads() ? "the scene has none" : count_text(scene.loads.size(), "load")});
  list.push_back({"constraints", built.body().constraints().empty(),
                  built.body().constraints().empty()
                      ? "the scene has none"
                      : std::to_string(built.body().constraints().vertex_count()) +
                            " vertices; one pass over their list"});
}

void decide_contact(BuiltScene& built, std::vector<Decision>& list) {
  const auto* contact = dynamic_cast<const Contact*>(built.body().contact());
  if (!contact) return list.push_back({"contact", true, "the scene has none"});
  const BoundarySurface& surface = contact->surface();
  list.push_back({"contact", false,
                  count_text(contact->obstacles().size(), "obstacle") + " against " +
                      (contact->points().are_embedded()
                           ? std::to_string(contact->points().count()) + " points of the surface"
                           : std::to_string(surface.vertices().size()) + " vertices of " +
                                 std::to_string(surface.faces().size()) + " boundary faces") +
                      ", in every step" +
                      (built.scene().contact.penalty ? ", with springs"
                       : contact->is_term()          ? ", as forces in its equations"
                                                     : "")});
  for (const Obstacle& obstacle : contact->obstacles()) {
    std::ostringstream text;
    text << name_of(obstacle.shape);
    if (const auto* solid = std::get_if<Triangulated>(&obstacle.shape))
      text << " of " << count_text(solid->surface->surface().triangles.size(), "triangle");
    text << ", friction " << obstacle.friction
         << (obstacle.motion.moves() ? ", moves along a path" : ", does not move");
    if (obstacle.coupling)
      text << ", compliant (" << obstacle.coupling->mass << " kg, " << obstacle.coupling->stiffness
           << " N/m)";
    list.push_back({"obstacle " + obstacle.name, false, text.str()});
  }
  const PieceContact* pieces = contact->pieces();
  const bool are_none =
      pieces && built.scene().events.empty() && built.body().islands().count() == 1;
  list.push_back({"contact between pieces", !pieces,
                  are_none ? "none yet: the body is one piece, and the scene has no events"
                  : pieces ? "nodes of one near faces of another, sought again as they move; "
                             "the lips of cuts, too"
                           : "not requested: they pass through each other"});
  list.push_back({"contact of a piece with itself", !pieces || !pieces->touches_self(),
                  pieces && pieces->touches_self() ? "nodes near faces that look at them"
                  : pieces                         ? "not requested: only the lips of cuts touch"
                                                   : "not requested"});
}

void decide_events(const Scene& scene, std::vector<Decision>& list) {
  const bool sleeps = scene.solver.sleep_acceleration > 0;
  list.push_back({"sleep", !sleeps,
                  sleeps
                      ? "islands at rest are not computed until an operation or contact wakes them"
                      : "not requested"});
  if (scene.events.empty()) list.push_back({"events", true, "the scene has none"});
  const bool solids = std::ranges::any_of(scene.contact.obstacles, [](const Obstacle& obstacle) {
    return std::holds_alternative<Triangulated>(obstacle.shape);
  });
  bool blades = false;
  for (const Event& event : scene.events) {
    list.push_back({"event " + event.path, false, event.summary()});
    blades |= std::holds_alternative<CutSurface>(event.what) ||
              std::holds_alternative<CutBlade>(event.what);
  }
  list.push_back(
      {"geometry module", !blades && !solids,
       blades   ? "exact predicates for blades"
       : solids ? "distances from obstacles of triangles"
                : "no event uses a surface or a moving blade, and no obstacle has triangles"});
}

std::string names(const std::vector<FieldChoice>& fields) {
  std::string text;
  for (const FieldChoice& field : fields) text += (text.empty() ? "" : ", ") + field.name;
  return text.empty() ? "no fields" : text;
}

void decide_frames(const Scene& scene, const BuiltScene& built, const Recorder& recorder,
                   std::vector<Decision>& list) {
  if (!recorder.writes_frames()) {
    list.push_back({"frames", true, "the scene requests tables only"});
    return;
  }
  list.push_back({"frames", false,
                  "to " + scene.output.directory.string() + ", with " + names(recorder.fields())});
  const std::string others = names(recorder.other_fields());
  list.push_back({"other fields", built.skips(),
                  others + ": " +
                      (built.skips() ? "not requested" : std::string(no_skip) + ", then dropped")});
}

void decide_output(const Scene& scene, const BuiltScene& built, const Recorder& recorder,
                   std::vector<Decision>& list) {
  if (!recorder.writes()) {
    list.push_back({"writer", true, "the scene requests no output"});
    return;
  }
  decide_frames(scene, built, recorder, list);
  list.push_back({"energies.csv", !recorder.writes_energies(),
                  recorder.writes_energies()
                      ? "every " + count_text(scene.output.energies_every, "step")
                      : "not requested"});
  list.push_back({"probes.csv", !recorder.writes_probes(),
                  recorder.writes_probes()
                      ? "every " + count_text(scene.output.probes_every, "step") + ", with " +
                            names(recorder.probe_table()->fields())
                      : "not requested"});
  list.push_back({"tools.csv", !recorder.writes_tools(),
                  recorder.writes_tools() ? "every " + count_text(scene.output.tools_every, "step")
                                          : "not requested"});
  const auto series = [&](const char* name, bool wanted) {
    list.push_back({name, !wanted, wanted ? "one more file per frame" : "not requested"});
  };
  series("springs", scene.output.springs);
  series("faces", scene.output.faces);
  series("cuts", scene.output.cuts);
  series("obstacles", scene.output.obstacles);
  series("surface", scene.output.surface);
}

bool only_cuts(const std::vector<Event>& events) {
  return std::all_of(events.begin(), events.end(), [](const Event& event) {
    return !event.when && (std::holds_alternative<CutPlane>(event.what) ||
                           std::holds_alternative<CutFaces>(event.what));
  });
}

// What needs forces, stresses or energies in cells that do not move; "" if nothing does.
std::string reason_to_compute_fixed_cells(const Scene& scene, const BuiltScene& built,
                                          const Recorder& recorder) {
  if (!built.skips()) return no_skip;
  if (scene.output.on_request) return "computed: Python may read the fields of any cell";
  if (recorder.frames_need_force()) return "computed: frames contain forces";
  if (recorder.frames_run_functors()) return "computed: frames contain fields of the models";
  if (recorder.probes_need(&FieldChoice::needs_force)) return "computed: probes record forces";
  if (recorder.probes_need(&FieldChoice::runs_functors))
    return "computed: probes record fields of the models";
  if (recorder.writes_energies()) return "computed: energies.csv sums over all cells";
  if (scene.solver.until_rest) return "computed: the search for rest needs the energy";
  if (!only_cuts(scene.events)) return "computed: an event may use any cell";
  return "";
}

}  // namespace

Decision decide_fixed_cells(const Scene& scene, BuiltScene& built, const Recorder& recorder) {
  const std::string subject = "cells between fixed vertices";
  const std::string reason = reason_to_compute_fixed_cells(scene, built, recorder);
  if (!reason.empty()) return {subject, false, reason};
  const Index cells = built.body().skip_fixed_cells();
  if (cells == 0) return {subject, false, "there is no complete block of 8 such cells"};
  return {subject, true,
          std::to_string(cells) +
              " (whole blocks of 8): they never move, and their stress, forces and energy are not "
              "requested"};
}

std::vector<Decision> decide(const Scene& scene, PluginHost& host, BuiltScene& built,
                             const Recorder& recorder) {
  std::vector<Decision> list;
  decide_plugins(scene, host, list);
  decide_cells(built, list);
  decide_arrays(scene, built, list);
  decide_columns(built, list);
  decide_functors(built, list);
  decide_integrator(scene, built, list);
  decide_step(scene, list);
  decide_physics(scene, built, list);
  decide_contact(built, list);
  decide_events(scene, list);
  decide_output(scene, built, recorder, list);
  return list;
}

}  // namespace suture
