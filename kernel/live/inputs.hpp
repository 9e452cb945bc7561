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

/// The message about JSON that does not have the form of the input `name`: what was sent, and that
/// form. Another name: the form of all inputs of a page.
std::string not_understood(const std::string& given, const std::string& name);

/// ", did you mean 'X'?" for an input of a page that there is not, or nothing.
std::string similar_input(const std::string& name);

}  // namespace suture
