// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/build/built_scene.hpp"

namespace suture {

/// Called before a search for rest: warns of unconstrained pieces, with their free motions. Throws
/// InputError for a piece that the final loads push along a free translation, if the scene has no
/// end time and no event that could change this: such a body never comes to rest. A model whose
/// tangent resists the motion also holds the piece, as may one without a tangent.
void check_free_bodies(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics);

/// The same after the last event, which may have cut a piece off: describes the falling piece, or
/// returns "". Also returns "" while another event is or may be still to come.
std::string describe_falling_body(const Scene& scene, BuiltScene& built);

/// For static equilibria: describes a piece that nothing holds, "a piece of 8 elements (the first:
/// element 3) is free to move along x", or returns "".
std::string describe_unheld_body(BuiltScene& built);

/// The same, even if contact may hold it.
std::string describe_body_without_constraints(BuiltScene& built);

/// The pieces that inertia relief holds, so that each is reported once: by their first element.
class HeldPieces {
 public:
  /// Describes those that were not known yet.
  std::vector<std::string> added(BuiltScene& built);
  void state(Archive& archive);

 private:
  std::vector<Index> known_;
};

}  // namespace suture
