// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/results/recorder.hpp"
#include "kernel/run/run_report.hpp"

namespace suture {

class PluginHost;

/// Leaves out cells whose vertices are all permanently fixed, unless their stress, reactions or
/// energy are requested.
Decision decide_fixed_cells(const Scene& scene, BuiltScene& built, const Recorder& recorder);

/// Lists what was built, loaded and looped over for this scene, and what was skipped and why.
/// Plugins shared by several models are named once per model. Call after decide_fixed_cells().
std::vector<Decision> decide(const Scene& scene, PluginHost& host, BuiltScene& built,
                             const Recorder& recorder);

}  // namespace suture
