// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/run/simulation.hpp"

namespace suture {

/// Applies an input to a run now, as recordings hold it (docs/live.md): an event without a time, or
/// one of {"move": ...}, {"steer": ...}, {"sweep": ...}, {"parameters": ...}, {"gravity": ...}.
/// Throws InputError for what is not understood, and the errors of Simulation; nothing has changed
/// then.
void apply_input(const std::string& value, const Scene& scene, Simulation& simulation,
                 Observer& observer, Diagnostics& diagnostics);

}  // namespace suture
