// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/gradients/step_replay.hpp"
#include "kernel/gradients/step_slopes.hpp"

namespace suture {

/// Which derivatives of a run are wanted, beside those by its start.
struct WantedSlopes {
  std::vector<ParameterDirection> parameters{};
  bool moments = false;  ///< loads and motions at each: 48 B per vertex and step
  /// dJ/d(the state at the end) of a run that goes on from there; empty vectors: 0.
  StateSlope end{};
};

/// The derivatives of a run by what determines it. Moments are those of the kept states: 0 is the
/// start, count() the end.
struct RunAdjoint {
  std::vector<std::vector<double>>
      parameters;            ///< of each that was wanted: one number, or one each
  std::vector<double> load;  ///< dJ/d(a force on each vertex at all moments), 3 numbers per vertex
  StateSlope start;          ///< dJ/d(the state at the start)
  std::vector<double> start_position;  ///< rows of 4
  /// The same at each moment, if wanted: dJ/d(a force on each vertex), and dJ/d(the place where a
  /// component is held), 0 where it is free.
  std::vector<std::vector<double>> loads, motions;
  unsigned iterations = 0;  ///< of the linear solves
};

/// The steps of a run, kept for derivatives. A cut, or whatever else changes the body between two
/// steps, ends what has a derivative.
class KeptSteps {
 public:
  /// From the current state on. Throws InputError with the reason where there are no derivatives:
  /// contact, a model without a tangent.
  explicit KeptSteps(Dynamics& dynamics, StepReplay::Limit limit = {});

  /// To be called after every step.
  void keep();
  std::size_t count() const { return replay_.count(); }
  std::size_t repeated() const { return replay_.repeated(); }  ///< steps made again so far

  /// The slopes of J by the state at a moment (1 to count()), in which the body is when it is
  /// called; an empty displacement for none.
  using SlopesAt = std::function<ObjectiveSlopes(std::size_t moment)>;
  /// Backward over all steps: an evaluation of the forces each, a linear solve in implicit schemes,
  /// and two evaluations per wanted parameter. Throws InputError with the reason where there are no
  /// derivatives: no steps, steps that differ in length or that do not lead to the next state, an
  /// indefinite or unsymmetric tangent. The body is as before when it returns, and so are the bits
  /// of later steps.
  RunAdjoint adjoint(const SlopesAt& slopes_at, double tolerance, const WantedSlopes& wanted = {});

 private:
  static constexpr double same_step = 1e-9;  ///< of the lengths of steps, relative
  void require_unchanged() const;
  StateSlope start_slope(const WantedSlopes& wanted, std::size_t states) const;

  Dynamics& dynamics_;
  Body& body_;
  StepReplay replay_;
  double start_;              ///< s
  std::vector<double> held_;  ///< the column `fixed`
  std::vector<double> last_;  ///< the positions after the last step, rows of 4
  std::string broken_;        ///< why there are no derivatives any more; empty: there are
};

}  // namespace suture
