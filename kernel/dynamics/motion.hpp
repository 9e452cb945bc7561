// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/body.hpp"
#include "kernel/dynamics/motion_sums.hpp"
#include "kernel/forces/loops/loops.hpp"
#include "kernel/geometry/element_blocks.hpp"

namespace suture {

struct ContactStep;

/// A velocity, a force or an energy is not finite.
class NotFinite : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// A kick over h with damping alpha: v' = decay v + gain a, exact for constant a.
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

/// The time of a body's columns, the forces at that time, and the passes over its vertices of which
/// explicit integrators consist. a = f/m + acceleration of the terms.
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

  /// Starts a motion at `time`; nothing has moved yet.
  void start(double time);

  /// Evaluates the forces at (x, v, time) into the column `force`, for a step of length dt. Throws
  /// the errors of terms; the state is intact then.
  void evaluate(double dt);
  /// The same as the step before has left them.
  void evaluate() { evaluate(end_dt_); }
  /// Throws NotFinite, naming the vertex, unless the evaluated forces are finite; steps find this
  /// out themselves. O(vertices).
  void require_finite_forces() const;
  /// What the scheme did not exert of the evaluated forces in its last step, negative, N: the sum
  /// is 0 where the scheme is at rest. Rows of 4, until the forces are evaluated again; empty for
  /// schemes that exert all.
  void withhold(std::vector<double> rows) { withheld_ = std::move(rows); }
  const std::vector<double>& withheld() const { return withheld_; }
  /// The forces must be evaluated again.
  void discard_forces();
  /// The state was changed other than by a step.
  void forget_forces();
  /// The same by an operation, whose `change` is complete in the body.
  void follow(const TopologyChange& change);

  /// Where blocks of elements are now. O(vertices), but for the first call, in O(elements). Passes
  /// of drifts then keep it up for a while, so that it is O(1) after steps without contact.
  const ElementBlocks& blocks();
  /// How often the state was changed other than by a step.
  std::uint64_t jumps() const { return jumps_; }

  /// Applies one or two successive kicks with the evaluated forces, then drifts over dt and moves
  /// constrained vertices to their positions at `end`, and vertices in obstacles out of them.
  /// `unseen`: the length of the previous step if
  /// no pass has used the forces at its end yet, otherwise 0. Throws NotFinite, naming the vertex.
  void kick_and_drift(std::span<const Kick> kicks, double dt, double end, double unseen);
  /// One kick of the moving vertices, at the end of the last step.
  void kick(const Kick& kick);
  /// Ends a step of length dt of an implicit scheme, which has moved the vertices itself to their
  /// positions at `end`, and evaluates the forces there: outside a step, as the states of models
  /// are those at `end` already.
  void arrive(double dt, double end);
  /// sum m v^2 / 2 of the velocities that a kick would give, in a fixed order, J.
  double kinetic(const Kick& kick);
  /// sum m a . v- with the current velocities, W.
  double power();
  /// sum m |v+ - v-|^2 / 8 over free components, h^2/8 sum F^2/m without damping: the difference
  /// between the energy of the mean velocity and the leapfrog energy sum m v- . v+ / 2.
  double leapfrog_part(double h);

  /// The parts of kinetic(), power() and leapfrog_part(last_step()) of some vertices, with these
  /// forces of the terms on them. O(vertices).
  struct Sums {
    double kinetic = 0, power = 0, leapfrog = 0;
  };
  Sums sums_at(std::span<const Index> vertices, std::span<const Vec3> forces,
               const Kick& kick) const;

  /// sum m v- . v-: of free components, and with the mean velocity of the last step of driven ones,
  /// J.
  double inertia() const;
  /// The part of some vertices that are not driven.
  double inertia_at(std::span<const Index> vertices) const;

  /// Stops the vertices and sets their velocities to zero; the evaluated forces remain valid.
  void freeze(std::span<const Index> vertices);
  void thaw();
  /// Leaves only these vertices frozen, which are so already. The others begin with velocity zero
  /// and the forces that they have kept.
  void thaw_except(std::span<const Index> vertices);
  bool is_frozen() const { return frozen_; }
  /// Whether this process makes passes over its own vertices and the common ones only.
  bool divides() const;
  /// The rows of others that it does not read in steps take no memory until somebody asks for them.
  /// Passes do so, too.
  void release_rows_of_others();
  const LiveMask& moving() const;  ///< vertices that exist and are not frozen

  /// The vertex with the largest kinetic energy in the chunk with the largest apparent frequency.
  Index fastest_vertex() const;
  void state(Archive& archive);

 private:
  loops::Motion pass(std::span<const Kick> kicks) const;
  ContactStep contact_step(std::span<const Kick> kicks, double dt, double end) const;
  Places places() const { return {body_.attributes().position().rows()}; }
  bool keeps_blocks();
  double resolve_contact(const ContactStep& step);
  template <class Chunk>
  bool for_each_chunk(bool divides, Chunk chunk) const;
  double sum_over_vertices(const loops::Motion& m, loops::VertexSum sum) const;
  void drift_driven_of_others(double dt, double end);
  bool join_pass(bool good);
  void clear_forces();
  /// The first vertex in begin .. end-1 whose force must be finite and is not; or `none`.
  using FirstNotFinite = std::function<Index(const Column& force, Index begin, Index end)>;
  void require_finite_forces(bool divides, const FirstNotFinite& first) const;
  void require_finite_reactions(bool divides) const;
  [[noreturn]] void refuse_vertex(const char* what, Index vertex) const;
  [[noreturn]] void refuse_not_finite() const;

  Body& body_;
  const loops::Table& loops_;
  double damping_, time_ = 0, last_ = 0;
  double end_dt_ = 0;  // of the forces with which a step ends
  MotionSums sums_;
  bool evaluated_ = false;  // the column `force` belongs to the current state
  double evaluated_dt_ = 0;
  std::vector<double> withheld_;
  std::uint64_t jumps_ = 0;
  bool frozen_ = false;  // some vertices are
  LiveMask awake_;       // vertices, while some are frozen
  std::optional<ElementBlocks> blocks_;
  bool is_placed_ = false;          // blocks_ are of the present positions
  unsigned steps_since_asked_ = 0;  // for blocks_
  std::uint64_t requests_ = 0;      // for rows of other processes, before the last pass
  unsigned passes_alone_ = 0;       // passes since then
};

}  // namespace suture
