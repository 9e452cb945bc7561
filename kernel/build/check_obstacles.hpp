// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/diagnostics.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

class Contact;

/// Checks what depends on the mesh: obstacles that start inside the body, that move too fast for a
/// fixed dt, or that are far from the body (a warning). Throws one InputError with a line
/// "PATH: TEXT" for each mistake.
void check_obstacles(BuiltScene& built, const Contact& contact, Diagnostics& diagnostics);

/// Says why a fixed dt is too long for the path of an obstacle from `time` on; "" if it is not.
std::string too_fast(const Obstacle& obstacle, const ContactLaw& contact,
                     const SolverOptions& solver, double time);

/// Checks that pieces which touch each other do not overlap: a warning where contact pushes them
/// apart, an InputError where they are too deep for it.
void check_pieces(BuiltScene& built, const Contact& contact, Diagnostics& diagnostics);

/// Names pieces that are in each other more deeply than contact acts, one per line: they met too
/// fast. Empty if there are none. For the end of a run.
std::string deep_overlaps(BuiltScene& built);

}  // namespace suture
