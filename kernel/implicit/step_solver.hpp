// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/dynamics/motion.hpp"
#include "kernel/implicit/step_clock.hpp"
#include "kernel/implicit/step_equations.hpp"
#include "kernel/solvers/choice.hpp"
#include "kernel/solvers/gmres.hpp"

namespace suture {

/// The linear systems of Newton's method: the tangent at the current state, and a preconditioner
/// that outlives iterations and steps. It is built again once it has taken as many iterations more
/// than a new one as building it costs.
///
/// Results depend on the state alone: the positions from which the preconditioner was built belong
/// to it. Where tangents depend on more than positions, every solve builds its own. The hierarchy
/// of a multigrid is kept as long as cells and free components stay; the next one has as many
/// levels. Where coarsening ends is found only if a hierarchy is slow. How many levels there are is
/// part of the state, too.
class StepSolver {
 public:
  explicit StepSolver(Motion& motion);

  /// To be called before the equations of a step are solved. `supports`: components that are held
  /// besides those that are constrained; they are new in every solve. Sets what is free.
  void start(double time);
  void start(double time, std::vector<std::size_t> supports);

  /// The tangent at the current state.
  void set_matrix(const StepEquations& equations);
  const TangentMatrix& matrix() const { return matrix_; }
  /// Whether it is symmetric: the choice between conjugate gradients and GMRES. If not, systems may
  /// be those of its transpose.
  void set_symmetric(bool is_symmetric, bool is_transposed = false) {
    is_symmetric_ = is_symmetric;
    matrix_.set_transposed(is_transposed);
  }

  /// Solves A x = b. Throws the errors of terms. `check`, which may throw, is called now and then.
  LinearSolve solve(std::span<const double> b, std::span<double> x, double tolerance,
                    const std::function<void()>& check = {});
  /// The same as far as the clock allows, by the preconditioner that there is, if there is one. One
  /// that has become slow is built again in the next solve, if there is time for it.
  LinearSolve solve_within(StepClock& clock, std::span<const double> b, std::span<double> x,
                           double tolerance);
  /// Builds the preconditioner for the current state unless there is one.
  void prepare();
  /// The levels of the multigrid, whose operators the caller may overwrite.
  CoarseLevels coarse_levels();
  /// The preconditioner belongs to a state that leads nowhere.
  void discard();

  /// To be called when cells have changed.
  void forget();
  /// A step begins. If it is rejected, the solver is as it was before.
  void begin_step();
  void reject_step();
  void state(Archive& archive);

  /// The name of the preconditioner, and whether it had to be changed to be positive definite.
  std::string preconditioner() const;
  const std::string& reason() const { return choice_.reason; }
  /// Preconditioners built so far.
  unsigned builds() const { return builds_; }

 private:
  /// Arguments of TangentMatrix::set().
  struct Factors {
    double time = 0, dt = 0, mass = 0, velocity = 0;
    std::vector<LoadTime> loads;

    void state(Archive& archive);
  };
  /// What a preconditioner was built from, and how well it works.
  struct Built {
    std::vector<double> position;  ///< 4 numbers per vertex; empty: there is none
    PreconditionerChoice::Kind kind = PreconditionerChoice::Kind::open;
    Factors factors;
    bool is_new = true;  ///< in the solve of a step's equations for which it was built
    // While it is new: -ln of the factor by which residuals decreased; iterations, and those of the
    // first solve.
    double decrease = 0, iterations = 0;
    unsigned first = 0;
    double excess = 0;  ///< iterations since then that a new one would have saved

    double expected_iterations(double residual) const;
    bool note(const LinearSolve& solve);
    void state(Archive& archive);
  };
  struct Before {
    Built built;
    std::vector<std::uint8_t> free;
    std::size_t levels = 0;
    bool finds_end = false;
    unsigned builds = 0;
  };

  void set(const Factors& factors);
  PreconditionerChoice new_choice() const;
  void choose();
  LinearSolve iterate(const IterationLimit& limit, std::span<const double> b, std::span<double> x,
                      double tolerance);
  bool is_slow(const LinearSolve& solve) const;
  void find_end();
  void build();
  bool is_ready();
  std::size_t known_levels() const;

  Motion& motion_;
  TangentMatrix matrix_;
  Factors factors_;                 ///< of the matrix
  PreconditionerChoice choice_;     ///< none yet after forget()
  std::vector<std::uint8_t> free_;  ///< what is free in the matrices that it belongs to
  std::size_t levels_ = 0;          ///< that the next multigrid is known to have, or 0
  bool finds_end_ = false;          ///< MultigridOptions::finds_end
  ConjugateGradients symmetric_;
  Gmres whole_;
  Built built_;
  Before before_;
  unsigned builds_ = 0;
  double build_seconds_ = 0;  ///< of the wall clock, of the last one
  bool is_symmetric_ = true;
  bool is_chosen_ = false;  ///< choice_ is that for this solve
  bool is_built_ = false;   ///< from built_
};

}  // namespace suture
