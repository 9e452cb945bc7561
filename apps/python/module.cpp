// SPDX-License-Identifier: GPL-3.0-or-later
//
// The compiled half of the package `suture`: what __init__.py builds on.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <sstream>

#include "apps/python/cells.hpp"
#include "apps/python/contact.hpp"
#include "apps/python/errors.hpp"
#include "apps/python/given_mesh.hpp"
#include "apps/python/gradients.hpp"
#include "apps/python/parameters.hpp"
#include "apps/python/python_term.hpp"
#include "apps/python/results.hpp"
#include "apps/python/session.hpp"
#include "kernel/base/error.hpp"
#include "kernel/forces/gravity.hpp"

namespace suture::python {
namespace {

using namespace pybind11::literals;

py::tuple result_of(Session& session, const EventOutcome& outcome) {
  const BuiltScene& built = session.simulation().built();
  py::array_t<std::int64_t> removed(static_cast<py::ssize_t>(outcome.removed.size()));
  for (std::size_t i = 0; i < outcome.removed.size(); ++i)
    removed.mutable_data()[i] = static_cast<std::int64_t>(built.element_name(outcome.removed[i]));
  return py::make_tuple(outcome.faces_cut, outcome.faces_torn, outcome.faces_sewn,
                        outcome.elements_removed, named(built, outcome.faces), removed,
                        outcome.elements_cut);
}

py::dict energies(Session& session) {
  Simulation& simulation = session.between_steps();
  const EnergyBalance balance = simulation.built().dynamics().balance();
  py::dict result("kinetic"_a = balance.kinetic, "elastic"_a = balance.elastic,
                  "potential"_a = suture::energies(simulation.built().dynamics()).external);
  for (const EnergyBalance::Work& work : balance.works) result[work.term] = work.value;
  result["prescribed"] = balance.prescribed;
  result["models"] = balance.models;
  result["events"] = balance.events;
  result["dissipated"] = balance.dissipated;
  result["balance"] = balance.balance;
  return result;
}

py::dict explain(Session& session) {
  Simulation& simulation = session.between_steps();
  py::list done, skipped;
  for (const Decision& decision : simulation.decisions())
    (decision.skipped ? skipped : done).append(py::make_tuple(decision.subject, decision.reason));
  return py::dict("done"_a = done, "skipped"_a = skipped, "threads"_a = simulation.threads(),
                  "isa"_a = std::string(simulation.isa()), "dt"_a = simulation.next_dt());
}

py::dict dict_of(const RunSummary& summary) {
  return py::dict("steps"_a = summary.steps, "time"_a = summary.time, "dt"_a = summary.dt,
                  "frames"_a = summary.frames, "faces_cut"_a = summary.faces_cut,
                  "faces_torn"_a = summary.faces_torn, "faces_sewn"_a = summary.faces_sewn,
                  "elements_removed"_a = summary.elements_removed,
                  "inverted_elements"_a = summary.inverted_elements,
                  "rollbacks"_a = summary.rollbacks, "balance"_a = summary.balance,
                  "seconds"_a = summary.seconds, "threads"_a = summary.threads,
                  "elements_per_second"_a = summary.elements_per_second, "pvd"_a = summary.pvd);
}

// ------------------------------------------------------------ columns of models --

Instance& instance_named(Session& session, const std::string& name) {
  std::string names;
  for (const auto& instance : session.simulation().attributes().instances()) {
    if (instance->name() == name) return *instance;
    names += (names.empty() ? "" : ", ") + instance->name();
  }
  throw py::key_error("no model of this scene is named '" + name + "'; it has " + names);
}

py::list columns(Session& session) {
  py::list list;
  for (const auto& instance : session.simulation().attributes().instances())
    for (const Table& table : instance->tables())
      for (const Column& column : table.columns)
        list.append(py::make_tuple(instance->name(), column.spec().name, table.dimension,
                                   column.spec().components, column.spec().unit,
                                   column.spec().doc));
  return list;
}

py::array column(Session& session, const std::string& model, const std::string& name) {
  Instance& instance = instance_named(session, model);
  std::string names;
  for (Table& table : instance.tables()) {
    if (Column* found = table.find(name)) return session.views().of(*found);
    for (const Column& other : table.columns)
      names += (names.empty() ? "" : ", ") + other.spec().name;
  }
  throw py::key_error("model '" + model + "' has no column '" + name + "' in this run; it has " +
                      (names.empty() ? "none" : names));
}

py::array column_cells(Session& session, const std::string& model, int dimension) {
  if (dimension < 0 || dimension > 3)
    throw py::value_error("dimension must be 0 (vertices), 1 (edges), 2 (faces) or 3 (elements)");
  const CellSet& cells = instance_named(session, model).table(dimension).cells;
  py::array_t<std::int64_t> numbers(static_cast<py::ssize_t>(cells.size()));
  for (Index row = 0; row < cells.size(); ++row) numbers.mutable_data()[row] = cells.cell(row);
  return numbers;
}

// --------------------------------------------------------------------- the class --

template <Column& (Attributes::*column)()>
py::array kernel_column(Session& session) {
  return session.views().of((session.simulation().attributes().*column)());
}

py::array velocity(Session& session) {
  session.between_steps().built().dynamics().synchronise(false);
  return kernel_column<&Attributes::velocity>(session);
}

py::array force(Session& session) {
  session.between_steps().built().dynamics().synchronise();
  return kernel_column<&Attributes::force>(session);
}

TriangleSurface surface_of(const py::array_t<double, py::array::c_style>& points,
                           const py::array_t<std::int64_t, py::array::c_style>& triangles) {
  TriangleSurface surface;
  surface.source = "the surface";
  surface.points.resize(static_cast<std::size_t>(points.shape(0)));
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    std::copy_n(points.data() + 3 * i, 3, surface.points[i].begin());
  surface.triangles.resize(static_cast<std::size_t>(triangles.shape(0)));
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    std::transform(triangles.data() + 3 * i, triangles.data() + 3 * i + 3,
                   surface.triangles[i].begin(),
                   [](std::int64_t number) { return static_cast<Index>(number); });
  return surface;
}

/// Callbacks and force functions usually refer to the simulation that holds them.
void collect_cycles(PyHeapTypeObject* heap_type) {
  PyTypeObject& type = heap_type->ht_type;
  type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    // While the constructor runs there is nothing to visit.
    auto* instance = reinterpret_cast<py::detail::instance*>(self);
    if (instance->get_value_and_holder().holder_constructed())
      if (const int stop = py::cast<Session&>(py::handle(self)).traverse(visit, arg)) return stop;
    return 0;
  };
  type.tp_clear = [](PyObject* self) {
    auto* instance = reinterpret_cast<py::detail::instance*>(self);
    if (instance->get_value_and_holder().holder_constructed())
      py::cast<Session&>(py::handle(self)).clear();
    return 0;
  };
}

std::unique_ptr<Session> make_session(const std::string& text, const std::filesystem::path& file,
                                      bool is_text, const std::vector<std::string>& sets,
                                      const py::object& mesh, bool output,
                                      const std::filesystem::path& output_folder) {
  const bool is_read = py::isinstance<ReadMesh>(mesh);
  return std::make_unique<Session>(SessionOptions{
      text, file, is_text, sets, is_read ? nullptr : mesh_of(mesh),
      is_read ? mesh.cast<std::shared_ptr<ReadMesh>>() : nullptr, output, output_folder});
}

/// Time and steps.
template <class Class>
void bind_steps(Class& session) {
  session
      .def("step", &Session::step, "count"_a = 1,
           "Make up to `count` steps; return how many were made (fewer at the end of the run).")
      .def("run_to", &Session::run_to, "time"_a,
           "Run until the first step that begins at or after `time` (s). The lengths of steps do "
           "not change, so the time reached may be later by less than a step.")
      .def("_run", [](Session& s, py::object progress) { return dict_of(s.run(progress)); })
      .def_property_readonly("_writes", [](const Session& s) { return s.scene().output.enabled; })
      .def_property_readonly("time", &Session::time, "Time of the positions, s.")
      .def_property_readonly("steps", &Session::steps, "Number of steps made.")
      .def_property_readonly("dt", &Session::dt, "Length of the next step, s.")
      .def_property_readonly("outcome", &Session::outcome,
                             "How the run ended: 'finished', 'at rest' or 'unstable equilibrium'; "
                             "None before its end.")
      .def_property_readonly("messages", &Session::messages,
                             "What happened so far, a list of lines: operations, rollbacks.");
}

/// Columns.
template <class Class>
void bind_columns(Class& session) {
  session
      .def_property("position", &kernel_column<&Attributes::position>, &Session::set_position,
                    "(vertices, 3) current positions, m, relative to origin. Assigning an array "
                    "moves the vertices; the change of energy is booked as that of an event.")
      .def_property("velocity", &velocity, &Session::set_velocity,
                    "(vertices, 3) velocities, m/s, at the time of the positions (with "
                    "symplectic-euler, half a step before). Assigning an array sets them.")
      .def_property_readonly("force", &force,
                             "(vertices, 3) forces of models, loads and force terms at the current "
                             "positions, N, without gravity. Costs one evaluation after a step.")
      .def_property_readonly("rest", &kernel_column<&Attributes::rest>,
                             "(vertices, 3) rest positions, m, relative to origin.")
      .def_property_readonly("mass", &kernel_column<&Attributes::mass>,
                             "(vertices,) masses, kg; 0 where a vertex was removed.")
      .def_property_readonly("fixed", &kernel_column<&Attributes::fixed>,
                             "(vertices,) constrained components: the sum of 1 (x), 2 (y), 4 (z).")
      .def("columns", &columns,
           "The columns of the models: a list of (model, name, dimension, components, unit, doc).")
      .def("column", &column, "model"_a, "name"_a,
           "The column of a model, by the model's name in the scene. (rows,) for one component; "
           "(rows, components) on vertices; (blocks, 8, components) on edges, faces and elements, "
           "row r at [r // 8, r % 8]. column_cells() says which cells the rows are. Columns with "
           "a history, which change their memory in every step, are copies.")
      .def("column_cells", &column_cells, "model"_a, "dimension"_a,
           "(rows,) int64: the vertices (0), edges (1), faces (2) or elements (3) of the rows of a "
           "model's columns.");
}

/// Cells and energies.
template <class Class>
void bind_cells(Class& session) {
  session
      .def_property_readonly(
          "origin", [](Session& s) { return py::cast(s.simulation().origin()); },
          "[x, y, z] of the body's own origin in the scene, m: add it to positions.")
      .def_property_readonly(
          "point_ids", [](Session& s) { return point_ids(s.simulation().built()); },
          "(vertices,) int64: the mesh point of every vertex, by your number. After a cut, several "
          "vertices have the same point.")
      .def_property_readonly(
          "element_ids", [](Session& s) { return element_ids(s.simulation().built()); },
          "(elements,) int64: your number of every element.")
      .def_property_readonly(
          "vertex_exists", [](Session& s) { return exists(s.simulation().built(), 0); },
          "(vertices,) bool: False where a vertex was removed or merged into another.")
      .def_property_readonly(
          "element_exists", [](Session& s) { return exists(s.simulation().built(), 3); },
          "(elements,) bool: False where an element was removed.")
      .def("_hexahedra", [](Session& s) { return hexahedra(s.simulation().built()); })
      .def("_sets", [](Session& s) { return sets(s.simulation().built()); })
      .def("_boundary", [](Session& s) { return boundary(s.simulation().built()); })
      .def("_embedded_surface", [](Session& s) { return embedded_surface(s.simulation().built()); })
      .def("energies", &energies,
           "Energies now and works since the start, J: kinetic, elastic, potential (of gravity and "
           "dead loads), the work of every term, prescribed (motions), models (functors without an "
           "energy), events, dissipated, and balance, which nothing explains.")
      .def("explain", &explain,
           "What was built, computed and skipped, and why: a dict of done and skipped (lists of "
           "(subject, reason)), threads, isa and dt (s).")
      .def_property_readonly(
          "title", [](Session& s) { return s.scene().title; }, "The title of the scene.")
      .def_property_readonly(
          "hash", [](Session& s) { return s.scene().hash; },
          "Hash of what determines the results, 16 hexadecimal digits.");
}

template <class Class>
void bind_contact(Class& session) {
  session
      .def_property_readonly(
          "contact_force", [](Session& s) { return contact_force(s.between_steps()); },
          "(vertices, 3) forces of obstacles and other pieces in the last step, N; a copy.")
      .def_property_readonly(
          "gap", [](Session& s) { return gap(s.between_steps()); },
          "(vertices,) distance of surface vertices from the nearest obstacle, less the thickness, "
          "m; NaN inside the body. Computed now; a copy.")
      .def("_tool_names", [](Session& s) { return tool_names(s.simulation()); })
      .def("_tool_state",
           [](Session& s, std::size_t place) { return tool_state(s.between_steps(), place); })
      .def("_steer",
           [](Session& s, const std::string& name, std::optional<Vec3> translation,
              std::optional<Vec3> rotation, double at) {
             s.steer(name, {at, translation, rotation});
           })
      .def("_move_grasp", &Session::move_grasp);
}

Vec3 vector_of(const py::object& value, const char* what) {
  try {
    return value.cast<Vec3>();
  } catch (const py::cast_error&) {
    throw py::type_error(std::string(what) + " must be three numbers; is " +
                         py::repr(value).cast<std::string>());
  }
}

/// A field that a property has: where the scene has none, there is no such attribute.
py::array field_or_none(Session& session, const char* name) {
  try {
    return field(session.between_steps(), name);
  } catch (const InputError& error) {
    throw py::attribute_error(error.what());
  }
}

/// What frames and probes contain.
template <class Class>
void bind_results(Class& session) {
  session
      .def(
          "fields", [](Session& s) { return fields(s.between_steps()); },
          "The fields that field() computes, which are those of frames: a list of (name, "
          "'vertices' or 'elements', components, unit).")
      .def(
          "field",
          [](Session& s, const std::string& name) { return field(s.between_steps(), name); },
          "name"_a,
          "A field of frames, computed now: (cells,) or (cells, components); a copy. Tensors have "
          "the components xx, yy, zz, xy, yz, xz. NaN where no model provides the field.")
      .def_property_readonly(
          "stress", [](Session& s) { return field_or_none(s, "stress"); },
          "(elements, 6) Cauchy stress, Pa: xx, yy, zz, xy, yz, xz; a copy.")
      .def_property_readonly(
          "von_mises", [](Session& s) { return field_or_none(s, "von_mises"); },
          "(elements,) von Mises stress, Pa; a copy.")
      .def_property_readonly(
          "strain", [](Session& s) { return field_or_none(s, "strain"); },
          "(elements, 6) Green-Lagrange strain: xx, yy, zz, xy, yz, xz; a copy.")
      .def_property_readonly(
          "reactions", [](Session& s) { return field_or_none(s, "reaction"); },
          "(vertices, 3) forces of constraints on the body, N; 0 where it is free; a copy.")
      .def(
          "probes", [](Session& s) { return probes(s.between_steps(), s.probes()); },
          "The probes of the scene now, what probes.csv contains: {name: {field: value}}, a number "
          "or an array of (components,).");
}

Instance& instance_at(Session& session, std::size_t model) {
  return *session.simulation().attributes().instances().at(model);
}

/// What changes between steps besides the motion and the cells.
template <class Class>
void bind_changes(Class& session) {
  session
      .def("_models",
           [](Session& s) {
             py::list names;
             for (const auto& instance : s.simulation().attributes().instances())
               names.append(instance->name());
             return names;
           })
      .def("_parameters",
           [](Session& s, std::size_t model) { return parameters(instance_at(s, model)); })
      .def("_set_parameters", &Session::set_parameters)
      .def("_set_field", &Session::set_field)
      .def_property(
          "gravity", [](Session& s) { return py::cast(s.simulation().built().gravity().value()); },
          [](Session& s, const py::object& value) { s.set_gravity(vector_of(value, "gravity")); },
          "[x, y, z] gravity, m/s^2, where its ramp has ended. Assigning three numbers changes it "
          "from now on.")
      .def("_open_live", &Session::open_live)
      .def("_run_live", &Session::run_live)
      .def("_close_live", &Session::close_live)
      .def("_live_recording", &Session::live_recording)
      .def("copy", &Session::copy,
           "The whole state of the run as a State, for restore(): what a checkpoint contains, in "
           "memory. The simulation must not write output.")
      .def("save_checkpoint", &Session::save_checkpoint, "file"_a,
           "Write the state of the run to a file, from which `suture run --resume` and `suture "
           "live` go on, without this script: its callbacks are not part of it. The simulation "
           "must not write output. With an automatic dt, frames of the scene add steps that end at "
           "their times; --set /output=false keeps the steps of the script.")
      .def("restore", &Session::restore, "state"_a,
           "Return to a State of this scene: the run goes on as it did from there, bit by bit, "
           "whatever was cut or changed since. Builds the simulation again, so it costs as much as "
           "creating it. Arrays taken before keep their values.");
}

void bind_state(py::module_& module) {
  py::class_<SessionState, std::shared_ptr<SessionState>>(
      module, "State", "The state of a simulation in memory, from Simulation.copy().")
      .def_readonly("time", &SessionState::time, "Time, s.")
      .def_readonly("steps", &SessionState::steps, "Number of steps made.")
      .def_property_readonly(
          "nbytes", [](const SessionState& s) { return s.state.bytes(); }, "Memory, bytes.")
      .def("__repr__", [](const SessionState& s) {
        std::ostringstream text;
        text << "<suture.State: step " << s.steps << ", t = " << s.time << " s>";
        return text.str();
      });
}

/// What Simulation builds its events, callbacks and force terms on.
template <class Class>
void bind_operations(Class& session) {
  session
      .def("_apply", [](Session& s, const std::string& text,
                        const std::string& name) { return result_of(s, s.apply(text, name)); })
      .def("_cut_surface",
           [](Session& s, const py::array_t<double, py::array::c_style>& points,
              const py::array_t<std::int64_t, py::array::c_style>& triangles, bool rest,
              std::optional<bool> along_blade) {
             return result_of(s, s.cut(surface_of(points, triangles), rest, along_blade));
           })
      .def("_every",
           [](Session& s, std::uint64_t n, py::function f) { s.callbacks().add_every(n, f); })
      .def("_at", [](Session& s, double t, py::function f) { s.callbacks().add_at(t, f); })
      .def("_force_term", [](Session& s, const std::string& name, py::function force,
                             std::optional<py::function> energy, std::optional<double> stiffness) {
        return s
            .add_term(std::make_unique<PythonTerm>(
                PythonForce{name, std::move(force), std::move(energy), stiffness},
                s.simulation().attributes()))
            .report();
      });
}

void bind_session(py::module_& module) {
  py::class_<Session> session(module, "Simulation", py::custom_type_setup(collect_cycles));
  session.def(py::init(&make_session), "text"_a, "file"_a, "is_text"_a, "sets"_a, "mesh"_a,
              "output"_a, "output_folder"_a);
  bind_steps(session);
  bind_columns(session);
  bind_cells(session);
  bind_contact(session);
  bind_results(session);
  bind_changes(session);
  bind_operations(session);
  bind_gradients(session);
}

}  // namespace

PYBIND11_MODULE(_suture, module) {
  add_errors(module);
  py::class_<ReadMesh, std::shared_ptr<ReadMesh>>(module, "ReadMesh");
  module.def("read_mesh", &read_mesh);
  bind_state(module);
  bind_session(module);
  py::class_<ForceReport, std::shared_ptr<ForceReport>>(
      module, "ForceTerm", "What a force function in a simulation has cost and done.")
      .def_readonly("name", &ForceReport::name)
      .def_readonly("calls", &ForceReport::calls, "How often the function was called.")
      .def_readonly("seconds", &ForceReport::seconds, "Wall-clock time spent in the function, s.")
      .def_readonly("work", &ForceReport::work,
                    "Work since the start, J; 0 for a force with an energy.");
  module.attr("version") = SUTURE_VERSION;
}

}  // namespace suture::python
