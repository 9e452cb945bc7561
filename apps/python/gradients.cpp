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
  return ParameterSlopes(simulation.built().body(), simulation.time(),
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

/// The multipliers of all steps, from arrays (steps, vertices, 3) and (steps,).
std::vector<Multipliers> multipliers_of(const KeptSteps& steps, const Array& forces,
                                        const Array& energies) {
  const std::size_t count = steps.count();
  if (forces.ndim() != 3 || static_cast<std::size_t>(forces.shape(0)) != count ||
      static_cast<std::size_t>(energies.size()) != count)
    throw InputError("steps were made or forgotten since this adjoint; take it again");
  std::vector<Multipliers> multipliers;
  const auto size = static_cast<std::size_t>(forces.size()) / count;
  for (std::size_t step = 0; step < count; ++step) {
    const double* from = forces.data() + step * size;
    multipliers.push_back({{from, from + size}, energies.data()[step]});
  }
  return multipliers;
}

/// (forces, energies, by position, by velocity, iterations) of a run. slopes_at(step) gives
/// (dJ/du, dJ/dW), or None, in the state after a step.
py::tuple run_adjoint(Session& session, const py::function& slopes_at, double tolerance) {
  const RunAdjoint found = kept_steps(session).adjoint(
      [&](std::size_t step) {
        ObjectiveSlopes slopes;
        const py::object given = slopes_at(step);
        if (given.is_none()) return slopes;
        const auto [displacement, energy] = given.cast<std::pair<Array, double>>();
        slopes.displacement = of_vertices(session, displacement, "dJ/du");
        slopes.energy = energy;
        return slopes;
      },
      tolerance);
  const auto count = static_cast<py::ssize_t>(found.steps.size());
  py::array_t<double> forces(
      {count, static_cast<py::ssize_t>(found.position.size() / 3), py::ssize_t{3}}),
      energies(count);
  double* to = forces.mutable_data();
  for (py::ssize_t step = 0; step < count; ++step) {
    const Multipliers& multipliers = found.steps[static_cast<std::size_t>(step)];
    to = std::ranges::copy(multipliers.force, to).out;
    energies.mutable_data()[step] = multipliers.energy;
  }
  return py::make_tuple(forces, energies, rows_of_3(found.position), rows_of_3(found.velocity),
                        found.iterations);
}

py::array run_gradient(Session& session, std::size_t model, const std::string& name,
                       const Array& forces, const Array& energies) {
  KeptSteps& steps = kept_steps(session);
  const std::vector<double> values =
      steps.each(*session.simulation().attributes().instances().at(model), name,
                 multipliers_of(steps, forces, energies));
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

double run_gradient_along(Session& session, std::size_t model, const std::string& name,
                          const Array& forces, const Array& energies, const Array& weights) {
  KeptSteps& steps = kept_steps(session);
  return steps.along(*session.simulation().attributes().instances().at(model), name,
                     weights_of(slopes_of(session, model, name), weights),
                     multipliers_of(steps, forces, energies));
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
  session
      .def("equilibrate", &Session::equilibrate,
           "Find the equilibrium of a static run again, from the current positions and at the same "
           "time: after parameters, loads or cells were changed.")
      .def("_adjoint", &adjoint)
      .def("_along_rest", &along_rest)
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
      .def("keep_steps", &Session::keep_steps,
           "Keep the steps of implicit Euler from now on, for the derivatives of the run from "
           "here: 24 B per vertex and step. Those that were kept before are forgotten.")
      .def("_kept_steps",
           [](Session& s) {
             return s.kept_steps() != nullptr ? std::optional(s.kept_steps()->count())
                                              : std::nullopt;
           })
      .def("_run_adjoint", &run_adjoint)
      .def("_run_gradient", &run_gradient)
      .def("_run_gradient_along", &run_gradient_along)
      .def("_probe_vertices", &probe_vertices);
}

}  // namespace suture::python
