// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/arc_length.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace suture {
namespace {

constexpr double first_part = 0.1;         // of the change, predicted for the first segment
constexpr double least_step = 1.0 / 1024;  // of the first segment
constexpr double last_part = 0.02;         // of the change, for Newton's method alone
constexpr double before_end = 0.9;         // of the way to the end, where it is longer
constexpr double least_cosine = 0.7;       // between successive segments
constexpr double point_tolerance = 1e-6;   // of equilibria before the last, relative to the forces
constexpr double first_difference = 0.05;  // of s, where a smooth ramp begins at the rate 0
constexpr double forcing = 1e-3;           // of the linear solves
constexpr unsigned max_points = 1000, max_corrections = 10, max_linear_iterations = 5000;
constexpr unsigned good_iterations = 4;  // per point
// k, by the stiffness of the body along the first direction.
constexpr double first_stiffness = 10, stiffer = 10, largest_stiffness = 1e5;

}  // namespace

ArcLength::ArcLength(LoadPath& path)
    : path_(path),
      matrix_(path.motion().body().attributes(), path.motion().body().terms(),
              path.motion().body().models().workers()) {}

/// Where a motion begins or ends, dr/ds jumps, and it is 0 where nothing else changes: no direction
/// leads on there. So the path is followed from one such time to the next.
void ArcLength::solve(const StepEquations& equations) {
  double start = path_.motion().time();
  for (const double corner : path_.motion().body().constraints().corners(start, equations.time)) {
    StepEquations until = equations;
    until.time = corner;
    until.is_predicted = false;
    follow(until, start);
    start = corner;
  }
  follow(equations, start);
}

void ArcLength::follow(const StepEquations& end, double start) {
  path_.begin(end, start);
  path_.hold_back();
  limits_.clear();
  part_ = 0;
  const std::vector<double> residual = residual_at(0);
  const double least = point_tolerance * path_.newton().scale();
  std::vector<double> rate = rate_at(0, residual);
  if (norm(rate) <= least) rate = rate_at(0, residual, first_difference);
  if (norm(rate) <= least) {  // nothing changes
    if (!path_.try_at(1)) refuse("cannot leave its start");
    return;
  }
  try {
    begin(rate);
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError& error) {
    path_.return_from(error);
    refuse("cannot leave its start");
  }
  for (unsigned points = 0; !advance(); ++points)
    if (points == max_points) refuse("has more than 1000 points; the last is");
}

/// The first direction is that of the linearised equations.
void ArcLength::begin(const std::vector<double>& rate) {
  choice_ = {};
  direction_.clear();
  stiffness_ = largest_stiffness_ = 0;
  set_matrix(0);
  direction_ = solve_linear(rate);
  const double length = norm(direction_);
  for (double& d : direction_) d /= length;
  segment_ = {0, 1 / length};
  step_ = first_part * length;
  least_step_ = least_step * step_;
  const double stiffness = dot(direction_, rate) / length;
  stiffness_ = first_stiffness * stiffness;
  largest_stiffness_ = largest_stiffness * stiffness;
}

/// To the next equilibrium, or back to the last one with a shorter step. True at the end.
bool ArcLength::advance() {
  const double to_end = (1 - part_) / segment_.rate;
  const bool is_rising = segment_.rate > 0;
  const bool ends = is_rising && 1 - part_ <= last_part && to_end <= step_;
  const double length = ends ? to_end : is_rising ? std::min(step_, before_end * to_end) : step_;
  try {
    move(direction_, length);
    if (ends) return arrive(length);
    double part = part_ + length * segment_.rate;
    const unsigned iterations = correct(part);
    if (part >= 1) return arrive(length);
    append(part);
    step_ = length *
            std::clamp(std::sqrt(double{good_iterations} / std::max(iterations, 1u)), 0.5, 2.0);
    report(iterations);
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError& error) {
    path_.return_from(error);
    shorten(length / 2);
  }
  return false;
}

/// From near it, to the equilibrium at the end of the change, at about this distance from the last
/// one: a limit point before it would make Newton's method jump over the rest of the path.
bool ArcLength::arrive(double length) {
  path_.newton().solve(path_.equations_at(1));
  if (norm(way()) > 2 * length) throw NumericalError("the path does not lead straight to the end");
  path_.accept();
  return true;
}

/// From a predicted point to an equilibrium at the same distance. Returns the iterations.
unsigned ArcLength::correct(double& part) {
  Newton& newton = path_.newton();
  double last = 0;
  for (unsigned iteration = 0;; ++iteration) {
    const std::vector<double> residual = residual_at(part);
    const double size = norm(residual);
    if (size <= point_tolerance * newton.scale()) return iteration;
    const bool stalls = iteration > 1 && size > Newton::stalling * last;
    if (stalls && newton.is_at_rounding(path_.equations_at(part), size)) return iteration;
    last = size;
    newton.check_abandoned();
    if (iteration == max_corrections)
      throw NumericalError("Newton's method along the path does not converge",
                           newton.worst_element());
    newton.begin_iteration(iteration, path_.equations_at(part).time);
    const std::vector<double> rate = rate_at(part, residual);
    set_matrix(part);
    std::vector<double> a = solve_linear(residual), b = solve_linear(rate);
    const double change = -dot(direction_, a) / dot(direction_, b);
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += change * b[i];
    move(a, 1);
    part += change;
  }
}

/// From the last equilibrium to the current positions, on the free components.
std::vector<double> ArcLength::way() {
  const double* x = position();
  std::vector<double> way(direction_.size());
  for (std::size_t i = 0; i < way.size(); ++i) {
    const std::size_t row = i / 3 * 4 + i % 3;
    way[i] = x[row] - path_.position()[row];
  }
  matrix_.restrict(way);
  if (!(dot(way, direction_) >= least_cosine * norm(way)))
    throw NumericalError("the path turns sharply, as where another one crosses it");
  return way;
}

/// The current positions are the next equilibrium.
void ArcLength::append(double part) {
  std::vector<double> next = way();
  const double length = norm(next);
  for (double& d : next) d /= length;
  const Segment segment{length, (part - part_) / length};
  const std::optional<double> limit = find_limit(segment);
  path_.accept();
  if (limit) note(*limit, segment.rate < 0);
  direction_ = std::move(next);
  segment_ = segment;
  part_ = part;
}

/// Where ds/dl changes its sign between the middles of the last segment and the next one, a
/// parabola through the three equilibria says how far the limit point of s is from the last one.
/// The equilibrium there has its s but for an error of second order.
std::optional<double> ArcLength::find_limit(const Segment& next) {
  if (segment_.length == 0 || segment_.rate * next.rate >= 0) return {};
  const double curvature = 2 * (next.rate - segment_.rate) / (segment_.length + next.length);
  const double rate = segment_.rate + curvature * segment_.length / 2;
  double limit = part_ - rate * rate / (2 * curvature);
  std::vector<double> next_position = path_.position();
  std::swap_ranges(next_position.begin(), next_position.end(), position());
  move(direction_, -rate / curvature);
  correct(limit);
  std::ranges::copy(next_position, position());
  return limit;
}

void ArcLength::note(double limit, bool is_largest) {
  limits_ += (limits_.empty() ? "" : ", ") + percent(limit);
  const auto& message = path_.newton().on_message;
  if (message)
    message(path_.interval() +
            ": the path of equilibria has a limit point, where the part of the change of loads and "
            "motions is " +
            (is_largest ? "largest, " : "smallest, ") + percent(limit));
}

void ArcLength::shorten(double step) {
  step_ = step;
  if (step_ < least_step_) refuse("ends");
  const auto& note = path_.newton().on_note;
  if (!note) return;
  std::ostringstream text;
  text << "no equilibrium was found along the path (" << path_.failure().reason
       << "); continuing with a step of " << step_ << " m";
  note(text.str());
}

void ArcLength::refuse(const std::string& how) const {
  const std::string limits = limits_.empty() ? "" : ", after limit points at " + limits_;
  path_.refuse("the path of equilibria",
               how + " at " + percent(part_) + " of the change of loads and motions" + limits);
}

void ArcLength::report(unsigned iterations) const {
  const auto& note = path_.newton().on_note;
  if (note)
    note("equilibrium at " + percent(part_) + " of the change in this step, " +
         std::to_string(iterations) + " iterations along the path");
}

// -------------------------------------------------------------- equations --

double* ArcLength::position() { return path_.motion().body().attributes().position().rows(); }

/// Free components; the others follow s.
void ArcLength::move(const std::vector<double>& direction, double length) {
  double* x = position();
  for (std::size_t i = 0; i < direction.size(); ++i) x[i / 3 * 4 + i % 3] += length * direction[i];
}

/// r at the current positions and s, with prescribed components at their positions there.
std::vector<double> ArcLength::residual_at(double part) {
  const StepEquations equations = path_.equations_at(part);
  Body& body = path_.motion().body();
  body.constraints().apply(body.attributes(), equations.time);
  return path_.newton().residual(equations);
}

/// g at the same positions, by a difference.
std::vector<double> ArcLength::rate_at(double part, const std::vector<double>& residual,
                                       double difference) {
  std::vector<double> rate = residual_at(part + difference);
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] = (rate[i] - residual[i]) / difference;
  return rate;
}

/// A at the current positions, and a preconditioner for it.
void ArcLength::set_matrix(double part) {
  const StepEquations equations = path_.equations_at(part);
  matrix_.set({equations.time, equations.dt}, 0, 0, equations.loads);
  if (!choice_.preconditioner) {
    Body& body = path_.motion().body();
    choice_ = choose_preconditioner(body.complex(), body.attributes(), matrix_);
  }
  choice_.preconditioner->build(matrix_);
}

/// (A + k n n^T)^-1 times `right`; k grows until the matrix is positive definite.
std::vector<double> ArcLength::solve_linear(std::span<const double> right) {
  std::vector<double> x(right.size());
  for (;; stiffness_ *= stiffer) {
    matrix_.stiffen(direction_, stiffness_);
    const Newton& newton = path_.newton();
    const LinearSolve solve =
        linear_.solve(matrix_, *choice_.preconditioner, right, x, forcing,
                      checked_limit(max_linear_iterations, [&] { newton.check_abandoned(); }));
    if (solve.outcome == LinearSolve::Outcome::converged) return x;
    if (solve.outcome == LinearSolve::Outcome::too_many)
      throw NumericalError("the linear solver does not converge");
    if (stiffness_ >= largest_stiffness_)
      throw NumericalError(
          "the equilibrium is unstable even at a fixed distance along the path, "
          "as beyond a bifurcation");
  }
}

}  // namespace suture
