// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/diagnostics.hpp"
#include "kernel/scene/built_scene.hpp"

namespace suture {

/// Before a search for rest: warns of pieces that nothing holds, with their free motions.
/// Throws InputError for a piece that the final loads push along a free translation, if the
/// scene gives no end and no event that could change it: such a body never comes to rest.
/// A model whose tangent resists the motion, or that has none to ask, holds too.
void look_for_free_bodies(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics);

/// The same after the last event, which may have cut a piece off: what falls, or "". "" too
/// while an event is still to come, or may be.
std::string falling_body(const Scene& scene, BuiltScene& built);

}  // namespace suture
