// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/build/select.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Checks what depends on the mesh: regions, constraints, loads, conditions and probes that select
/// nothing, sets and numbers that do not exist, elements without a model. Throws one InputError
/// with a line "PATH: TEXT" for each. Takes as long as the selections themselves.
void check_selections(const Scene& scene, const Selector& selector);

}  // namespace suture
