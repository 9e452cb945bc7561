// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/scene/scene.hpp"
#include "kernel/scene/select.hpp"

namespace suture {

/// What only the mesh can tell: regions, constraints, loads, conditions and probes that select
/// nothing, sets and numbers that it does not have, elements without a model. Throws one
/// InputError with a line "PATH: TEXT" for each. As long as the selections take by themselves.
void check_selections(const Scene& scene, const Selector& selector);

}  // namespace suture
