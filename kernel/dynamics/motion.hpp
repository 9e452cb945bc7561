// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/body.hpp"
#include "kernel/dynamics/motion_sums.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace suture {

/// A velocity or an energy is infinite or no number.
class NotFinite : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// Kick over h with damping alpha: v' = decay v + gain a, exact for constant a.
///   decay = exp(-alpha h),  gain = (1 - decay) / alpha,  h without damping
struct Kick {
  double decay = 1, gain = 0;
  Kick() = default;
  Kick(double alpha, double h) : gain(h) {
    if (alpha == 0) return;
    decay = std::exp(-alpha * h);
    gain = -std::expm1(-alpha * h) / alpha;
  }
};

/// Where in time the columns of a body are, the forces there, and the passes over its vertices
/// that explicit integrators consist of. a = f/m + acceleration of the terms.
class Motion {
 public:
  Motion(Body& body, double damping);

  Body& body() const { return body_; }
  double time() const { return time_; }        ///< of the positions, s
  double last_step() const { return last_; }   ///< s; 0 before the first
  double damping() const { return damping_; }  ///< alpha, 1/s: f = -alpha m v
  void set_damping(double alpha) { damping_ = alpha; }
  MotionSums& sums() { return sums_; }
  const MotionSums& sums() const { return sums_; }

  /// Nothing has moved yet.
  void start(double time);

  /// The column `force` holds those of (x, v, time), for a step of dt. Throws what terms throw,
  /// and then the state is whole.
  void evaluate(double dt);
  void evaluate() { evaluate(last_); }
  /// They must be evaluated again.
  void discard_forces();
  /// The state is another, and not by a step.
  void forget_forces();
  /// How often the state was another otherwise than by a step.
  std::uint64_t jumps() const { return jumps_; }

  /// Kicks by evaluated forces, one after the other (one or two), then a drift over dt, and what
  /// is held is put where it is at `end`. `unseen`: length of the step before, if no pass has
  /// seen the forces at its end yet, else 0. Throws NotFinite, naming the vertex.
  void kick_and_drift(std::span<const Kick> kicks, double dt, double end, double unseen);
  /// One kick of what moves, at the end of the last step.
  void kick(const Kick& kick);
  /// sum m v^2 / 2 of the velocities that a kick would make; in a fixed order, J.
  double kinetic(const Kick& kick);
  /// sum m a . v- of the velocities as they are, W.
  double power();
  /// h^2/8 sum F^2/m over what is free, forces being evaluated: what leapfrog's energy
  /// sum m v- . v+ / 2 lacks of that of the mean velocity.
  double leapfrog_part(double h, Kick at);

  /// The vertices move no more, and their velocities are zero; with the forces as evaluated.
  void freeze(std::span<const Index> vertices);
  void thaw();
  bool is_frozen() const { return frozen_; }

  /// The vertex with the most kinetic energy where the apparent frequency is largest.
  Index fastest_vertex() const;
  void state(Archive& archive);

 private:
  loops::Motion pass(std::span<const Kick> kicks) const;
  template <class Chunk>
  bool for_each_chunk(Chunk chunk) const;
  const LiveMask& moving() const;
  void clear_forces();
  [[noreturn]] void refuse_not_finite() const;

  Body& body_;
  const loops::Table& loops_;
  double damping_, time_ = 0, last_ = 0;
  MotionSums sums_;
  bool evaluated_ = false;  // the column `force` is that of the present state
  double evaluated_dt_ = 0;
  std::uint64_t jumps_ = 0;
  bool frozen_ = false;  // some vertices are
  LiveMask awake_;       // vertices, while some are frozen
};

}  // namespace suture
