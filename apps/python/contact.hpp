// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include "kernel/run/simulation.hpp"

namespace suture::python {

namespace py = pybind11;

// Copies of what a simulation knows of contact, now or of the last step.

/// (vertices, 3): on every vertex, by obstacles and other pieces, N. Raises AttributeError without
/// contact, as gap().
py::array contact_force(Simulation& simulation);
/// (vertices,): the distance from the nearest obstacle, m; NaN inside the body.
py::array gap(Simulation& simulation);

/// The names of all obstacles.
py::list tool_names(Simulation& simulation);
/// (force, torque, translation, rotation, hand force, hand torque), arrays of 3; the last two are
/// None unless the obstacle is compliant.
py::tuple tool_state(Simulation& simulation, std::size_t obstacle);

}  // namespace suture::python
