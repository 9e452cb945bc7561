// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/dynamics/rest_sums.hpp"
#include "kernel/dynamics/rounding.hpp"
#include "kernel/dynamics/stagnation.hpp"

namespace suture {

/// Dynamic relaxation: decides when a body is at rest, and damps it so that it
/// gets there soon.
///
/// At rest: after the last ramp and event, |f_int + f_ext| < tol |f_ext| over the
/// free components and kinetic < tol^2 elastic energy, ten checks running. With
/// no load but prescribed motion the reactions stand for f_ext; with neither, forces
/// and energy are those of rounding (rounding.hpp). Where no model knows its
/// energy, half the work of gravity and dead loads stands for it.
///
/// At rest, too, is a body whose residual has stopped falling (Stagnation) at the level
/// that rounding permits: with the positions rounded by r in each step, a mode keeps
/// r^2 / (alpha dt) of it, so forces within Rounding::force_squared (1 + 1/(16 alpha dt))
/// are noise. A chosen damping is first raised until alpha dt = 1, which takes most of the
/// noise away and often ends the search. limited_by_rounding() tells.
///
/// Damping: a mode of frequency w decays fastest with alpha = 2 w (critical), and
/// the slowest mode decides. Its frequency is estimated from the motion between
/// two checks, where slow modes prevail (Rayleigh's quotient):
///   w0^2 = - dx . df / (dx . M dx),   alpha = 2 w0
/// while - dx . df is above a hundred times what rounding adds to it. Below, the quotient
/// is that of noise, which the fastest modes have the most of: the damping would grow
/// until the slow modes creep.
/// Underwood, Dynamic relaxation, in: Computational Methods for Transient
/// Analysis (1983) 245-265; Papadrakakis, CMAME 25 (1981) 35-48.
class RestSearch {
 public:
  /// `choose_damping`: alpha of the Dynamics is chosen, else left alone.
  RestSearch(double tolerance, bool choose_damping);

  /// Not before this time: an event is still to come.
  void wait_until(double time) { earliest_ = std::max(earliest_, time); }

  /// After every step; checks every tenth. True at rest.
  bool at_rest(Dynamics& dynamics);

  /// At rest, but the residual is above the tolerance: rounding allows no less.
  bool limited_by_rounding() const { return limited_; }
  /// The residual has stopped falling, above what rounding explains.
  bool stagnates() const { return stagnation_.stagnates(); }
  /// Why, and what to do: one line for a warning or an error.
  std::string explanation(Dynamics& dynamics) const;

  /// The state was changed from outside: what was seen of it no longer counts.
  void restart();
  void state(Archive& archive);

  double residual() const { return residual_; }       ///< |f| / |f_ext| at the last check
  double unbalanced_force() const { return force_; }  ///< |f| at the last check, N
  double tolerance() const { return tolerance_; }

 private:
  void look_at_motion(Dynamics& dynamics, const loops::RestSums& sums);
  bool quench(Dynamics& dynamics);
  double motion_left(Dynamics& dynamics, const loops::RestSums& sums) const;
  bool is_noise(const loops::RestSums& sums, const Dynamics& dynamics) const;

  double tolerance_;
  bool choose_damping_;
  double earliest_ = 0;
  double residual_ = 1;
  double force_ = 0;
  double frequency_ = 0;  ///< w0 of the last check that was above rounding, 1/s
  double dt_ = 0;         ///< of the steps between the last two checks, on average
  double checked_at_ = 0;
  double watched_ = 0;  ///< time that counts for the stagnation, s
  Rounding rounding_;   ///< looked up at every tenth check
  Stagnation stagnation_;
  RestSums sums_;
  bool limited_ = false;
  std::uint64_t quenched_until_ = 0;  ///< step; 0: the damping follows the motion
  std::uint64_t steps_ = 0;
  unsigned good_checks_ = 0;
};

}  // namespace suture
