// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/parameter_slopes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/gradients/element_colours.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"

namespace suture {
namespace {

// What may be missing, as a part of the sum of absolute values over elements.
constexpr double uncovered = 1e-6;

constexpr double rounding = 1e-13;  // of a sum over vertices, relative

/// Such that both sides lie within the range.
double step_at(double value, double wanted, const suture_parameter& parameter) {
  const double room = std::min(value - parameter.minimum, parameter.maximum - value);
  return std::min(wanted, room / 2);
}

std::vector<double> times(double factor, std::span<const double> numbers) {
  std::vector<double> products(numbers.begin(), numbers.end());
  for (double& product : products) product *= factor;
  return products;
}

/// Visits the numbers of the vertices, edges or faces of an element.
template <class Visit>
void for_each_cell(const CellComplex& complex, int dimension, Index element, Visit visit) {
  if (dimension == 0) std::ranges::for_each(complex.vertices_of(element), visit);
  if (dimension == 1) std::ranges::for_each(complex.edges_of(element), visit);
  if (dimension == 2) std::ranges::for_each(complex.faces_of(element), visit);
}

}  // namespace

/// L by cells.
struct ParameterSlopes::Work {
  std::array<std::vector<double>, 4> cells;  ///< of the instance, by dimension and row
  std::vector<double> vertices;              ///< of the weight of the body
};

struct ParameterSlopes::Sides {
  Work up, down;

  double change(int dimension, Index row) const {
    const auto d = static_cast<std::size_t>(dimension);
    return up.cells[d][row] - down.cells[d][row];
  }
  /// Whether only what belongs to one element has changed.
  bool is_local() const {
    return std::equal(up.cells.begin(), up.cells.begin() + 3, down.cells.begin()) &&
           up.vertices == down.vertices;
  }
};

ParameterSlopes::ParameterSlopes(Body& body, Moment moment, Instance& instance,
                                 std::string parameter, double relative_step)
    : body_(body),
      states_(body.attributes()),
      moment_(std::move(moment)),
      instance_(instance),
      name_(std::move(parameter)) {
  const VariedParameter varied(body.attributes(), instance, body.complex(), name_);
  values_.assign(varied.values().begin(), varied.values().end());
  is_per_element_ = varied.is_per_element();
  double typical = std::abs(varied.parameter().default_value);  // where a value is 0
  for (const double value : values_) typical = std::max(typical, std::abs(value));
  if (!(typical > 0)) typical = 1;
  for (const double value : values_) {
    const double size = value != 0 ? std::abs(value) : typical;
    steps_.push_back(step_at(value, relative_step * size, varied.parameter()));
    if (steps_.back() > 0) continue;
    std::ostringstream text;
    text << instance.title() << ": parameter '" << name_ << "' is " << value
         << ", the end of its range, where it has no derivative; move it inside";
    throw InputError(text.str());
  }
}

double ParameterSlopes::step_along(std::span<const double> weights) const {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (weights[i] != 0) step = std::min(step, steps_[i] / std::abs(weights[i]));
  return std::isfinite(step) ? step : 0;
}

template <class Value>
auto ParameterSlopes::both_sides(std::span<const double> changes, Value value) const {
  VariedParameter varied(body_.attributes(), instance_, body_.complex(), name_);
  const auto at = [&](double sign) {
    std::vector<double> moved(values_);
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += sign * changes[i];
    varied.set(moved);
    return value(sign);
  };
  auto up = at(1);
  return std::pair(std::move(up), at(-1));
}

std::vector<double> ParameterSlopes::of(
    std::span<const double> weights, const std::function<std::vector<double>(double part)>& value) {
  const double step = step_along(weights);
  const double part = step > 0 ? step : best_step;
  auto [up, down] =
      both_sides(times(step, weights), [&](double sign) { return value(sign * part); });
  for (std::size_t i = 0; i < up.size(); ++i) up[i] = (up[i] - down[i]) / (2 * part);
  return up;
}

std::vector<double> ParameterSlopes::forces(std::span<const double> weights) {
  return of(weights, [&](double) { return balanced_forces(body_, moment_); });
}

double ParameterSlopes::along(const Multipliers& multipliers, std::span<const double> weights) {
  const std::vector<double> slopes = of(weights, [&](double) {
    std::vector<double> values = balanced_forces(body_, moment_);
    const double states = multipliers.states.empty() ? 0 : states_.work(multipliers.states);
    const double energy =
        multipliers.energy == 0 ? 0 : multipliers.energy * body_.models().energy(moment_.at.time);
    values.push_back(states + energy);
    return values;
  });
  const std::span all(slopes);
  return dot(multipliers.force, all.first(multipliers.force.size())) + slopes.back();
}

ParameterSlopes::Work ParameterSlopes::work(const Multipliers& multipliers) const {
  Work work;
  for (int d = 0; d < 4; ++d) {
    auto& cells = work.cells[static_cast<std::size_t>(d)];
    cells.assign(instance_.table(d).cells.size(), 0);
    body_.models().add_cell_work(instance_, d, multipliers.force.data(), multipliers.energy,
                                 moment_.at, cells);
    if (!multipliers.states.empty()) states_.add_work(instance_, d, multipliers.states, cells);
  }
  const Vec3 gravity = body_.acceleration(moment_.at.time);
  for (std::size_t i = 0; i < multipliers.force.size(); ++i) {
    if (i % 3 == 0) work.vertices.push_back(0);
    const double acceleration = gravity[i % 3] - (moment_.inertia.empty() ? 0 : moment_.inertia[i]);
    work.vertices.back() += body_.attributes().mass().get(static_cast<Index>(i / 3), 0) *
                            multipliers.force[i] * acceleration;
  }
  return work;
}

ParameterSlopes::Sides ParameterSlopes::change(std::span<const Index> rows,
                                               const Multipliers& multipliers) const {
  std::vector<double> changes(values_.size());
  for (const Index row : rows) changes[row] = steps_[row];
  auto [up, down] = both_sides(changes, [&](double) { return work(multipliers); });
  return {std::move(up), std::move(down)};
}

void ParameterSlopes::add(const Sides& sides, std::span<const Index> rows,
                          std::vector<double>& slopes) const {
  for (const Index row : rows) {
    const Index element = instance_.table(3).cells.cell(row);
    double change = sides.change(3, row);
    for (int d = 0; d < 3; ++d) {
      const CellSet& cells = instance_.table(d).cells;
      if (cells.size() != 0)
        for_each_cell(body_.complex(), d, element,
                      [&](Index cell) { change += sides.change(d, cells.row(cell)); });
    }
    for (const Index v : body_.complex().vertices_of(element))
      change += sides.up.vertices[v] - sides.down.vertices[v];
    slopes[row] = change / (2 * steps_[row]);
  }
}

std::vector<double> ParameterSlopes::each(const Multipliers& multipliers) {
  if (!is_per_element_) return {along(multipliers, std::array{1.0})};
  std::vector<double> slopes(size());
  std::vector<Index> rows;
  for (Index row = 0; row < size(); ++row)
    if (instance_.table(3).cells.is_live(row)) rows.push_back(row);
  const Sides all = change(rows, multipliers);
  if (all.is_local()) {
    add(all, rows, slopes);
    return slopes;
  }
  for (const auto& group : colour_elements(body_.complex(), instance_.table(3).cells))
    add(change(group, multipliers), group, slopes);
  require_sum(multipliers, slopes);
  return slopes;
}

/// What rounding may leave of a change of L.
double ParameterSlopes::noise(const Multipliers& multipliers) const {
  const std::vector<double> forces = total_forces(body_, moment_.at);
  double sum = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double mass = body_.attributes().mass().get(static_cast<Index>(i / 3), 0);
    const double resisted = moment_.inertia.empty() ? 0 : mass * moment_.inertia[i];
    sum += std::abs(multipliers.force[i]) * (std::abs(forces[i]) + std::abs(resisted));
  }
  return rounding * sum;
}

/// The change of L is the sum of the changes by all elements.
void ParameterSlopes::require_sum(const Multipliers& multipliers, std::span<const double> slopes) {
  double sum = 0, size = 0;
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    sum += slopes[i] * steps_[i];
    size += std::abs(slopes[i] * steps_[i]);
  }
  const double whole = along(multipliers, steps_);
  const double missing = std::abs(whole - sum);
  if (missing <= uncovered * size || missing <= noise(multipliers)) return;
  throw InputError(instance_.title() + ": the forces of an element depend on the values of '" +
                   name_ +
                   "' in other elements, and derivatives by element do not cover that; take the "
                   "derivative by the value of all elements together");
}

}  // namespace suture
