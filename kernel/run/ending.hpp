// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "kernel/dynamics/rest_search.hpp"
#include "kernel/run/run_report.hpp"
#include "kernel/run/stability.hpp"
#include "kernel/steps/free_bodies.hpp"
#include "kernel/steps/step_control.hpp"

namespace suture {

/// Decides when and how a run ends: at its end time, at rest, or because it can reach neither.
class Ending : private Follower {
 public:
  Ending(BuiltScene& built, const EventSchedule& schedule, StepControl& control, Recorder& recorder,
         Diagnostics& diagnostics);

  /// Call after a step and everything due at its time. Returns how the run ended, or none. Throws
  /// NumericalError for a body that never comes to rest, and at the limit of steps. May roll back
  /// to an earlier step.
  std::optional<RunSummary::Outcome> check(const StepControl::Notify& notify);

  /// In a static run, call after an event and before the next equilibrium. Throws NumericalError
  /// for a piece that nothing holds, or reports it where it may float.
  void check_pieces(const StepControl::Notify& notify);

  /// The search for rest, for a run that ends at rest.
  RestSearch* rest() { return rest_ ? &*rest_ : nullptr; }
  std::optional<double> lowest_eigenvalue() const { return stability_.lowest_eigenvalue(); }
  void state(Archive& archive);

 private:
  using Outcome = RunSummary::Outcome;
  void follow(const CellComplex&, const TopologyChange&) override { cells_changed_ = true; }
  void require_supported();
  std::optional<Outcome> check_rest(const StepControl::Notify& notify);
  std::optional<Outcome> examine(const StepControl::Notify& notify);
  Outcome examine_equilibrium();
  void warn_of_motion();
  [[noreturn]] void fail_at_step_limit(std::uint64_t limit) const;

  BuiltScene& built_;
  const Scene& scene_;
  StepControl& control_;
  Diagnostics& diagnostics_;
  Stability stability_;
  std::optional<RestSearch> rest_;
  bool cells_changed_ = false;  // since the last check for free pieces
  HeldPieces held_pieces_;
};

}  // namespace suture
