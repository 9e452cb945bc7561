// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "kernel/attributes/instance.hpp"
#include "kernel/build/select.hpp"
#include "kernel/dynamics/body.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// The array that `values` of elements or of nodes name: of two with this name, the one that
/// belongs to the same kind of cell. Null if there is none.
const MeshArray* find_array(const std::vector<MeshArray>& arrays, const CellValues& values,
                            bool of_elements);

/// The names of the arrays that a scene reads.
std::set<std::string> arrays_of(const Scene& scene);

/// The values that the scene gives to the columns of each of its models, in their order, per
/// element or vertex of the complex; values of points are averaged over the nodes of an element,
/// and directions have length 1. `place_of`: where an element (3) or vertex (0) is, for messages.
/// Throws InputError with one line per mistake, each with its JSON path: an array that the mesh
/// does not have or that does not fit, a value that is missing, not finite or out of range, a
/// direction of length zero.
std::vector<std::vector<GivenColumn>> given_columns(
    const Scene& scene, const Selector& selector, const Body& body, const MeshNames& names,
    const std::function<std::string(int dimension, Index cell)>& place_of);

}  // namespace suture
