// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/implicit/inertia_relief.hpp"
#include "kernel/implicit/step_solver.hpp"

namespace suture {

class CoarseSystem;
class NonsmoothTerm;

/// The forces of contact do not settle. A smaller change of loads and motions may help, another
/// material does not.
class Unsettled : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// Solves the equations of a step by Newton's method with inexact linear solves (Eisenstat and
/// Walker, SIAM J. Sci. Comput. 17 (1996) 16) and a line search on the slope of the energy
/// (Matthies and Strang, IJNME 14 (1979) 1613).
///
/// Prescribed vertices move with the free ones: the first direction d solves the linearised
/// equations with their displacement given, so that no layer of elements is crushed by a motion
/// that the rest of the body does not follow.
///
/// Results depend on the state alone (StepSolver).
class Newton {
 public:
  /// `tolerance`: of the residual, relative to the largest of the norms of external forces,
  /// reactions and inertial forces.
  /// `holds_free_pieces`: by inertia relief; otherwise the equations must have a solution without.
  Newton(Motion& motion, double tolerance, bool holds_free_pieces = false);

  /// Moves the vertices, free and prescribed, to the solution, starting from their current
  /// positions; sets their velocities. Throws NumericalError with the element where the residual is
  /// largest and what to try if there is none within reach; positions and velocities are undefined
  /// then. One evaluation of the forces per iteration and trial step, and the linear solves.
  void solve(const StepEquations& equations);

  /// Makes one linearised step towards the solution instead, as far as the clock allows: after it,
  /// the energy is at most that before it and the work on the body (budgeted_step.cpp). Two
  /// evaluations of forces and energies, and the linear solve. Throws NumericalError if the forces
  /// do not exist where prescribed vertices have to be.
  void take_step(const StepEquations& equations, StepClock& clock);
  /// Builds the preconditioner of take_step() for the current state.
  void prepare(const StepEquations& equations);
  /// What the linear solves of take_step() left; "" if all reached the tolerance or there were
  /// none.
  std::string budget_text() const;
  void budget_state(Archive& archive);  ///< what that text says

  /// To be called when cells have changed.
  void forget() { solver_.forget(); }
  /// To be called when a step begins, and when it is rejected.
  void begin_step() { solver_.begin_step(); }
  void reject_step() { solver_.reject_step(); }
  void state(Archive& archive) { solver_.state(archive); }

  /// The forces that are not in balance at the current positions, 3 numbers per vertex; 0 on
  /// components that are not free.
  const std::vector<double>& residual(const StepEquations& equations);
  /// A residual that is more than this part of the last one no longer decreases.
  static constexpr double stalling = 0.3;
  /// Whether the last residual, of this norm, is one that rounding makes. Two evaluations of the
  /// forces.
  bool is_at_rounding(const StepEquations& equations, double residual);
  /// To be called before a tangent of terms with kinks is used.
  void begin_iteration(unsigned number, double time);
  /// What the tolerance refers to: the largest of the norms of external forces, reactions and
  /// inertial forces at the last evaluation, N.
  double scale() const { return scale_; }
  /// The number, for users, of an element where the last residual is largest.
  std::uint64_t worst_element() const;

  /// Iterations of the last solve that converged.
  unsigned iterations() const { return iterations_; }

  /// The number of solves that rounding kept above the tolerance.
  unsigned limited_steps() const { return limited_steps_; }
  /// The largest residual of these, relative to scale().
  double rounding_limit() const { return rounding_limit_; }

  struct TangentCheck {
    bool is_indefinite = false;
    double lowest = 0;  ///< eigenvalue, about, in multiples of their mean
  };
  /// Examines the tangent at the current state: if it is indefinite, the equilibrium is unstable.
  /// By a linear solve with a random right-hand side (fixed seed), in which every mode takes part:
  /// its Lanczos process finds an isolated negative eigenvalue first, and the lowest modes prevail
  /// in its solution. Costs as much as a first iteration.
  TangentCheck check_tangent(double time);

  /// What these equations leave at the current positions, beside what the tolerance refers to.
  struct Balance {
    double residual, scale;  ///< N
    bool is_solved;          ///< within ten times the tolerance, or up to rounding
  };
  Balance balance(const StepEquations& equations);
  /// Whether these equations are solved with the motions of free pieces held.
  bool holds_free_pieces();
  /// Solves A x = b, or A^T x = b, with the tangent of these equations at the current positions, on
  /// the free components; x is 0 elsewhere. By the preconditioner of the last step, where it is of
  /// use. Changes no bit of later steps.
  LinearSolve solve_tangent(const StepEquations& equations, std::span<const double> b,
                            std::span<double> x, double tolerance, bool is_transposed = false);

  /// Asked between iterations, and now and then in a linear solve: if true, solve() throws
  /// StepAbandoned. None: nobody is asked.
  std::function<bool()> is_abandoned;
  /// Throws if it is so.
  void check_abandoned() const;

  /// Called after each iteration, for `suture run -v`.
  struct Iteration {
    unsigned number, linear_iterations;
    double residual, scale, step;
    bool indefinite;
    std::size_t coarse_nodes = 0;  ///< 0: of the body itself; otherwise of a coarse level
  };
  std::function<void(const Iteration&)> on_iteration;
  /// What else `suture run -v` prints: the load steps of a static step.
  std::function<void(const std::string&)> on_note;
  /// What every run prints: the limit points of a path of equilibria.
  std::function<void(const std::string&)> on_message;

  /// The preconditioner for these equations and why: "multigrid for 4000 elements".
  std::string describe_solver(const StepEquations& equations);
  /// The name of the current preconditioner, and whether it had to be changed to be positive
  /// definite.
  std::string preconditioner() const { return solver_.preconditioner(); }
  /// Preconditioners built so far.
  unsigned builds() const { return solver_.builds(); }

 private:
  struct Progress {
    unsigned iterations = 0;
    unsigned indefinite = 0;  ///< of these, with an indefinite tangent
    /// |r| over the free components now, before, and at the start, N
    double residual = 0, last = 0, first = 0;
  };
  void start(const StepEquations& equations);
  void find_solution(const StepEquations& equations);
  bool update_constraints(double time);
  void iterate_through_kinks(const StepEquations& equations);
  void iterate(const StepEquations& equations, unsigned allowed);
  bool start_from_prediction(const StepEquations& equations);
  bool start_from_coarse_levels(const StepEquations& equations);
  bool solve_on_level(const StepEquations& equations, CoarseSystem& system);
  double evaluate(const StepEquations& equations);
  void add_loads(const LoadTime& load);
  bool is_symmetric(const StepEquations& equations) const;
  void move(double step);
  void set_remaining(double time);
  LinearSolve find_direction(const StepEquations& equations, double tolerance,
                             StepClock* clock = nullptr);
  double search(const StepEquations& equations);
  bool is_solved(const StepEquations& equations, const Progress& progress);
  double forcing(const Progress& progress) const;
  bool try_step(const StepEquations& equations, double step, double& slope);
  double noise(const StepEquations& equations);
  [[noreturn]] void refuse(const StepEquations& equations, const Progress& progress,
                           const std::string& reason);

  std::uint64_t element_at(Index vertex) const;

  struct StepStart;
  double growth(const StepEquations& equations, const StepStart& start) const;
  bool try_part(const StepEquations& equations, const StepStart& start, double part);

  Motion& motion_;
  double tolerance_;
  std::optional<InertiaRelief> relief_;  ///< of static equilibria that request it
  StepSolver solver_;
  bool is_moving_ = false;                 ///< prescribed components have not arrived
  std::vector<NonsmoothTerm*> nonsmooth_;  ///< of the body, in the current solve
  unsigned limited_steps_ = 0, iterations_ = 0;
  /// Calls of take_step(), and those that the budget ended.
  struct Budgeted {
    std::uint64_t steps = 0, ended = 0;
    double largest_residual = 0;  ///< of the linear solves, relative
  } budgeted_;
  double rounding_limit_ = 0;
  double scale_ = 0;
  bool has_multipliers_ = false;  ///< constraints have them
  double worth_ = 0;  ///< the part of the first residual that is small enough; 0: the tolerance
  // 3 numbers per vertex:
  std::vector<double> residual_, direction_, remaining_;
  std::vector<double> start_;             ///< positions, 4 numbers per vertex
  AlignedVector<double> forces_, loads_;  ///< of the models and the other terms, 4 per vertex
  AlignedVector<double> load_;            ///< of the other terms at one time
};

}  // namespace suture
