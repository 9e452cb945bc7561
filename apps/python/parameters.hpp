// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <string>

#include "kernel/attributes/instance.hpp"

namespace suture::python {

namespace py = pybind11;

/// {name: value} of a model: numbers, bools and the names of choices; of a parameter that the scene
/// gives by element, an array with one row per element of the model, and None of a direction.
py::dict parameters(const Instance& instance);

}  // namespace suture::python
