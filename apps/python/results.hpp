// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <string>

#include "kernel/results/probe_table.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::python {

namespace py = pybind11;

// What frames and probes contain, now and as copies.

/// The fields of vertices and elements: a list of (name, "vertices" or "elements", components,
/// unit).
py::list fields(Simulation& simulation);
/// (cells,) or (cells, components): a field of frames; NaN where no model provides it. Throws
/// InputError for an unknown name, with the nearest and all others.
py::array field(Simulation& simulation, const std::string& name);
/// {probe: {field: value}}: a number, or an array of (components,).
py::dict probes(Simulation& simulation, ProbeTable& table);

}  // namespace suture::python
