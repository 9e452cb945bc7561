// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <memory>

#include "kernel/mesh/mesh.hpp"

namespace suture::python {

/// The mesh of a suture.Mesh, which has checked its shapes and numbers; null for None.
std::shared_ptr<const Mesh> mesh_of(const pybind11::object& mesh);

}  // namespace suture::python
