// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/python/session.hpp"

namespace suture::python {

namespace py = pybind11;

/// The derivatives of the equilibrium that a simulation is in: what _gradients.py builds on. All
/// raise InputError with the reason if there are none.
void bind_gradients(py::class_<Session>& session);

}  // namespace suture::python
