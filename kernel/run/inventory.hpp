// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/build/built_scene.hpp"

namespace suture {

/// What the sets, models and loads of a scene act on, one line each, in the order of the scene:
///   set 'vessel': 84 nodes, 40 elements, 3.1e-06 m^3
///   model 'tissue': 960 elements, 0.0003 m^3
///   load 0: 1000 Pa on 0.0025 m^2, [0, 0, -2.5] N in total
/// A selection by corners leaves out chamfered triangles at the edge of a face; here one sees it.
/// Resultants hold for the body at rest, after the ramp. O(elements) for each set and model.
std::vector<std::string> take_inventory(BuiltScene& built);

}  // namespace suture
