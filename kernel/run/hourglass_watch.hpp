// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/scene/built_scene.hpp"

namespace suture {

/// A warning if the body as it is has hourglassed, "" if not (a body that still moves: only
/// where no continuum resists that): how many elements have an
/// alternating part above half their strain, the worst of them, and what to do. A few
/// elements are none, as around a force on one node: at least 64, or a tenth of a small
/// body and 8.
std::string hourglass_warning(const Scene& scene, BuiltScene& built, bool at_rest);

}  // namespace suture
