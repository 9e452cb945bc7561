// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "kernel/dynamics/dynamics.hpp"

namespace suture {

/// Dynamic relaxation: decides when a body is at rest, and damps it so that it
/// gets there soon.
///
/// At rest: after the last ramp and event, |f_int + f_ext| < tol |f_ext| over the
/// free components and kinetic < tol^2 elastic energy, ten checks running. With
/// no load but prescribed motion the reactions stand for f_ext; with neither, forces
/// and energy are those of rounding (Dynamics::rounding()).
///
/// Damping: a mode of frequency w decays fastest with alpha = 2 w (critical), and
/// the slowest mode decides. Its frequency is estimated from the motion between
/// two checks, where slow modes prevail (Rayleigh's quotient):
///   w0^2 = - dx . df / (dx . M dx),   alpha = 2 w0
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

  double residual() const { return residual_; }  ///< |f| / |f_ext| at the last check
  double tolerance() const { return tolerance_; }

 private:
  void tune(Dynamics& dynamics, const loops::RestSums& sums);

  double tolerance_;
  bool choose_damping_;
  double earliest_ = 0;
  double residual_ = 1;
  std::uint64_t steps_ = 0;
  unsigned good_checks_ = 0;
};

}  // namespace suture
