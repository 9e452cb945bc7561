// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/arc_length.hpp"

#include <algorithm>
#include <cmath>

namespace suture {
namespace {

constexpr double first_part = 0.1;         // of the change, predicted for the first segment
constexpr double least_step = 1.0 / 1024;  // of the first segment
constexpr double overshoot = 1.1;          // of the predicted distance to the end
constexpr double least_cosine = 0.7;       // between successive segments
constexpr double tolerance = 1e-6;         // of equilibria before the last, relative to the forces
constexpr double difference = 1e-6;        // of s, for g = dr/ds
constexpr double forcing = 1e-3;           // of the linear solves
constexpr unsigned max_points = 1000, max_iterations = 10, max_linear_iterations = 5000;
constexpr unsigned good_iterations = 4;  // per point
// k, by the stiffness of the body along the first direction.
constexpr double first_stiffness = 10, stiffer = 10, largest_stiffness = 1e5;

double norm(std::span<const double> v) { return std::sqrt(dot(v, v)); }

}  // namespace

ArcLength::ArcLength(LoadPath& path)
    : path_(path), matrix_(path.motion().body().attributes(), path.motion().body().terms()) {}

void ArcLength::solve(const StepEquations& equations) {
  path_.begin(equations);
  path_.hold_back();
  limits_.clear();
  part_ = 0;
  const std::vector<double> rate = rate_at(0);
  if (norm(rate) == 0) {  // nothing changes
    if (!path_.try_at(1)) refuse("begins");
    return;
  }
  begin(rate);
  for (unsigned points = 0; !advance(); ++points)
    if (points == max_points) refuse("was followed for 1000 points");
}

/// The first direction is that of the linearised equations.
void ArcLength::begin(const std::vector<double>& rate) {
  choice_ = {};
  direction_.clear();
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
  try {
    const double to_end = overshoot * (1 - part_) / segment_.rate;
    const double length = segment_.rate > 0 ? std::min(step_, to_end) : step_;
    double part = part_ + length * segment_.rate;
    move(direction_, length);
    const unsigned iterations = correct(part);
    if (part >= 1) return arrive(part);
    append(part);
    step_ = length *
            std::clamp(std::sqrt(double{good_iterations} / std::max(iterations, 1u)), 0.5, 2.0);
    report(iterations);
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError& error) {
    path_.return_from(error);
    const auto& note = path_.newton().on_note;
    if (note)
      note("no equilibrium at a distance of " + std::to_string(step_) + " m along the path (" +
           error.what() + "); continuing with half of it");
    shorten();
  }
  return false;
}

/// From a predicted point to an equilibrium at the same distance. Returns the iterations.
unsigned ArcLength::correct(double& part) {
  for (unsigned iteration = 0;; ++iteration) {
    const std::vector<double> residual = residual_at(part);
    if (norm(residual) <= tolerance * path_.newton().scale()) return iteration;
    if (iteration == max_iterations)
      throw NumericalError("Newton's method along the path does not converge",
                           path_.newton().worst_element());
    const std::vector<double> rate = rate_at(part);
    set_matrix(part);
    std::vector<double> a = solve_linear(residual), b = solve_linear(rate);
    const double change = -dot(direction_, a) / dot(direction_, b);
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += change * b[i];
    move(a, 1);
    part += change;
  }
}

/// The current positions are the next equilibrium.
void ArcLength::append(double part) {
  const double* x = position();
  std::vector<double> way(direction_.size());
  for (std::size_t i = 0; i < way.size(); ++i) {
    const std::size_t row = i / 3 * 4 + i % 3;
    way[i] = x[row] - path_.position()[row];
  }
  matrix_.restrict(way);
  const double length = norm(way);
  for (double& d : way) d /= length;
  if (dot(way, direction_) < least_cosine)
    throw NumericalError("the path turns sharply, as where another one crosses it");
  find_limit({length, (part - part_) / length});
  path_.accept();
  direction_ = std::move(way);
  segment_ = {length, (part - part_) / length};
  part_ = part;
}

/// Where ds/dl changes its sign between the middles of the last segment and the next one, a
/// parabola through the three equilibria says how far the limit point of s is from the last one.
/// The equilibrium there has its s but for an error of second order.
void ArcLength::find_limit(const Segment& next) {
  if (segment_.length == 0 || segment_.rate * next.rate >= 0) return;
  const double curvature = 2 * (next.rate - segment_.rate) / (segment_.length + next.length);
  const double rate = segment_.rate + curvature * segment_.length / 2;
  double limit = part_ - rate * rate / (2 * curvature);
  std::vector<double> next_position = path_.position();
  std::swap_ranges(next_position.begin(), next_position.end(), position());
  move(direction_, -rate / curvature);
  correct(limit);
  std::ranges::copy(next_position, position());
  limits_ += (limits_.empty() ? "" : ", ") + percent(limit);
  const auto& message = path_.newton().on_message;
  if (message)
    message(path_.interval() +
            ": the path of equilibria has a limit point, where the part of the " +
            "change of loads and motions is " + (curvature < 0 ? "largest, " : "smallest, ") +
            percent(limit));
}

void ArcLength::shorten() {
  step_ /= 2;
  if (step_ < least_step_) refuse("ends");
}

/// The path has crossed the end of the change between the last equilibrium and the current
/// positions.
bool ArcLength::arrive(double part) {
  const double weight = (1 - part_) / (part - part_);
  double* x = position();
  for (std::size_t i = 0; i < path_.position().size(); ++i)
    x[i] = path_.position()[i] + weight * (x[i] - path_.position()[i]);
  if (path_.try_at(1)) return true;
  shorten();
  return false;
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
const std::vector<double>& ArcLength::residual_at(double part) {
  const StepEquations equations = path_.equations_at(part);
  Body& body = path_.motion().body();
  body.constraints().apply(body.attributes(), equations.time);
  return path_.newton().residual(equations);
}

/// g at the same positions, by a difference; prescribed components stay at those of s.
std::vector<double> ArcLength::rate_at(double part) {
  std::vector<double> rate = residual_at(part + difference);
  const std::vector<double>& residual = residual_at(part);
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
    const LinearSolve solve =
        linear_.solve(matrix_, *choice_.preconditioner, right, x, forcing, max_linear_iterations);
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
