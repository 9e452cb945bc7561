// SPDX-License-Identifier: GPL-3.0-or-later
//
// Newton's method for a step of backward Euler, or a steady state (per_dt = 0):
//   (C / dt - dr/du) delta = r(u) + q - C (u - u0) / dt      at vertices that are not prescribed
// The matrix is symmetric, and is solved by conjugate gradients with its diagonal.
#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/fields/field_equation.hpp"

namespace suture {
namespace {

constexpr unsigned newton_iterations = 30;
/// A part of the residual at the start.
constexpr double newton_tolerance = 1e-10;
/// A part of the products of which the residual is a sum.
constexpr double rounding_of_sums = 1e-14;
constexpr double krylov_tolerance = 1e-12;

}  // namespace

/// - dr_v/du_v, and sum |dr_v/du_w| over all w.
void FieldEquation::find_diagonal(double time) {
  diagonal_.assign(attributes_.vertex_count(), 0);
  sums_.assign(attributes_.vertex_count(), 0);
  rates_.for_each_tangent(1, 0, time, [&](const CellTangents& cells) {
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

/// Returns its norm.
double FieldEquation::find_residual(double per_dt) {
  const double* const u = field_.values->rows();
  residual_.resize(attributes_.vertex_count());
  for (Index v = 0; v < residual_.size(); ++v) {
    const double in = rate(v) + flux(v);
    residual_[v] = is_prescribed(v) ? 0 : in - capacity(v) * (u[v] - before_[v]) * per_dt;
  }
  return norm(residual_);
}

void FieldEquation::apply(const double* d, double* out, double time, double per_dt) {
  direction_.assign(std::size_t{3} * attributes_.vertex_count(), 0);
  product_.assign(direction_.size(), 0);
  for (std::size_t v = 0; v < direction_.size() / 3; ++v) direction_[3 * v] = d[v];
  rates_.add_tangent(direction_.data(), 1, 0, time, product_.data());
  for (Index v = 0; v < attributes_.vertex_count(); ++v)
    out[v] = is_prescribed(v) ? 0 : capacity(v) * per_dt * d[v] - product_[std::size_t{3} * v];
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

void FieldEquation::solve(double time, double per_dt) {
  double* const u = field_.values->rows();
  before_.assign(u, u + attributes_.vertex_count());
  for (const Held& held : held_) u[held.vertex] = prescribed(held, time);
  change_.resize(before_.size());
  double first = 0;
  for (unsigned i = 0; i <= newton_iterations; ++i) {
    evaluate(time);
    const double norm = find_residual(per_dt);
    if (i == 0) first = norm;
    if (norm <= newton_tolerance * first) return book(per_dt);
    find_diagonal(time);
    if (norm <= rounding(per_dt)) return book(per_dt);
    const auto precondition = [&](const double* r, double* z) {
      for (Index v = 0; v < attributes_.vertex_count(); ++v) {
        const double entry = capacity(v) * per_dt + diagonal_[v];
        z[v] = entry > 0 && !is_prescribed(v) ? r[v] / entry : 0;
      }
    };
    const LinearSolve solved = solver_.solve(
        [&](const double* d, double* out) { apply(d, out, time, per_dt); }, precondition, residual_,
        change_, krylov_tolerance, 10 * attributes_.vertex_count() + 100);
    if (solved.outcome == LinearSolve::Outcome::indefinite && solved.iterations == 0) break;
    for (Index v = 0; v < change_.size(); ++v) u[v] += change_[v];
  }
  std::ranges::copy(before_, u);
  throw NumericalError(
      "the equations of field '" + field_.name + "' are not solved" +
      (per_dt == 0 ? ": a steady state needs a prescribed value in each piece that a flux enters, "
                     "and rates that fall with the field"
                   : "; reduce /solver/dt"));
}

/// What the prescribed vertices have taken up beside their rate has come through them.
void FieldEquation::book(double per_dt) {
  if (per_dt == 0) {
    balance_.changed = sum_content() - start_ - balance_.inflow - balance_.produced;
    return;
  }
  const double* const u = field_.values->rows();
  double produced = 0, in = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    produced += rate(v);
    in += flux(v);
  }
  for (const Held& held : held_) {
    const Index v = held.vertex;
    in += capacity(v) * (u[v] - before_[v]) * per_dt - rate(v) - flux(v);
  }
  balance_.produced += produced / per_dt;
  balance_.inflow += in / per_dt;
}

}  // namespace suture
