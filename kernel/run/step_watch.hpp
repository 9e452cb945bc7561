// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/base/diagnostics.hpp"
#include "kernel/run/world.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Follows the stable step of a run. A search (Dynamics::stable_step()) costs as much as
/// some hundred steps, the bound on its safe side as much as two:
///  - a fixed dt below the bound needs no search, and an event one at most every 512 steps;
///  - "auto" searches at the start and every 512 steps (3 % of the forces); an event takes
///    the step down to the bound until 512 steps have passed without another, so that a
///    blade that cuts in every step costs a shorter step and not a search for each.
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
  static constexpr std::uint64_t search_steps = 512, never = ~std::uint64_t{0};

  std::optional<double> bound();
  void compare();

  const Scene& scene_;
  World& world_;
  Diagnostics& diagnostics_;
  double stable_ = 0;
  std::uint64_t searched_ = 0, due_ = never;
  bool warned_ = false;
};

}  // namespace suture
