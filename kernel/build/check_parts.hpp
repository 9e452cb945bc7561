// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/parts.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Refuses what needs elements of which only a part is material in a scene that has none and makes
/// none. Throws InputError "PATH: TEXT".
void check_parts(const Scene& scene, const Parts& parts);

/// Refuses an event during the run that would make such elements, unless `may_grow`.
void check_parts(const Event& event, bool may_grow);

}  // namespace suture
