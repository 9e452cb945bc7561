// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernel/mesh/mesh.hpp"

namespace suture {

/// For each point, the first point that lies within `tolerance` (> 0, m) of it, by distance; most
/// often the point itself. A point that was matched with an earlier one is not matched with later
/// ones, so that points in a row do not become one. About 0.3 us per point.
std::vector<Index> first_in_place(std::span<const Vec3> points, double tolerance);

/// Makes points within `tolerance` one: cells and sets take the first of them, whose number and
/// values stay. The others are dropped; returns how many.
std::size_t merge_points(Mesh& mesh, double tolerance);

}  // namespace suture
