// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/run/recorder.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {

/// Leaves out the cells between vertices that are held at rest for good, if nobody
/// asks for what they give: stress, reactions, energy.
Decision decide_still_cells(const Scene& scene, BuiltScene& built, const Recorder& recorder);

/// What was built, loaded and looped over for this scene, and what was skipped
/// and why. Plugins that several models share are named once per model. After
/// decide_still_cells().
std::vector<Decision> decide(const Scene& scene, PluginHost& host, BuiltScene& built,
                             const Recorder& recorder);

}  // namespace suture
