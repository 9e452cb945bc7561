// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/constraints.hpp"
#include "kernel/dynamics/motion_sums.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/forces/loads.hpp"

namespace suture {

/// Gravity, m/s^2, with its ramp.
struct Gravity {
  Vec3 value{};
  TimeRamp ramp;
  Vec3 at(double time) const;
};

/// Where the energy of a run is and where it came from, J. Works and `events` count from the
/// start of the run:
///   kinetic + elastic = their sum at the start
///       + gravity + loads + pressure + prescribed + models + events - dissipated + balance
struct EnergyBalance {
  double kinetic = 0;     ///< sum m v^2 / 2, v at the time of the positions
  double elastic = 0;     ///< of all functors with an energy
  double gravity = 0;     ///< work of gravity
  double loads = 0;       ///< work of forces and tractions
  double pressure = 0;    ///< work of pressures, which follow the surface
  double prescribed = 0;  ///< work of prescribed motion: reactions times displacements
  double models = 0;      ///< work of functors without an energy
  double events = 0;      ///< given (or taken: negative) by operations and by sleep
  double dissipated = 0;  ///< by damping and by functors that read velocities
  double balance = 0;     ///< what nothing explains
  /// Part of the balance that a step of this length gives back: h^2/8 sum F^2/m, now less at the
  /// start.
  double recoverable = 0;
  /// The most that has been exchanged at a look so far: the scale for `balance`.
  double exchanged = 0;
};

/// Accounts for the energy of a run: every work by the trapezoid, forces of both ends of a step
/// times its displacements, so that `balance` falls with dt^2 (Belytschko, Liu, Moran, Nonlinear
/// Finite Elements, 6.2.3). For forces that are linear in the displacements it equals
/// h^2/8 sum F^2/m at each moment. What an unstable step feeds is in the stored energy,
/// therefore `elastic` is evaluated and not summed up.
///
/// Cost: three sums in the pass over the vertices that is made anyway, the loaded and driven
/// vertices; gravity one pass per look and, while its ramp lasts, per step; functors without an
/// energy beside others with one a pass per step.
class Ledger {
 public:
  Ledger(Attributes& attributes, ForceLoop& forces, Loads& loads, Constraints& constraints,
         const Gravity& gravity);

  MotionSums sums;

  /// Adds the forces of models and loads at `time` to the column `force`, for the first time
  /// there or again. dt: of the step to come; last_dt: of the one before.
  void add_forces(double time, double dt, double last_dt, const LiveMask& live);
  /// The passes of a step were made: the forces to come are those of another state.
  void step_made() { fed_is_booked_ = false; }

  /// The present state, with forces evaluated there.
  struct Now {
    double time = 0;
    double kinetic = 0;        ///< at the time of the positions, J
    double leapfrog_part = 0;  ///< h^2/8 sum F^2/m, J
    double half_step = 0;      ///< h- where velocities lag half a step behind the positions, else 0
    double work = 0;           ///< h- A_n / 2: of all forces in the half step that no pass has seen
  };
  /// The first call is the start. Costs an evaluation of energies.
  EnergyBalance balance(const Now& now);
  bool needs_work() const;  ///< Now::work is used

  /// Around an operation that removes or joins elements, or puts vertices to sleep: the jump of
  /// the energy is booked under `events`.
  void before_jump(const Now& now);
  void after_jump(const Now& now);
  /// The step is another: its energy differs from that of the motion by `difference` more, J.
  void change_step(double difference) { account_.leapfrog_start += difference; }
  /// Vertices were split; forces and velocities are handed on.
  void follow_splits();
  /// Cells or velocities jumped: nothing is booked between the step before and the next.
  void forget_last();
  /// Positions and velocities are others: start again.
  void restart();

  /// All that goes back with a step that is rejected.
  struct State;
  State save() const;
  void restore(const State& state);

 private:
  void book_gravity(double time);
  void book_fed(double last_dt);
  double driven_until(const Now& now) const;

  Attributes& attributes_;
  ForceLoop& forces_;
  Loads& loads_;
  Constraints& constraints_;
  const Gravity& gravity_;

  struct Account {
    bool has_start = false;
    double start = 0, start_elastic = 0, start_driven = 0;  ///< kinetic + elastic; of them
    double events = 0, events_elastic = 0;
    double gravity = 0, moment = 0, ramp = 0;  ///< work; sum m g . x and ramp when it was booked
    bool moment_known = false;
    double fed = 0;  ///< work of functors without an energy beside others with one
    /// Of the half step before a jump, which no pass sees with the forces before it.
    double owed_driven = 0, owed_work = 0;
    double exchanged = 0;
    double leapfrog_start = 0;  ///< h^2/8 sum F^2/m where steps began, changed or jumped
  };
  Account account_;
  std::vector<double>
      fed_force_;  ///< of functors without an energy at the last evaluation, rows of 4
  bool fed_is_booked_ = false;
  Account jump_;  ///< energies before a jump, in its `start...`
};

struct Ledger::State {
  Account account;
  MotionSums sums;
  Loads::Book loads;
  std::vector<Vec3> driven;
  std::vector<double> fed_force;
  bool fed_is_booked;
};

}  // namespace suture
