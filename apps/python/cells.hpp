// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include "kernel/build/built_scene.hpp"

namespace suture::python {

namespace py = pybind11;

// Numbers of cells as arrays. Rows of vertex columns are vertices, rows of element columns are
// elements; both stay where they are, so removed ones leave holes.

/// (vertices,) int64: the mesh point of each vertex, by the user's number.
py::array point_ids(const BuiltScene& built);
/// (elements,) int64: the user's number of each element.
py::array element_ids(const BuiltScene& built);
/// (cells,) bool: false where a vertex (0) or element (3) was removed.
py::array exists(const BuiltScene& built, int dimension);
/// (k, 8) int64: vertices of the existing elements, in VTK's order.
py::array hexahedra(const BuiltScene& built);
/// Returns the vertices of the boundary faces, (k, 4) int64, counterclockwise as seen from outside,
/// and their elements, (k,) int64.
py::tuple boundary(const BuiltScene& built);
/// The named sets of the mesh as they are now: {name: existing vertices} and {name: existing
/// elements}, int64 and ascending. What was copied belongs to the sets of its origin.
py::tuple sets(const BuiltScene& built);
/// The surface of a body with partial elements: triangles (k, 3) int64 of points, the row of the
/// element of each, whether a cut or a removal laid it open and the number of the cut that did,
/// else -1 (k,), and of the points 8 vertices and their weights (n, 8), those that are not needed
/// with the weight 0. None for other bodies.
py::object embedded_surface(BuiltScene& built);
/// (k, 2) int64: pairs of elements by the user's numbers.
py::array named(const BuiltScene& built, const std::vector<std::array<Index, 2>>& pairs);

}  // namespace suture::python
