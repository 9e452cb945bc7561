// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/dynamics/rounding.hpp"
#include "kernel/dynamics/stagnation.hpp"

namespace suture {

/// Dynamic relaxation: decides when a body is at rest, and damps it so that it comes to rest
/// quickly.
///
/// At rest: after the last ramp and event, |f_int + f_ext| < tol |f_ext| over the free components
/// and kinetic < tol^2 elastic energy, in ten consecutive checks. With prescribed motion but no
/// load, the reactions replace f_ext; with neither, the forces and energy of rounding are used
/// (rounding.hpp). If no model provides its energy, half the work of gravity and dead loads
/// replaces it.
///
/// A body is also at rest if its residual has stopped decreasing (Stagnation) at the level of
/// rounding: if the positions are rounded by r in each step, a mode retains r^2 / (alpha dt) of it,
/// so forces within Rounding::force_squared (1 + 1/(16 alpha dt)) are noise. An automatic damping
/// is first raised until alpha dt = 1, which removes most of the noise and often ends the search.
/// limited_by_rounding() reports this case.
///
/// Damping: a mode of frequency w decays fastest with alpha = 2 w (critical damping), and the
/// slowest mode decides. Its frequency is estimated from the motion between two checks, in which
/// slow modes dominate (Rayleigh quotient):
///   w0^2 = - dx . df / (dx . M dx),   alpha = 2 w0
/// as long as - dx . df is more than a hundred times the contribution of rounding. Below that, the
/// quotient measures noise, in which the fastest modes dominate: the damping would grow until the
/// slow modes creep. Underwood, Dynamic relaxation, in: Computational Methods for Transient
/// Analysis (1983) 245-265; Papadrakakis, CMAME 25 (1981) 35-48.
class RestSearch {
 public:
  /// `choose_damping`: adapt alpha of the Dynamics; otherwise it is not changed.
  RestSearch(double tolerance, bool choose_damping);

  /// Do not accept rest before this time, because an event is still to come.
  void wait_until(double time) { earliest_ = std::max(earliest_, time); }

  /// Call after every step; checks every tenth. True at rest.
  bool at_rest(Dynamics& dynamics);

  /// At rest, although the residual is above the tolerance, because rounding limits it.
  bool limited_by_rounding() const { return limited_; }
  /// The residual has stopped decreasing above the level of rounding, and the last check was not
  /// one of those that show rest.
  bool stagnates() const { return passed_checks_ == 0 && stagnation_.stagnates(); }
  /// The reason, and what to do: one line for a warning or an error.
  std::string explanation(Dynamics& dynamics) const;

  /// The state was changed from outside: discards all observations.
  void restart();
  void state(Archive& archive);

  double residual() const { return residual_; }       ///< |f| / |f_ext| at the last check
  double unbalanced_force() const { return force_; }  ///< |f| at the last check, N
  double tolerance() const { return tolerance_; }

 private:
  void estimate_frequency(Dynamics& dynamics, const loops::RestSums& sums);
  bool quench(Dynamics& dynamics);
  double remaining_motion(Dynamics& dynamics, const loops::RestSums& sums) const;
  bool is_noise(const loops::RestSums& sums, const Dynamics& dynamics) const;

  double tolerance_;
  bool choose_damping_;
  double earliest_ = 0;
  double residual_ = 1;
  double motion_ = 0;  ///< sqrt(kinetic / elastic energy) at the last check of a small residual
  double force_ = 0;
  double frequency_ = 0;  ///< w0 at the last check above rounding, 1/s
  double dt_ = 0;         ///< mean step between the last two checks
  double checked_at_ = 0;
  double watched_time_ = 0;  ///< time that counts for stagnation, s
  Rounding rounding_;        ///< updated at every tenth check
  Stagnation stagnation_;
  RestSums sums_;
  bool limited_ = false;
  std::uint64_t quenched_until_ = 0;  ///< step; 0: the damping follows the motion
  std::uint64_t steps_ = 0;
  unsigned passed_checks_ = 0;
};

}  // namespace suture
