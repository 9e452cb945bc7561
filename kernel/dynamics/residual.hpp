// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/dynamics/motion.hpp"

namespace suture {

/// The forces on the vertices in the current state, m a without damping:
///   r = f + m g
/// f: the column `force`, which must be evaluated (Motion::evaluate), with the forces of contact
/// where these count (ForcesOfStep). At components that are held, r is minus the reaction.
/// O(terms) to make, O(1) per vertex.
class Residual {
 public:
  explicit Residual(const Motion& motion);

  /// r, N.
  Vec3 force(Index vertex) const;
  /// r, 0 at components that are held, N.
  Vec3 free_force(Index vertex) const;
  /// f / m + g - alpha v, m/s^2; 0 without mass. Held components are not left out.
  Vec3 acceleration(Index vertex) const;

 private:
  Attributes& attributes_;
  Vec3 gravity_;
  double damping_;
};

/// The work of a step by the trapezoidal rule: the mean of the forces at its ends, times the way.
/// Made at its start, from the evaluated forces there.
class StepWork {
 public:
  /// Keeps the current state for restore() before it evaluates the forces, which may throw the
  /// errors of terms.
  void begin(Motion& motion);
  /// The sums of the step that ends in the current state, whose forces are evaluated. `losses`:
  /// what counts as damped: the work of mass damping, or all that the kinetic energy of what is
  /// free lacks. O(vertices).
  enum class Losses { damping, all };
  StepSums sums(const Motion& motion, Losses losses = Losses::damping) const;
  /// Takes positions and velocities back to the start.
  void restore(const Motion& motion) const;
  // At the start, rows of 4:
  const std::vector<double>& position() const { return position_; }
  const std::vector<double>& velocity() const { return velocity_; }

 private:
  std::vector<double> position_, velocity_, force_;
  Vec3 gravity_{};
};

/// Forces of a state that are not in the column `force`, and the inertia that they balance:
///   r = f + (load - held back) - m (acceleration (x - x*) + alpha v)
struct ForceRows {
  const double *force, *load;         ///< of the models; of all else, with gravity: rows of 4, N
  std::span<const double> held_back;  ///< N, 3 numbers per vertex; empty: none
  double acceleration;                ///< 1/s^2
  const double* position;             ///< x*, rows of 4
};
/// Writes r, 0 at components that are held, 3 numbers per vertex. Returns the forces beside which r
/// is small: the largest of the norms of loads and inertia where it is free, and of the reactions
/// where it is held, N. O(vertices).
double find_residual(const Motion& motion, const ForceRows& rows, std::span<double> residual);

/// The sums over the vertices for the search for rest (loops::RestSums): residual forces, and their
/// change since the previous call, in vectors. 64 B per vertex.
class RestSums {
 public:
  /// The sums in the current state; evaluates the forces, which the next step uses.
  loops::RestSums evaluate(Motion& motion);
  void state(Archive& archive);

 private:
  AlignedVector<double> old_position_, old_force_, external_;
  std::uint64_t jumps_ = 0;  ///< of the motion, at the previous call
};

}  // namespace suture
