// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "kernel/dynamics/body.hpp"
#include "kernel/dynamics/motion_sums.hpp"

namespace suture {

/// Where the energy of a run is and where it came from, J. Works and `events` count from the
/// start of the run:
///   kinetic + elastic = their sum at the start
///       + works + prescribed + models + events - dissipated + balance
struct EnergyBalance {
  double kinetic = 0;  ///< sum m v^2 / 2, v at the time of the positions
  double elastic = 0;  ///< stored by functors and other terms
  /// Of each term but the models: gravity, loads (forces and tractions), pressure, ...
  struct Work {
    const char* term;
    double value;
  };
  std::vector<Work> works;
  double work(std::string_view term) const;  ///< 0 if there is no such term
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

  void state(Archive& archive);  ///< but for the works
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
  Ledger(Body& body, const MotionSums& sums) : body_(body), sums_(sums) {}

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
  void restart() { account_ = {}; }
  void state(Archive& archive);

 private:
  void book(double time);
  double driven_until(const Now& now) const;

  Body& body_;
  const MotionSums& sums_;
  struct Account {
    bool has_start = false;
    double start = 0, start_elastic = 0, start_driven = 0;  ///< kinetic + elastic; of them
    double events = 0, events_elastic = 0;
    /// Of the half step before a jump, which no pass sees with the forces before it.
    double owed_driven = 0, owed_work = 0;
    double exchanged = 0;
    double leapfrog_start = 0;  ///< h^2/8 sum F^2/m where steps began, changed or jumped
  };
  Account account_;
  Account jump_;  ///< energies before a jump, in its `start...`
};

}  // namespace suture
