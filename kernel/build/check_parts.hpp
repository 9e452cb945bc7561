// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/parts.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Refuses what would act on, or show, whole faces of elements of which only a part is material, or
/// becomes so during the run; and, without such elements, what needs them. Throws one InputError
/// with a line "PATH: TEXT" for each.
void check_parts(const Scene& scene, const Parts& parts);

/// The same for an event during the run. `may_grow`: cuts along blades are allowed in it.
void check_parts(const Event& event, bool may_grow);

}  // namespace suture
