// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/forces/nonsmooth_term.hpp"
#include "kernel/spectrum/scaled_tangent.hpp"

namespace suture {
namespace {

// The part of the slope at the start that a step may leave, either way (Crisfield).
constexpr double slope_left = 0.8;
constexpr unsigned max_newton_iterations = 50, max_trials = 12;
// From a solution on coarse levels: one that takes longer was of little use.
constexpr unsigned max_nested_iterations = 25;
constexpr unsigned max_updates = 50;  // of constraints
// A part of the forces: what a predicted equilibrium may leave of them, where motions are
// prescribed. What a cut releases is less than what the first iteration of a motion leaves.
constexpr double good_prediction = 1;
// Forcing terms of the linear solves.
constexpr double first_forcing = 0.1, least_forcing = 1e-3;
// The order of convergence that they allow. With 2, systems are solved more accurately than they
// describe the next state: rotations leave more.
constexpr double forcing_order = 1.3;
// The part of their first residual to which the equations are solved before an update of
// constraints: the update replaces the multipliers for which they were solved.
constexpr double worth_an_update = 0.1;
// The part of the tolerance that the linear solve of the last iteration may leave.
constexpr double part_of_tolerance = 0.7;
// What is left for the tolerance, if one iteration may do.
constexpr double within_reach = 0.01;

}  // namespace

Newton::Newton(Motion& motion, double tolerance, bool holds_free_pieces)
    : motion_(motion), tolerance_(tolerance), solver_(motion) {
  if (holds_free_pieces) relief_.emplace(motion.body());
}

std::string Newton::describe_solver(const StepEquations& equations) {
  solver_.set_matrix(equations);
  return preconditioner() + ' ' + solver_.reason();
}

// ----------------------------------------------------------------- residual --

/// r at the current positions, and the velocities there; returns its norm. Updates the scale.
double Newton::evaluate(const StepEquations& equations) {
  Body& body = motion_.body();
  Attributes& attributes = body.attributes();
  const Index vertices = attributes.vertex_count();
  const double* x = attributes.position().rows();
  double* v = attributes.velocity().rows();
  for (std::size_t i = 0; i < std::size_t{vertices} * 4; ++i)
    if (i % 4 != 3 && solver_.matrix().free()[i / 4 * 3 + i % 4])
      v[i] = equations.velocity[i] + equations.rate * (x[i] - equations.position[i]);
  forces_.assign(std::size_t{vertices} * 4, 0);
  loads_.assign(std::size_t{vertices} * 4, 0);
  body.models().add_forces(equations.time, equations.dt, ForceLoop::Part::all, forces_.data());
  if (equations.loads.empty()) add_loads({equations.time, 1});
  for (const LoadTime& load : equations.loads) add_loads(load);
  for (const auto& term : body.loads())
    if (dynamic_cast<ConstraintTerm*>(term.get()))
      term->add_forces(equations.time, attributes.kernel(0).cells.live(), loads_.data());
  scale_ = find_residual(motion_,
                         {forces_.data(), loads_.data(), equations.held_back,
                          equations.acceleration, equations.position.data()},
                         residual_);
  if (relief_) relief_->balance(residual_);
  return norm(residual_);
}

/// All terms except the models and constraints, gravity included.
void Newton::add_loads(const LoadTime& load) {
  Body& body = motion_.body();
  Attributes& attributes = body.attributes();
  const Vec3 gravity = body.acceleration(load.time);
  const bool is_whole = load.factor == 1;
  if (!is_whole) load_.assign(loads_.size(), 0);
  for (const auto& term : body.loads())
    if (!dynamic_cast<ConstraintTerm*>(term.get()))
      term->add_forces(load.time, attributes.kernel(0).cells.live(),
                       (is_whole ? loads_ : load_).data());
  for (Index vertex = 0; vertex < attributes.vertex_count(); ++vertex)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t row = std::size_t{vertex} * 4 + c;
      loads_[row] += load.factor * attributes.mass().get(vertex, 0) * gravity[c];
      if (!is_whole) loads_[row] += load.factor * load_[row];
    }
}

bool Newton::is_symmetric(const StepEquations& equations) const {
  Body& body = motion_.body();
  if (equations.loads.empty()) return body.is_conservative(equations.time);
  return body.models().is_conservative(equations.time) &&
         std::ranges::all_of(equations.loads, [&](const LoadTime& load) {
           return body.has_conservative_loads(load.time);
         });
}

/// Positions: start + step * direction.
void Newton::move(double step) {
  double* x = motion_.body().attributes().position().rows();
  for (std::size_t i = 0; i < direction_.size(); ++i) {
    const std::size_t row = i / 3 * 4 + i % 3;
    x[row] = start_[row] + step * direction_[i];
  }
}

/// What prescribed components still have to move to be where they are at `time`.
void Newton::set_remaining(double time) {
  Attributes& attributes = motion_.body().attributes();
  double* x = attributes.position().rows();
  start_.assign(x, x + std::size_t{attributes.vertex_count()} * 4);
  motion_.body().constraints().apply(attributes, time);
  for (std::size_t i = 0; i < remaining_.size(); ++i) {
    const std::size_t row = i / 3 * 4 + i % 3;
    remaining_[i] = x[row] - start_[row];
    x[row] = start_[row];
  }
  is_moving_ = std::ranges::any_of(remaining_, [](double d) { return d != 0; });
}

void Newton::check_abandoned() const {
  if (is_abandoned && is_abandoned()) throw StepAbandoned();
}

// ---------------------------------------------------------------- directions --

/// Solves A d = r - A d_p with d = d_p on prescribed components; with a clock as far as it allows.
LinearSolve Newton::find_direction(const StepEquations& equations, double tolerance,
                                   StepClock* clock) {
  solver_.set_matrix(equations);
  const TangentMatrix& matrix = solver_.matrix();
  std::vector<double> right = residual_;
  matrix.restrict(right);
  if (is_moving_) {
    matrix.apply_whole(remaining_.data(), right.data());
    for (std::size_t i = 0; i < right.size(); ++i) right[i] = residual_[i] - right[i];
    matrix.restrict(right);
  }
  const LinearSolve solve =
      clock ? solver_.solve_within(*clock, right, direction_, tolerance)
            : solver_.solve(right, direction_, tolerance, [this] { check_abandoned(); });
  for (std::size_t i = 0; i < remaining_.size(); ++i) direction_[i] += remaining_[i];
  if (relief_) relief_->remove_rigid_motion(direction_);
  return solve;
}

/// Moves by a step; the slope r . d there. False if the forces do not exist there.
bool Newton::try_step(const StepEquations& equations, double step, double& slope) {
  move(step);
  try {
    evaluate(equations);
  } catch (const NumericalError&) {
    return false;
  }
  slope = dot(residual_, direction_);
  return std::isfinite(slope);
}

/// A step at which the slope of the energy along the direction is small, or 0 if there is none; the
/// vertices are moved by it, and the residual is that there. While prescribed vertices move, the
/// energy need not decrease: then any step at which the forces exist will do.
double Newton::search(const StepEquations& equations) {
  const double first = dot(residual_, direction_);
  double low = 0, low_slope = first, high = 0, high_slope = 0, step = 1;
  unsigned lows = 0;  // in succession
  for (unsigned trial = 0; trial < max_trials; ++trial) {
    double slope = 0;
    if (!try_step(equations, step, slope)) {
      high = step;
      high_slope = 0;
      step = low + (high - low) / 4;
      continue;
    }
    const bool is_flat = std::abs(slope) <= slope_left * std::abs(first);
    if (is_moving_ || is_flat || (slope > 0 && high == 0)) return step;
    if (slope > 0) {
      low = step;
      low_slope = slope;
      ++lows;
    } else {
      high = step;
      high_slope = slope;
      lows = 0;
    }
    // Where something touches on the way, the slope is even up to there and steep beyond: the
    // secant creeps.
    const double secant = lows > 1         ? 0.5
                          : high_slope < 0 ? low_slope / (low_slope - high_slope)
                                           : 0.25;  // of the interval
    step = low + (high - low) * std::clamp(secant, 0.1, 0.9);
  }
  if (low == 0 || !try_step(equations, low, low_slope)) return 0;
  return low;  // the energy decreases up to there
}

// -------------------------------------------------------------------- solve --

/// With inertia relief, of the pieces that float free now.
void Newton::start(const StepEquations& equations) {
  nonsmooth_.clear();
  for_each_with<NonsmoothTerm>(motion_.body().loads(),
                               [&](NonsmoothTerm& term) { nonsmooth_.push_back(&term); });
  if (relief_) {
    relief_->find();
    solver_.start(equations.time, relief_->supports());
  } else {
    solver_.start(equations.time);
  }
  for (auto* vector : {&residual_, &direction_, &remaining_})
    vector->assign(solver_.matrix().size(), 0);
}

const std::vector<double>& Newton::residual(const StepEquations& equations) {
  start(equations);
  evaluate(equations);
  return residual_;
}

/// Starts at x* if the energy is lower there, by the work of the residual on the way d:
///   E(x*) - E(x) = -(r(x) + r(x*)) . d / 2
/// The residual itself would count stiff motions too much. Where x* is an equilibrium, what is
/// prescribed has arrived; if it moves, there is no such energy, and the residual has to be small.
/// False if nothing moves.
bool Newton::start_from_prediction(const StepEquations& equations) {
  if (!equations.is_predicted) return false;
  double* x = motion_.body().attributes().position().rows();
  const std::vector<double> before(x, x + equations.position.size()), residual = residual_;
  set_remaining(equations.time);
  const bool arrives = equations.acceleration == 0;
  if (arrives) motion_.body().constraints().apply(motion_.body().attributes(), equations.time);
  for (std::size_t i = 0; i < solver_.matrix().size(); ++i)
    if (solver_.matrix().free()[i]) x[i / 3 * 4 + i % 3] = equations.position[i / 3 * 4 + i % 3];
  try {
    const double left = evaluate(equations);
    double work = 0;
    for (std::size_t i = 0; i < residual.size(); ++i)
      work += (residual[i] + residual_[i]) * (x[i / 3 * 4 + i % 3] - before[i / 3 * 4 + i % 3]);
    if (arrives && is_moving_ ? left < good_prediction * scale_ : work > 0) return true;
  } catch (const NumericalError&) {
    // The forces do not exist there.
  }
  std::ranges::copy(before, x);
  evaluate(equations);
  return false;
}

/// From the coarse levels where that is worthwhile; from the current positions otherwise, or if
/// that leads nowhere. Where constraints have multipliers, the equations are solved to a part of
/// their first residual before each update, and to the tolerance once an update changes nothing.
/// On a liver on a table, this takes 330 iterations with 2,570 of the linear solver instead of 530
/// with 4,510 in 40 steps.
void Newton::solve(const StepEquations& equations) {
  has_multipliers_ = false;
  for_each_with<ConstraintTerm>(motion_.body().loads(),
                                [&](ConstraintTerm&) { has_multipliers_ = true; });
  worth_ = has_multipliers_ ? worth_an_update : 0;
  find_solution(equations);
  for (unsigned updates = 0;; ++updates) {
    const bool has_changed = update_constraints(equations.time);
    if (!has_changed && worth_ == 0) return;
    if (updates == max_updates)
      throw Unsettled("contact does not settle at t = " + std::to_string(equations.time) +
                          " s: after " + std::to_string(updates) +
                          " updates of its forces, gaps are above the tolerance",
                      worst_element());
    worth_ = has_changed ? worth_an_update : 0;
    evaluate(equations);
    iterate_through_kinks(equations);
  }
}

/// Where Newton's method finds no way, it tries once more with simpler forces.
void Newton::iterate_through_kinks(const StepEquations& equations) {
  if (nonsmooth_.empty()) return iterate(equations, max_newton_iterations);
  double* x = motion_.body().attributes().position().rows();
  const std::vector<double> before(x, x + equations.position.size());
  try {
    return iterate(equations, max_newton_iterations);
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError&) {
    bool is_simpler = false;
    for (NonsmoothTerm* term : nonsmooth_) is_simpler |= term->simplify();
    if (!is_simpler) throw;
  }
  std::ranges::copy(before, x);
  evaluate(equations);
  iterate(equations, max_newton_iterations);
}

bool Newton::update_constraints(double time) {
  bool has_changed = false;
  for_each_with<ConstraintTerm>(motion_.body().loads(),
                                [&](ConstraintTerm& term) { has_changed |= term.update(time); });
  return has_changed;
}

void Newton::find_solution(const StepEquations& equations) {
  start(equations);
  evaluate(equations);
  const bool is_near = start_from_prediction(equations);
  double* x = motion_.body().attributes().position().rows();
  const std::vector<double> before(x, x + equations.position.size());
  if (!is_near && start_from_coarse_levels(equations)) {
    try {
      return iterate(equations, max_nested_iterations);
    } catch (const NumericalError&) {
      std::ranges::copy(before, x);
      evaluate(equations);
      solver_.discard();
    }
  }
  iterate_through_kinks(equations);
}

void Newton::begin_iteration(unsigned number, double time) {
  for (NonsmoothTerm* term : nonsmooth_) term->begin_iteration(number, time);
}

/// From the current positions, where the residual is known.
void Newton::iterate(const StepEquations& equations, unsigned allowed) {
  Progress progress;
  progress.residual = progress.first = norm(residual_);
  for (;; ++progress.iterations) {
    if (!std::isfinite(progress.residual)) refuse(equations, progress, "the forces are not finite");
    iterations_ = progress.iterations;
    if (is_solved(equations, progress)) return;
    check_abandoned();
    if (progress.iterations == allowed)
      refuse(equations, progress, "the allowed number of iterations was not enough");
    // A tangent that is not symmetric may be so at rest.
    if (progress.iterations < 2) solver_.set_symmetric(is_symmetric(equations));
    begin_iteration(progress.iterations, equations.time);
    const LinearSolve solve = find_direction(equations, forcing(progress));
    progress.indefinite += solve.outcome == LinearSolve::Outcome::indefinite;
    const double step = search(equations);
    if (step == 0) {
      move(0);
      evaluate(equations);
      if (!is_moving_ && is_at_rounding(equations, progress.residual)) return;
      refuse(equations, progress, "no step along the direction of Newton helps");
    }
    progress.last = std::exchange(progress.residual, norm(residual_));
    if (on_iteration)
      on_iteration({progress.iterations + 1, solve.iterations, progress.residual, scale_, step,
                    solve.outcome == LinearSolve::Outcome::indefinite});
  }
}

/// Also true if the residual no longer decreases for rounding. Updates what prescribed components
/// still have to move.
bool Newton::is_solved(const StepEquations& equations, const Progress& progress) {
  set_remaining(equations.time);
  if (is_moving_) return false;
  if (progress.residual <= std::max(tolerance_ * scale_, worth_ * progress.first)) return true;
  const bool stalls = progress.iterations > 1 && progress.residual > stalling * progress.last;
  return stalls && is_at_rounding(equations, progress.residual);
}

/// Whether the residual is one that rounding makes.
bool Newton::is_at_rounding(const StepEquations& equations, double residual) {
  const double reachable = 4 * noise(equations);
  if (residual > reachable) return false;
  if (scale_ <= reachable) return true;  // there are no forces to be in balance with
  ++limited_steps_;
  rounding_limit_ = std::max(rounding_limit_, residual / scale_);
  return true;
}

/// The tolerance of a linear solve: smaller, the better the last iteration was.
double Newton::forcing(const Progress& progress) const {
  if (progress.residual == 0) return first_forcing;  // only what is prescribed has to move
  const double enough = part_of_tolerance * tolerance_ * scale_ / progress.residual;
  if (progress.iterations == 0 && worth_ == 0 && has_multipliers_)  // after the last update
    return std::clamp(enough, least_forcing, first_forcing);
  if (progress.iterations == 0)
    return enough < within_reach ? first_forcing : std::min(enough, first_forcing);
  const double gain = progress.residual / progress.last;
  return std::clamp(std::max(0.9 * std::pow(gain, forcing_order), enough), least_forcing,
                    first_forcing);
}

Newton::TangentCheck Newton::check_tangent(double time) {
  StepEquations equations;
  equations.time = time;
  start(equations);  // there may have been no solve: a run that is resumed at its end
  Random random;
  for (double& r : residual_) r = random();
  solver_.matrix().restrict(residual_);
  is_moving_ = false;
  solver_.set_symmetric(true);
  if (find_direction(equations, 1e-6).outcome == LinearSolve::Outcome::indefinite) return {true, 0};
  std::vector<double> image(residual_.size());
  solver_.matrix().apply(residual_.data(), image.data());
  const auto inertia = [&](const std::vector<double>& x) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += motion_.body().attributes().mass().get(static_cast<Index>(i / 3), 0) * x[i] * x[i];
    return sum;
  };
  const double mean = dot(residual_, image) / inertia(residual_);
  return {false, dot(residual_, direction_) / inertia(direction_) / mean};
}

/// The change of the residual if positions are rounded, about |K| |x| eps: by a unit in the last
/// place, up or down at random, as neighbours that move together strain nothing. The residual is
/// that of the positions again when it returns.
double Newton::noise(const StepEquations& equations) {
  const std::vector<double> residual = residual_;
  double* x = motion_.body().attributes().position().rows();
  const std::vector<double> before(x, x + equations.position.size());
  Random random;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (i % 4 != 3 && solver_.matrix().free()[i / 4 * 3 + i % 4])
      x[i] += (random() < 0 ? 1 : -1) * std::numeric_limits<double>::epsilon() * std::abs(x[i]);
  evaluate(equations);
  double squared = 0;
  for (std::size_t i = 0; i < residual.size(); ++i)
    squared += (residual_[i] - residual[i]) * (residual_[i] - residual[i]);
  std::ranges::copy(before, x);
  evaluate(equations);
  return std::sqrt(squared);
}

std::uint64_t Newton::worst_element() const {
  const auto worst = std::ranges::max_element(
      residual_, [](double a, double b) { return std::abs(a) < std::abs(b) || std::isnan(b); });
  return element_at(static_cast<Index>((worst - residual_.begin()) / 3));
}

/// The number, for users, of an element at a vertex.
std::uint64_t Newton::element_at(Index vertex) const {
  const Body& body = motion_.body();
  return body.user_element(element_of(body.complex().dart_of(0, vertex)));
}

void Newton::refuse(const StepEquations& equations, const Progress& progress,
                    const std::string& reason) {
  solver_.discard();
  std::ostringstream text;
  text << "Newton's method found no solution at " << time_text(equations.time) << ": " << reason
       << " after " << progress.iterations << " iterations; the residual is "
       << progress.residual / scale_ << " of the forces, the tolerance " << tolerance_;
  if (4 * progress.indefinite > progress.iterations) {
    text << "; the tangent was indefinite in " << progress.indefinite
         << " of them, as where a body buckles, snaps through or slides off what holds it";
    throw NumericalError(text.str(), worst_element());
  }
  for (const NonsmoothTerm* term : nonsmooth_)
    if (const auto alternation = term->alternation())
      throw Unsettled(text.str() + "; " + alternation->text, element_at(alternation->vertex));
  throw NumericalError(text.str(), worst_element());
}

}  // namespace suture
