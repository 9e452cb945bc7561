// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/gradients.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "kernel/base/error.hpp"
#include "kernel/gradients/equilibrium_slopes.hpp"
#include "kernel/gradients/total_forces.hpp"

namespace suture::python {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<double> vector_of(const Array& values) {
  return {values.data(), values.data() + values.size()};
}

py::array rows_of_3(const std::vector<double>& values) {
  return py::array_t<double>({static_cast<py::ssize_t>(values.size() / 3), py::ssize_t{3}},
                             values.data());
}

/// Throws unless there are three numbers per vertex.
std::vector<double> of_vertices(Session& session, const Array& values, const char* what) {
  const auto rows = static_cast<py::ssize_t>(session.simulation().attributes().vertex_count());
  if (values.ndim() == 2 && values.shape(0) == rows && values.shape(1) == 3) {
    std::vector<double> numbers = vector_of(values);
    if (std::ranges::all_of(numbers, [](double n) { return std::isfinite(n); })) return numbers;
    throw py::value_error(std::string(what) + " must be finite");
  }
  throw py::value_error(std::string(what) + " must have the shape (" + std::to_string(rows) +
                        ", 3), one row per vertex; has " +
                        py::str(values.attr("shape")).cast<std::string>());
}

EquilibriumSlopes slopes_of(Session& session) {
  return EquilibriumSlopes(session.between_steps().built().dynamics());
}

/// The slopes by a parameter of a model, by the number of the model.
ParameterSlopes slopes_of(Session& session, std::size_t model, const std::string& name) {
  Simulation& simulation = session.between_steps();
  return ParameterSlopes(simulation.built().body(), {simulation.time()},
                         *simulation.attributes().instances().at(model), name);
}

/// One number per value of the parameter.
std::vector<double> weights_of(const ParameterSlopes& slopes, const Array& weights) {
  if (weights.ndim() == 1 && static_cast<std::size_t>(weights.size()) == slopes.size())
    return vector_of(weights);
  throw py::value_error("weights must have the shape (" + std::to_string(slopes.size()) +
                        ",), one per value of the parameter; has " +
                        py::str(weights.attr("shape")).cast<std::string>());
}

/// (forces of the multipliers, motion, iterations) from the slopes of an objective.
py::tuple adjoint(Session& session, const Array& displacement, const std::optional<Array>& reaction,
                  double energy, double tolerance) {
  ObjectiveSlopes objective;
  objective.displacement = of_vertices(session, displacement, "dJ/du");
  if (reaction) objective.reaction = of_vertices(session, *reaction, "dJ/dR");
  objective.energy = energy;
  const Adjoint found = slopes_of(session).adjoint(objective, tolerance);
  return py::make_tuple(rows_of_3(found.multipliers.force), rows_of_3(found.motion),
                        found.iterations);
}

/// The derivative along a direction of rest positions, with the forces of the multipliers and the
/// motion of adjoint().
double along_rest(Session& session, const Array& displacement, double energy, const Array& forces,
                  const Array& motion, const Array& direction) {
  const ObjectiveSlopes objective{of_vertices(session, displacement, "dJ/du"), {}, energy};
  const Adjoint adjoint{{of_vertices(session, forces, "forces"), energy},
                        of_vertices(session, motion, "motion")};
  return slopes_of(session).along_rest(objective, adjoint,
                                       of_vertices(session, direction, "direction"));
}

/// The same by each rest position.
py::array by_rest(Session& session, const Array& displacement, double energy, const Array& forces,
                  const Array& motion) {
  const ObjectiveSlopes objective{of_vertices(session, displacement, "dJ/du"), {}, energy};
  const Adjoint adjoint{{of_vertices(session, forces, "forces"), energy},
                        of_vertices(session, motion, "motion")};
  return rows_of_3(slopes_of(session).by_rest(objective, adjoint));
}

/// (du/dp, dR/dp) from df/dp.
py::tuple sensitivity(Session& session, const Array& forces, double tolerance) {
  const Sensitivity found =
      slopes_of(session).sensitivity(of_vertices(session, forces, "forces"), tolerance);
  return py::make_tuple(rows_of_3(found.displacement), rows_of_3(found.reaction));
}

/// How many values a parameter has: 0 if it is the same in all elements.
std::size_t parameter_values(Session& session, std::size_t model, const std::string& name) {
  const ParameterSlopes slopes = slopes_of(session, model, name);
  return slopes.is_per_element() ? slopes.size() : 0;
}

/// df/dp, where the values of a parameter change by these weights.
py::array force_slope(Session& session, std::size_t model, const std::string& name,
                      const Array& weights) {
  ParameterSlopes slopes = slopes_of(session, model, name);
  return rows_of_3(slopes.forces(weights_of(slopes, weights)));
}

/// The derivative by each value of a parameter, from the multipliers.
py::array gradient(Session& session, std::size_t model, const std::string& name,
                   const Array& multipliers, double energy) {
  const std::vector<double> values =
      slopes_of(session, model, name)
          .each({of_vertices(session, multipliers, "multipliers"), energy});
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

/// The same in the direction of weights.
double gradient_along(Session& session, std::size_t model, const std::string& name,
                      const Array& multipliers, double energy, const Array& weights) {
  ParameterSlopes slopes = slopes_of(session, model, name);
  return slopes.along({of_vertices(session, multipliers, "multipliers"), energy},
                      weights_of(slopes, weights));
}

// ------------------------------------------------------------ of kept steps --

KeptSteps& kept_steps(Session& session) {
  session.between_steps();
  if (session.kept_steps() != nullptr) return *session.kept_steps();
  throw InputError("no steps are kept; call keep_steps() before the run");
}

/// (place of the model, name, weights or None) of each parameter.
using WantedParameters = std::vector<std::tuple<std::size_t, std::string, std::optional<Array>>>;

std::vector<ParameterDirection> wanted_of(Session& session, const WantedParameters& given) {
  std::vector<ParameterDirection> wanted;
  for (const auto& [model, name, weights] : given) {
    wanted.push_back({session.simulation().attributes().instances().at(model).get(), name});
    if (weights) wanted.back().weights = weights_of(slopes_of(session, model, name), *weights);
  }
  return wanted;
}

py::array rows_of_moments(const std::vector<std::vector<double>>& moments) {
  if (moments.empty()) return py::array_t<double>(0);
  py::array_t<double> rows({static_cast<py::ssize_t>(moments.size()),
                            static_cast<py::ssize_t>(moments[0].size() / 3), py::ssize_t{3}});
  double* to = rows.mutable_data();
  for (const std::vector<double>& moment : moments) to = std::ranges::copy(moment, to).out;
  return rows;
}

/// The derivatives of a run. slopes_at(moment) gives (dJ/du, dJ/dR or None, dJ/dW), or None, in the
/// state at a moment; `end`: (position, velocity, states) of a run that goes on from the last one.
py::dict run_adjoint(Session& session, const py::function& slopes_at, double tolerance,
                     const WantedParameters& parameters, bool moments,
                     const std::optional<std::tuple<Array, Array, Array>>& end) {
  WantedSlopes wanted{wanted_of(session, parameters), moments};
  if (end)
    wanted.end = {of_vertices(session, std::get<0>(*end), "dJ/dx"),
                  of_vertices(session, std::get<1>(*end), "dJ/dv"), vector_of(std::get<2>(*end))};
  const RunAdjoint found = kept_steps(session).adjoint(
      [&](std::size_t moment) {
        ObjectiveSlopes slopes;
        const py::object given = slopes_at(moment);
        if (given.is_none()) return slopes;
        const auto [displacement, reaction, energy] =
            given.cast<std::tuple<Array, std::optional<Array>, double>>();
        slopes.displacement = of_vertices(session, displacement, "dJ/du");
        if (reaction) slopes.reaction = of_vertices(session, *reaction, "dJ/dR");
        slopes.energy = energy;
        return slopes;
      },
      tolerance, wanted);
  py::list slopes;
  for (const std::vector<double>& of_parameter : found.parameters)
    slopes.append(
        py::array_t<double>(static_cast<py::ssize_t>(of_parameter.size()), of_parameter.data()));
  using namespace py::literals;
  return py::dict(
      "parameters"_a = slopes, "load"_a = rows_of_3(found.load),
      "loads"_a = rows_of_moments(found.loads), "motions"_a = rows_of_moments(found.motions),
      "initial_position"_a = rows_of_3(found.start.position),
      "initial_velocity"_a = rows_of_3(found.start.velocity),
      "initial_states"_a = py::array_t<double>(static_cast<py::ssize_t>(found.start.states.size()),
                                               found.start.states.data()),
      "start_position"_a = py::array_t<double>(
          {static_cast<py::ssize_t>(found.start_position.size() / 4), py::ssize_t{4}},
          found.start_position.data()),
      "iterations"_a = found.iterations);
}

/// Without limits, every state is kept.
void keep_steps(Session& session, std::optional<std::size_t> states, std::optional<double> memory) {
  if ((states && *states < 2) || (memory && !(*memory > 0)))
    throw py::value_error("at least two states must be kept, in memory > 0");
  StepReplay::Limit limit;
  if (states) limit.states = *states;
  if (memory && std::isfinite(*memory)) limit.bytes = static_cast<std::size_t>(*memory);
  session.keep_steps(limit);
}

/// (two simulations of scenes that differ in a number, which is larger and smaller by a step; the
/// step), see ParameterDirection.
using OtherScenes = std::vector<std::tuple<Session*, Session*, double>>;

/// Follows the derivatives by these, one after the other, from now on.
void follow(Session& session, const WantedParameters& parameters, const OtherScenes& others,
            double tolerance) {
  std::vector<ParameterDirection> wanted = wanted_of(session, parameters);
  for (const auto& [up, down, step] : others) {
    ParameterDirection direction;
    direction.up = &up->between_steps().built().body();
    direction.down = &down->between_steps().built().body();
    direction.step = step;
    wanted.push_back(std::move(direction));
  }
  session.follow(std::move(wanted), tolerance);
}

/// (du/dp, dR/dp) of a parameter that is followed.
py::tuple followed(Session& session, std::size_t number) {
  session.between_steps();
  const StateSensitivity& found = session.followed()->of(number);
  return py::make_tuple(rows_of_3(found.state.position), rows_of_3(found.reaction));
}

/// The vertices of a field of a probe, and "mean" or "sum".
py::tuple probe_vertices(Session& session, const std::string& probe, const std::string& field) {
  const ProbeTable::Cover cover = session.probes().cover(probe, field);
  if (cover.of != Probe::Of::mean && cover.of != Probe::Of::sum)
    throw InputError("the probe '" + probe + "' gives the least or the greatest " + field +
                     ", which has no derivative; set its /of to \"mean\" or \"sum\"");
  py::array_t<std::int64_t> vertices(static_cast<py::ssize_t>(cover.cells.size()));
  std::ranges::copy(cover.cells, vertices.mutable_data());
  return py::make_tuple(vertices, cover.of == Probe::Of::mean ? "mean" : "sum");
}

}  // namespace

void bind_gradients(py::class_<Session>& session) {
  using namespace py::literals;
  session
      .def("equilibrate", &Session::equilibrate,
           "Find the equilibrium of a static run again, from the current positions and at the same "
           "time: after parameters, loads or cells were changed.")
      .def("_adjoint", &adjoint)
      .def("_along_rest", &along_rest)
      .def("_by_rest", &by_rest)
      .def("_sensitivity", &sensitivity)
      .def("_stored_energy",
           [](Session& s) { return s.between_steps().built().body().models().energy(s.time()); })
      .def("_elastic_forces",
           [](Session& s) {
             return rows_of_3(elastic_forces(s.between_steps().built().body(), s.time()));
           })
      .def("_parameter_values", &parameter_values)
      .def("_force_slope", &force_slope)
      .def("_gradient", &gradient)
      .def("_gradient_along", &gradient_along)
      .def("keep_steps", &keep_steps, "states"_a = py::none(), "memory"_a = py::none(),
           "Keep the steps from now on, for the derivatives of the run from here. Those that were "
           "kept before are forgotten. At most so many states are in memory, or so many bytes; "
           "steps between them are made again when an adjoint is taken. Default: every state, some "
           "100 B per vertex and step.")
      .def("_kept_steps",
           [](Session& s) {
             return s.kept_steps() != nullptr ? std::optional(s.kept_steps()->count())
                                              : std::nullopt;
           })
      .def("_is_implicit",
           [](Session& s) { return s.simulation().built().dynamics().is_implicit(); })
      .def("_repeated_steps",
           [](Session& s) { return s.kept_steps() != nullptr ? s.kept_steps()->repeated() : 0; })
      .def("_run_adjoint", &run_adjoint)
      .def("_follow", &follow)
      .def("_followed", &followed)
      .def("_probe_vertices", &probe_vertices);
}

}  // namespace suture::python
