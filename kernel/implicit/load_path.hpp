// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/implicit/newton.hpp"

namespace suture {

/// The equations that lead from the state at the start of a static step to the equilibrium at its
/// end, for the part s of the change from 0 to 1:
///  - the time of models and prescribed motions goes from the start to the end of the step;
///  - loads, gravity included, are 1 - s times those at the start and s times those at the end; in
///    the first step of a run there are none at the start;
///  - forces that are not in balance at the start, as after a cut, are held back by the part 1 - s.
/// So the state at the start is in equilibrium at s = 0. Loads and forces that are held back go on
/// in the same way for s below 0 and above 1, where the time stays.
class LoadPath {
 public:
  /// `forbids_inversion`: by instance of the body, whether an equilibrium in which one of its
  /// elements has become inverted is no solution.
  LoadPath(Motion& motion, Newton& newton, std::vector<bool> forbids_inversion)
      : motion_(motion), newton_(newton), forbids_inversion_(std::move(forbids_inversion)) {}

  struct Failure {
    std::string reason;
    std::uint64_t element = NumericalError::nowhere;
    bool is_unsettled = false;  ///< by contact
  };

  /// The path from the current state, which is that at `start`, to the equations at the end of a
  /// step or of a part of it; a step starts at the time of the motion. One evaluation of the forces
  /// with hold_back(), without which the unbalanced forces act at once.
  void begin(const StepEquations& end) { begin(end, motion_.time()); }
  void begin(const StepEquations& end, double start);
  void hold_back();
  StepEquations equations_at(double part) const;

  /// The largest angle by which a prescribed motion turns between two parts of the change, rad.
  double turn(double from, double to) const;

  /// Moves the vertices to the equilibrium at a part of the change that Newton's method finds from
  /// their current positions, or back to the last one: false. Passes on StepRejected.
  bool try_at(double part);
  /// From now on, Newton's method starts from the current positions. False if it has done so.
  bool drop_prediction();
  /// The current positions are an equilibrium. Throws NumericalError if elements are inside out.
  void accept();
  /// Back to the last equilibrium, and to the multipliers at the start of the step; remembers why.
  void return_from(const NumericalError& error);

  const std::vector<double>& position() const { return position_; }  ///< of the last one, rows
  const Failure& failure() const { return failure_; }                ///< the last one
  std::string interval() const;  ///< of the step, for messages: "t = 0 s to 1 s"
  /// Throws NumericalError (Unsettled, if contact is the reason): no equilibrium at the end, with
  /// the state at the last one. `what` was followed and `how` it ended: "load steps", "end at 40 %
  /// of the change of loads and motions".
  [[noreturn]] void refuse(const std::string& what, const std::string& how) const;

  Motion& motion() const { return motion_; }
  Newton& newton() const { return newton_; }

 private:
  void refuse_inversion() const;

  Motion& motion_;
  Newton& newton_;
  std::vector<bool> forbids_inversion_;
  double start_ = 0;                ///< s
  StepEquations end_;               ///< of the step: s = 1
  std::vector<double> unbalanced_;  ///< at s = 0, 3 numbers per vertex, N; empty: act at once
  std::vector<double> position_;    ///< of the last equilibrium, 4 numbers per vertex
  std::vector<Index> inverted_;     ///< elements, at the start
  Failure failure_;
};

/// "40 %", for messages about a part of the change.
std::string percent(double part);

}  // namespace suture
