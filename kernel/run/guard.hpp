// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "kernel/base/diagnostics.hpp"
#include "kernel/run/world.hpp"

namespace suture {

/// Stops a run whose numbers have gone wrong: growing energy, inverted elements.
/// (Velocities that are not finite are found by the step itself.)
class Guard {
 public:
  Guard(const Scene& scene, World& world, Diagnostics& diagnostics);

  /// Looks at the present state; throws NumericalError with the step, the time,
  /// the cause and what to change. Cheap: a pass over the vertices and one over
  /// the elements; energies are summed only when the kinetic energy has doubled.
  void check(std::uint64_t step, double time, double dt);

  /// An operation has taken elements away or brought vertices together: the energy
  /// starts anew.
  void restart() { has_start_ = false; }

  std::uint64_t inverted_elements() const { return worst_inverted_; }

 private:
  void check_energy(std::uint64_t step, double time, double dt);
  void check_inversion(std::uint64_t step, double time);

  World& world_;
  Diagnostics& diagnostics_;
  bool stop_on_inversion_;
  Index inverted_at_rest_;    ///< admitted by the scene
  Index worst_inverted_ = 0;  ///< beyond those
  double quiet_after_;        ///< prescribed motions and pressures do work until then
  bool has_start_ = false;
  double start_energy_ = 0;      ///< total, when the run (or the quiet) began
  double verified_kinetic_ = 0;  ///< known to be paid for
};

}  // namespace suture
