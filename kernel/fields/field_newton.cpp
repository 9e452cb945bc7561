// SPDX-License-Identifier: GPL-3.0-or-later
//
// Newton's method for a step of backward Euler, or a steady state (per_dt = 0):
//   ((C + L) / dt - dr/du) delta = r(u) + q - C (u - u0) / dt - L (u - u1) / dt
// at vertices that are free. u0 is the value at the start of the step, u1 that of the turn before,
// and L the relaxation (SUTURE_RELAXATION), which is without effect where turns agree. A field that
// does not fall (SUTURE_RISING) is held where it is u0 and the right side is negative: an active
// set (Hintermueller, Ito, Kunisch, SIAM J. Optim. 13, 2002, 865). The matrix is symmetric, and is
// solved by conjugate gradients with its diagonal.
#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/fields/field_equation.hpp"

namespace suture {
namespace {

constexpr unsigned newton_iterations = 50;
/// A part of the largest residual.
constexpr double newton_tolerance = 1e-10;
/// A part of the products of which the residual is a sum.
constexpr double rounding_of_sums = 1e-14;
constexpr double krylov_tolerance = 1e-12;

}  // namespace

/// - dr_v/du_v, and sum |dr_v/du_w| over all w.
void FieldEquation::find_diagonal(double time, double per_dt) {
  diagonal_.assign(attributes_.vertex_count(), 0);
  sums_.assign(attributes_.vertex_count(), 0);
  rates_.for_each_tangent(1, per_dt, time, [&](const CellTangents& cells) {
    const Index rows = 3 * cells.nodes;
    for (Index cell = 0; cell < cells.cells; ++cell)
      for (Index a = 0; a < cells.nodes; ++a) {
        const Index v = cells.vertices[cell * cells.nodes + a];
        for (Index b = 0; b < cells.nodes; ++b) {
          const double value = cells.values[(std::size_t{3 * b} * rows + 3 * a) * 8 + cell];
          sums_[v] += std::abs(value);
          if (a == b) diagonal_[v] -= value;
        }
      }
  });
}

/// C (u - u0) / dt: what a vertex has taken up in the step, per second.
double FieldEquation::taken_up(Index v, double per_dt) const {
  return capacity(v) * (field_.values->rows()[v] - kept_[v]) * per_dt;
}

/// Evaluates the rates, finds which vertices are free, and returns the norm of the residual there.
double FieldEquation::find_residual(double time, double per_dt) {
  const double* const u = field_.values->rows();
  if (field_.rate)
    for (Index v = 0; v < kept_.size(); ++v) field_.rate->rows()[v] = (u[v] - kept_[v]) * per_dt;
  evaluate(time);
  residual_.resize(kept_.size());
  is_free_.resize(kept_.size());
  for (Index v = 0; v < residual_.size(); ++v) {
    residual_[v] =
        rate(v) + flux(v) - taken_up(v, per_dt) - relaxation(v) * (u[v] - before_[v]) * per_dt;
    const bool cannot_fall = field_.is_rising && u[v] <= kept_[v] && residual_[v] < 0;
    is_free_[v] = !is_prescribed(v) && !cannot_fall;
    if (!is_free_[v]) residual_[v] = 0;
  }
  return norm(residual_);
}

void FieldEquation::apply(const double* d, double* out, double time, double per_dt) {
  direction_.assign(std::size_t{3} * attributes_.vertex_count(), 0);
  product_.assign(direction_.size(), 0);
  for (std::size_t v = 0; v < direction_.size() / 3; ++v) direction_[3 * v] = d[v];
  rates_.add_tangent(direction_.data(), 1, per_dt, time, product_.data());
  for (Index v = 0; v < attributes_.vertex_count(); ++v)
    out[v] = is_free_[v]
                 ? (capacity(v) + relaxation(v)) * per_dt * d[v] - product_[std::size_t{3} * v]
                 : 0;
}

double FieldEquation::rounding(double per_dt) const {
  const double* const u = field_.values->rows();
  double sum = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    const double product = (capacity(v) * per_dt + std::abs(diagonal_[v])) * u[v];
    sum += product * product;
  }
  return rounding_of_sums * std::sqrt(sum);
}

/// Finds change_; false if the matrix is not positive.
bool FieldEquation::solve_linear(double time, double per_dt) {
  const auto precondition = [&](const double* r, double* z) {
    for (Index v = 0; v < attributes_.vertex_count(); ++v) {
      const double entry = (capacity(v) + relaxation(v)) * per_dt + diagonal_[v];
      z[v] = entry > 0 && is_free_[v] ? r[v] / entry : 0;
    }
  };
  const LinearSolve solved = solver_.solve(
      [&](const double* d, double* out) { apply(d, out, time, per_dt); }, precondition, residual_,
      change_, krylov_tolerance, 10 * attributes_.vertex_count() + 100);
  return solved.outcome != LinearSolve::Outcome::indefinite || solved.iterations != 0;
}

void FieldEquation::solve(double time, double per_dt) {
  double* const u = field_.values->rows();
  before_.assign(u, u + attributes_.vertex_count());
  for (const Held& held : held_) u[held.vertex] = prescribed(held, time);
  change_.resize(before_.size());
  double largest = 0;
  for (unsigned i = 0; i <= newton_iterations; ++i) {
    const double norm = find_residual(time, per_dt);
    largest = std::max(largest, norm);
    if (norm <= newton_tolerance * largest) return book(per_dt);
    find_diagonal(time, per_dt);
    if (norm <= rounding(per_dt)) return book(per_dt);
    if (!solve_linear(time, per_dt)) break;
    for (Index v = 0; v < change_.size(); ++v) {
      u[v] += change_[v];
      if (field_.is_rising && !is_prescribed(v)) u[v] = std::max(u[v], kept_[v]);
    }
  }
  std::ranges::copy(before_, u);
  throw NumericalError(
      "the equations of field '" + field_.name + "' are not solved" +
      (per_dt == 0 ? ": a steady state needs a prescribed value in each piece that a flux enters, "
                     "and rates that fall with the field"
                   : "; reduce /solver/dt"));
}

double FieldEquation::relative_change() const {
  const double* const u = field_.values->rows();
  double change = 0, largest = 0;
  for (std::size_t v = 0; v < before_.size(); ++v) {
    change = std::max(change, std::abs(u[v] - before_[v]));
    largest = std::max(largest, std::abs(u[v]));
  }
  return change == 0 ? 0 : change / largest;
}

/// What the prescribed vertices have taken up beside their rate has come through them; what those
/// that cannot fall would lose is not produced.
void FieldEquation::book(double per_dt) {
  balance_ = kept_balance_;
  for (Index v = 0; v < attributes_.vertex_count(); ++v)
    balance_.dissipated += rate(v) * (field_.values->rows()[v] - kept_[v]);
  if (per_dt == 0) {
    balance_.changed = sum_content() - start_ - balance_.inflow - balance_.produced;
    return;
  }
  double produced = 0, in = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    produced += rate(v);
    in += flux(v);
    if (!is_free_[v] && !is_prescribed(v)) produced += taken_up(v, per_dt) - rate(v) - flux(v);
  }
  for (const Held& held : held_)
    in += taken_up(held.vertex, per_dt) - rate(held.vertex) - flux(held.vertex);
  balance_.produced += produced / per_dt;
  balance_.inflow += in / per_dt;
}

}  // namespace suture
