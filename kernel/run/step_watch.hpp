// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/base/diagnostics.hpp"
#include "kernel/run/world.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Follows the stable step of a run. A search (Dynamics::stable_step()) costs as much as
/// 150 evaluations of the forces from random, 15 where it goes on from the last one, 30
/// where the cells are others since; the bound on its safe side of all vertices 22, of those that
/// an event changed what the event touched.
///  - A fixed dt below the bounds needs no search. An event that takes the bound of the
///    vertices it changed below dt is followed by one, at most every 512 steps.
///  - "auto" searches at the start and every 512 steps (3 % of the forces). An event lowers
///    the step to the bound of the vertices that it changed, if that is less: elsewhere
///    nothing is different, and the step was stable there.
///  - While events go on to lower the step, a search would be out of date at once. Every 512
///    steps the bound of all vertices takes its place (4 %), which follows the state both
///    ways; a search comes when 512 steps have passed without such an event, and at the latest
///    4096 steps after the one before (4 %). So a blade that cuts in every step costs a
///    shorter step, and neither a search for each cut nor a run without any.
/// Counted in steps, not seconds, so that a run is the same on every machine.
class StepWatch {
 public:
  StepWatch(const Scene& scene, World& world, Diagnostics& diagnostics)
      : scene_(scene), world_(world), diagnostics_(diagnostics) {}

  /// Throws PluginError or InputError if "auto" has nothing to go by.
  void start();
  /// The cells are others since `step` steps.
  void after_event(std::uint64_t step);
  void after_step(std::uint64_t step);
  /// Now, whatever dt is.
  void search(std::uint64_t step);

  /// The stable step, s, or with a fixed dt what is known of it: a bound, 0 if nothing.
  double stable() const { return stable_; }

 private:
  static constexpr std::uint64_t search_steps = 512, most_steps = 8 * search_steps,
                                 never = ~std::uint64_t{0};

  std::optional<double> bound(ForceLoop::Bounds (Dynamics::*which)());
  void compare();

  const Scene& scene_;
  World& world_;
  Diagnostics& diagnostics_;
  double stable_ = 0;
  std::uint64_t searched_ = 0, due_ = never;
  std::uint64_t lowered_ = 0;  ///< the step at which an event last lowered stable_
  bool warned_ = false;
};

}  // namespace suture
