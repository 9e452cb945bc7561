// SPDX-License-Identifier: GPL-3.0-or-later
//
// Newton's method for a step of backward Euler, or a steady state (per_dt = 0):
//   ((C + L) / dt - dr/du) delta = r(u) + q - C (u - u0) / dt - L (u - u1) / dt
// at vertices that are free. u0 is the value at the start of the step, u1 that of the turn before,
// and L the relaxation (SUTURE_RELAXATION), which is without effect where turns agree. A field that
// does not fall (SUTURE_RISING) is held where it is u0 and the right side is negative: an active
// set (Hintermueller, Ito, Kunisch, SIAM J. Optim. 13, 2002, 865).
//
// The matrix is symmetric, and is solved by conjugate gradients. Where their diagonal is not good
// enough, as in steady states, the multigrid of the motion takes over, with the components of the
// field in place of those of positions. It is built once in a call, so that results depend on the
// state alone.
#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/fields/field_equation.hpp"
#include "kernel/solvers/multigrid.hpp"

namespace suture {
namespace {

constexpr unsigned newton_iterations = 50;
/// A part of the largest residual.
constexpr double newton_tolerance = 1e-10;
/// A part of the products of which the residual is a sum.
constexpr double rounding_of_sums = 1e-14;
constexpr double krylov_tolerance = 1e-12;
/// What a constant changes in a rate, relative to the diagonal; less is rounding.
constexpr double least_effect = 1e-10;
/// With the diagonal alone: about as long as it takes to build the multigrid.
constexpr unsigned simple_iterations = 40;
constexpr unsigned multigrid_iterations = 5000;

}  // namespace

/// - dr_v/du_v, and sum |dr_v/du_w| over all w and their components; with films.
void FieldEquation::find_diagonal(double time, double per_dt) {
  diagonal_.assign(std::size_t{vertices()} * 3, 0);
  sums_.assign(diagonal_.size(), 0);
  rates_.for_each_tangent(1, per_dt, time, [&](const CellTangents& cells) {
    const std::size_t rows = std::size_t{cells.nodes} * 3;
    const auto for_each_row = [&](auto visit) {
      for (std::size_t node = 0; node < cells.nodes; ++node)
        for (std::size_t c = 0; c < components_; ++c) visit(node, node * 3 + c);
    };
    const auto entry = [&](std::size_t column, std::size_t row) {
      return cells.values + (column * rows + row) * 8;
    };
    for_each_row([&](std::size_t node, std::size_t row) {
      std::array<double, 8> sums{};
      for_each_row([&](std::size_t, std::size_t column) {
        for (std::size_t cell = 0; cell < 8; ++cell)
          sums[cell] += std::abs(entry(column, row)[cell]);
      });
      for (std::size_t cell = 0; cell < cells.cells; ++cell) {
        const Index vertex = cells.vertices[cell * cells.nodes + node];
        const std::size_t place = std::size_t{vertex} * 3 + row % 3;
        sums_[place] += sums[cell];
        diagonal_[place] -= entry(row, row)[cell];
      }
    });
  });
  if (exchange_.adds_no_rows()) return;
  const std::vector<double>& films = exchange_.rows(time);
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    sums_[i] += films[std::size_t{v} * 4 + c];
    diagonal_[i] += films[std::size_t{v} * 4 + c];
  });
}

/// C (u - u0) / dt: what a vertex has taken up in the step, per second.
double FieldEquation::taken_up(Index v, std::size_t c, double per_dt) const {
  return capacity(v) * (value(v, c) - kept_[std::size_t{v} * 3 + c]) * per_dt;
}

/// Evaluates the rates, finds which vertices are free, and returns the norm of the residual there.
double FieldEquation::find_residual(double time, double per_dt) {
  if (field_.rate)
    for_each_value([&](Index v, std::size_t c, std::size_t i) {
      rate_of_change(v, c) = (value(v, c) - kept_[i]) * per_dt;
    });
  evaluate(time);
  residual_.assign(kept_.size(), 0);
  is_free_.assign(kept_.size(), 0);
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    const double residual = rate(v, c) + flux(v, c) - taken_up(v, c, per_dt) -
                            relaxation(v) * (value(v, c) - before_[i]) * per_dt;
    const bool cannot_fall = field_.is_rising && value(v, c) <= kept_[i] && residual < 0;
    is_free_[i] = !is_prescribed(v, c) && !cannot_fall;
    if (is_free_[i]) residual_[i] = residual;
  });
  return norm(residual_);
}

double FieldEquation::rounding(double per_dt) const {
  double sum = 0;
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    const double product = (capacity(v) * per_dt + std::abs(diagonal_[i])) * value(v, c);
    sum += product * product;
  });
  return rounding_of_sums * std::sqrt(sum);
}

/// Vertices without a rate and a capacity take no part.
void FieldEquation::set_matrix(double time, double per_dt) {
  std::vector<double> masses;
  if (per_dt != 0)
    for (Index v = 0; v < vertices(); ++v) masses.push_back((capacity(v) + relaxation(v)) * per_dt);
  std::vector<std::uint8_t> free(diagonal_.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    diagonal_[i] += per_dt != 0 ? masses[i / 3] : 0;
    free[i] = is_free_[i] && diagonal_[i] != 0;
  }
  matrix_.set(time, per_dt, std::move(free), std::move(masses));
}

/// A hierarchy serves as long as cells and free components stay.
void FieldEquation::build_multigrid() {
  if (!multigrid_ || multigrid_free_ != matrix_.free()) {
    multigrid_ = make_multigrid(complex_, attributes_, {.finds_end = false});
    multigrid_free_ = matrix_.free();
    is_built_ = false;
  }
  if (!is_built_) multigrid_->build(matrix_);
  is_built_ = true;
}

/// Finds change_; false if the matrix is not positive, or if nothing balances the residual.
bool FieldEquation::solve_linear(double time, double per_dt) {
  set_matrix(time, per_dt);
  if (per_dt != 0) return solve_definite();
  const OpenGroups open = find_open_groups();
  if (!is_balanced(open) || !solve_definite()) return false;
  keep_contents(open);
  return true;
}

/// The same, but for what open groups contain.
bool FieldEquation::solve_definite() {
  const auto product = [&](const double* d, double* out) { matrix_.apply(d, out); };
  const auto by_diagonal = [&](const double* r, double* z) {
    for (std::size_t i = 0; i < diagonal_.size(); ++i)
      z[i] = diagonal_[i] > 0 && matrix_.free()[i] ? r[i] / diagonal_[i] : 0;
  };
  std::ranges::fill(change_, 0.0);
  rest_ = residual_;
  double tolerance = krylov_tolerance;
  if (!is_built_) {
    const LinearSolve first = solver_.solve(product, by_diagonal, residual_, change_,
                                            krylov_tolerance, simple_iterations, matrix_.workers());
    iterations_.all += first.iterations;
    if (first.outcome != LinearSolve::Outcome::too_many)
      return first.outcome == LinearSolve::Outcome::converged || first.iterations != 0;
    matrix_.apply(change_.data(), rest_.data());
    for (std::size_t i = 0; i < rest_.size(); ++i) rest_[i] = residual_[i] - rest_[i];
    tolerance *= norm(residual_) / norm(rest_);
  }
  build_multigrid();
  matrix_.restrict(rest_);
  const LinearSolve solved =
      solver_.solve(matrix_, *multigrid_, rest_, correction_, tolerance, multigrid_iterations);
  iterations_.all += solved.iterations;
  iterations_.with_multigrid += solved.iterations;
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] += correction_[i];
  return solved.outcome == LinearSolve::Outcome::converged || solved.iterations != 0;
}

void FieldEquation::solve(double time, double per_dt) {
  before_.assign(kept_.size(), 0);
  for_each_value([&](Index v, std::size_t c, std::size_t i) { before_[i] = value(v, c); });
  for (const Held& held : held_) value(held.vertex, held.component) = prescribed(held, time);
  change_.resize(before_.size());
  correction_.resize(before_.size());
  is_built_ = false;
  double largest = 0;
  for (unsigned i = 0; i <= newton_iterations; ++i) {
    const double norm = find_residual(time, per_dt);
    largest = std::max(largest, norm);
    if (norm <= newton_tolerance * largest) return book(time, per_dt);
    find_diagonal(time, per_dt);
    if (norm <= rounding(per_dt)) return book(time, per_dt);
    if (!solve_linear(time, per_dt)) break;
    for_each_value([&](Index v, std::size_t c, std::size_t at) {
      value(v, c) += change_[at];
      if (field_.is_rising && !is_prescribed(v, c)) value(v, c) = std::max(value(v, c), kept_[at]);
    });
  }
  for_each_value([&](Index v, std::size_t c, std::size_t i) { value(v, c) = before_[i]; });
  throw NumericalError(
      "the equations of field '" + field_.name + "' are not solved" +
      (per_dt == 0 ? ": a steady state needs a prescribed value in each piece that a flux enters, "
                     "and rates that fall with the field"
                   : "; reduce /solver/dt"));
}

// -------------------------------------------------------------- open groups --
//
// A steady state does not say what an island contains where no value is prescribed and nothing but
// conduction acts: a constant can be added to it. Such a group of values keeps its content. It has
// a state only if nothing flows in. A group has one component, or all where rates couple them.

FieldEquation::OpenGroups FieldEquation::find_open_groups() const {
  Index count = 0;
  const std::vector<Index> island_of = complex_.islands(&count);
  std::vector<Index> islands(vertices(), none);
  for (Index e = 0; e < island_of.size(); ++e)
    if (island_of[e] != none)
      for (const Index v : complex_.vertices_of(e)) islands[v] = island_of[e];
  OpenGroups groups{std::vector<Index>(diagonal_.size(), none)};
  for (std::size_t c = 0; c < components_; ++c) add_open_groups(groups, islands, count, c, c);
  if (components_ > 1) add_open_groups(groups, islands, count, 0, components_ - 1);
  return groups;
}

/// Adds those of the components `first` to `last` on which a constant has no effect.
void FieldEquation::add_open_groups(OpenGroups& groups, const std::vector<Index>& islands,
                                    Index count, std::size_t first, std::size_t last) const {
  std::vector<char> is_open(count, 1);
  std::vector<double> one(diagonal_.size()), effect(diagonal_.size());
  const auto for_each = [&](auto visit) {
    for_each_value([&](Index v, std::size_t c, std::size_t i) {
      if (sums_[i] != 0 && c >= first && c <= last) visit(is_open[islands[v]], v, i);
    });
  };
  for_each([&](char& open, Index, std::size_t i) {
    if (!matrix_.free()[i] || groups.of[i] != none) open = 0;
  });
  if (std::ranges::find(is_open, 1) == is_open.end()) return;
  for_each([&](char open, Index, std::size_t i) { one[i] = open; });
  matrix_.apply(one.data(), effect.data());
  for_each([&](char& open, Index, std::size_t i) {
    if (std::abs(effect[i]) > least_effect * diagonal_[i]) open = 0;
  });
  for_each([&](char open, Index v, std::size_t i) {
    if (open) groups.of[i] = groups.count + islands[v];
  });
  groups.count += count;
}

/// Whether nothing flows into open groups.
bool FieldEquation::is_balanced(const OpenGroups& groups) const {
  std::vector<double> inflow(groups.count), scale(groups.count);
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    const Index g = groups.of[i];
    if (g == none) return;
    inflow[g] += residual_[i];
    scale[g] += std::abs(diagonal_[i] * value(v, c));
  });
  for (Index g = 0; g < groups.count; ++g)
    if (std::abs(inflow[g]) > rounding_of_sums * scale[g]) return false;
  return true;
}

void FieldEquation::keep_contents(const OpenGroups& groups) {
  std::vector<double> content(groups.count), weight(groups.count);
  for_each_value([&](Index v, std::size_t, std::size_t i) {
    const Index g = groups.of[i];
    if (g == none) return;
    const double share = capacity(v) > 0 ? capacity(v) : diagonal_[i];
    content[g] += share * change_[i];
    weight[g] += share;
  });
  for_each_value([&](Index, std::size_t, std::size_t i) {
    if (const Index g = groups.of[i]; g != none) change_[i] -= content[g] / weight[g];
  });
}

// --------------------------------------------------------- what was solved --

double FieldEquation::relative_change() const {
  Contents change{}, largest{};
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    change[c] = std::max(change[c], std::abs(value(v, c) - before_[i]));
    largest[c] = std::max(largest[c], std::abs(value(v, c)));
  });
  double relative = 0;
  for (std::size_t c = 0; c < components_; ++c)
    if (change[c] != 0) relative = std::max(relative, change[c] / largest[c]);
  return relative;
}

/// What the prescribed vertices have taken up beside their rate has come through them; what those
/// that cannot fall would lose is not produced. What comes in supplies its value times the field.
void FieldEquation::book(double time, double per_dt) {
  booked_ = kept_booked_;
  if (!has_dissipation_)
    for_each_value([&](Index v, std::size_t c, std::size_t i) {
      booked_.dissipated += rate(v, c) * (value(v, c) - kept_[i]);
    });
  if (per_dt == 0) {
    const Contents now = contents();
    for (std::size_t c = 0; c < components_; ++c)
      booked_.of[c].changed = now[c] - start_[c] - booked_.of[c].inflow - booked_.of[c].produced;
    return;
  }
  if (has_dissipation_) booked_.dissipated += rates_.dissipation(time) / per_dt;
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    double produced = rate(v, c), in = flux(v, c);
    if (is_prescribed(v, c))
      in = taken_up(v, c, per_dt) - rate(v, c);
    else if (!is_free_[i])
      produced = taken_up(v, c, per_dt) - flux(v, c);
    booked_.of[c].produced += produced / per_dt;
    booked_.of[c].inflow += in / per_dt;
    booked_.supplied += value(v, c) * in / per_dt;
  });
}

}  // namespace suture
