// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "kernel/dynamics/body.hpp"
#include "kernel/dynamics/motion_sums.hpp"

// The ledger of a run
// ===================
//
//   kinetic + elastic - start = gravity + loads + pressure + prescribed + models + events
//                               - dissipated + balance
//
//   kinetic         from the velocity at the time of the positions
//   elastic         evaluated at each check, 0.7 of an evaluation of forces
//   gravity         mean of the ramp at both ends times the change of sum m g . x: exact where the
//                   ramp is constant, so one pass per check
//   loads, pressure per load, per face; only loaded vertices
//   prescribed      reactions times displacements of driven nodes, with the mean velocity
//   models          functors without an energy: their forces in a separate pass, or all internal
//                   work if no functor has an energy
//   events          the jump of kinetic + elastic at removals, seams, kicks and sleep; cuts remove
//                   nothing
//   dissipated      mass damping: work and prescribed motion less the change of the half-step
//                   kinetic energy. Functors that read velocities or keep a state: internal work
//                   less the change of the stored energy
//
// Why the stored energy is evaluated and not summed: the kinetic energy of half steps changes by
// exactly the trapezoidal work, whatever the step. Summed internal work follows an instability to
// 5e-12 while the run diverges, and its books still close. Only comparing the evaluated energy
// with that work reveals the instability.
//
// Where forces are linear, the balance is h^2/8 sum F^2/m for both integrators. With kinetic
// energies of half steps, or forces at one end only, it would be 9e-3 of the energy exchanged and
// of first order, instead of 3.7e-4. Valid runs stay below 0.026 (a twist 0.006, a stretched body
// that is cut 0.012, short moves 0.0135); a diverging one reaches 1. A negative balance is
// harmless.

namespace suture {

/// The energy of a run and its sources, J. Works and `events` are accumulated from the start of the
/// run:
///   kinetic + elastic = their sum at the start
///       + works + prescribed + models + events - dissipated + balance
struct EnergyBalance {
  double kinetic = 0;  ///< sum m v^2 / 2, v at the time of the positions
  double elastic = 0;  ///< stored energy of functors and other terms
  /// The work of each term other than the models: gravity, loads (forces and tractions), pressure,
  /// ...
  struct Work {
    const char* term;
    double value;
  };
  /// With obstacles, also "contact", the work of their forces without friction and cutting,
  /// "friction", and "cutting" where tissue resists blades.
  std::vector<Work> works;
  double work(std::string_view term) const;  ///< 0 if there is no such term
  double prescribed = 0;  ///< work of prescribed motion: reactions times displacements
  double models = 0;      ///< work of functors without an energy
  double events = 0;      ///< energy added (removed: negative) by operations and sleep
  double dissipated =
      0;  ///< energy dissipated by damping and functors that read velocities or have a state
  double balance = 0;  ///< the unexplained remainder
  /// The part of the balance that is recoverable at this step length: h^2/8 sum F^2/m, the current
  /// value minus that at the start.
  double recoverable = 0;
  /// The largest energy exchanged at any check so far: the scale for `balance`.
  double exchanged = 0;

  void state(Archive& archive);  ///< except for the works
};

/// Accounts for the energy of a run. All work is computed by the trapezoidal rule, with the forces
/// at both ends of a step, so that `balance` decreases with dt^2 (Belytschko, Liu, Moran, Nonlinear
/// Finite Elements, 6.2.3). For forces that are linear in the displacements it equals h^2/8 sum
/// F^2/m at all times. An unstable step adds to the stored energy, so `elastic` is evaluated, not
/// summed.
///
/// Cost: three sums in the existing pass over the vertices, plus the loaded and driven vertices;
/// for gravity, one pass per check and, during its ramp, per step; one pass per step if some
/// functors have an energy and others do not.
class Ledger {
 public:
  Ledger(Body& body, const MotionSums& sums) : body_(body), sums_(sums) {}

  /// The current state, with its forces evaluated.
  struct Now {
    double time = 0;
    double kinetic = 0;        ///< at the time of the positions, J
    double leapfrog_part = 0;  ///< h^2/8 sum F^2/m, J
    double half_step = 0;      ///< h- if velocities lag the positions by half a step, otherwise 0
    double contact = 0;        ///< work of contact in that half step, J
    double work = 0;  ///< h- A_n / 2: work of all forces in the half step not yet covered by a pass
  };
  /// The first call defines the start. Costs an evaluation of energies.
  EnergyBalance balance(const Now& now);
  /// Call at each check of a run, with its balance: `exchanged` does not fall below the one there.
  /// Looks between checks, such as rows of a table, have no influence on it.
  void keep_scale(const EnergyBalance& balance) { account_.exchanged = balance.exchanged; }
  bool needs_work() const;  ///< whether Now::work is used
  bool has_start() const { return account_.has_start; }

  /// Called around an operation that removes or joins elements or puts vertices to sleep; the jump
  /// of the energy is booked under `events`. Only after the start; each costs an evaluation of
  /// energies.
  void before_jump(const Now& now);
  void after_jump(const Now& now);
  /// The parts of these energies, and of Now, that an operation changes.
  struct Part {
    double kinetic = 0, elastic = 0, leapfrog_part = 0, work = 0;
  };
  /// The same without an evaluation, for a body without driven vertices.
  void book_jump(const Part& before, const Part& after);
  /// The step length changed, so that the energy of the step differs from that of the motion by
  /// `difference` more, J.
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
    double start = 0, start_elastic = 0, start_driven = 0;  ///< kinetic + elastic, and parts of it
    double events = 0, events_elastic = 0;
    /// For the half step before a jump, which no pass covers with the previous forces.
    double pending_driven = 0, pending_work = 0, pending_contact = 0;
    double exchanged = 0;
    double leapfrog_start =
        0;  ///< h^2/8 sum F^2/m at the start and at changes of the step or jumps
  };
  Account account_;
  Account jump_;  ///< energies before a jump, stored in its `start...` members
};

}  // namespace suture
