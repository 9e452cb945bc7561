// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernel/attributes/varied_parameter.hpp"
#include "kernel/dynamics/body.hpp"
#include "kernel/gradients/model_states.hpp"
#include "kernel/gradients/total_forces.hpp"

namespace suture {

/// What multiplies forces, the stored energy and the states z' of models after a step in a scalar
///   L = force . f + energy W + states . z'
struct Multipliers {
  std::vector<double> force;  ///< 3 numbers per vertex
  double energy = 0;
  std::vector<double> states{};  ///< as ModelStates numbers them; empty: none
};

/// Derivatives of the forces on a body by a parameter p of a model, at fixed positions: by central
/// differences of all elements at once,
///   df/dp = (f(p + h) - f(p - h)) / 2h
/// so that a field of any length takes two evaluations of the forces. Where elements contribute to
/// edges, faces or masses, those of one colour are changed at a time (element_colours.hpp).
/// Relative error: some 1e-10. The body is as before when a function returns, bit by bit.
class ParameterSlopes {
 public:
  /// About the cube root of the rounding: the error of central differences is least there.
  static constexpr double best_step = 1e-5;
  /// `relative_step`: h over the size of a value; less beside the ends of its range. Throws
  /// InputError if the model has no such parameter, if it is not a number, or if it lies at an end.
  ParameterSlopes(Body& body, Moment moment, Instance& instance, std::string parameter,
                  double relative_step = best_step);

  /// The number of values: one per row of instance.table(3) of a parameter that may differ from
  /// element to element, otherwise one.
  std::size_t size() const { return steps_.size(); }
  bool is_per_element() const { return is_per_element_; }
  std::span<const double> steps() const { return steps_; }  ///< h of each value
  /// df/dp of all terms, where the values of p change by these weights: 3 numbers per vertex.
  std::vector<double> forces(std::span<const double> weights);
  /// dL/dp in that direction.
  double along(const Multipliers& multipliers, std::span<const double> weights);
  /// dL/dp for each value, 0 in dead rows. Throws InputError if forces on cells of one element
  /// depend on the parameters of others in a way that this does not cover.
  std::vector<double> each(const Multipliers& multipliers);
  /// The derivative of what `value` returns, numbers in a row, in that direction; it is called with
  /// the part of the direction by which the parameter has changed.
  std::vector<double> of(std::span<const double> weights,
                         const std::function<std::vector<double>(double part)>& value);

 private:
  struct Work;
  /// value(sign) with the parameter changed by these numbers, and by their opposites.
  template <class Value>
  auto both_sides(std::span<const double> changes, Value value) const;
  /// L by cells, where the values of some rows are changed by their steps.
  struct Sides;
  Sides change(std::span<const Index> rows, const Multipliers& multipliers) const;
  Work work(const Multipliers& multipliers) const;
  void add(const Sides& sides, std::span<const Index> rows, std::vector<double>& slopes) const;
  double noise(const Multipliers& multipliers) const;
  void require_sum(const Multipliers& multipliers, std::span<const double> slopes);
  double step_along(std::span<const double> weights) const;

  Body& body_;
  ModelStates states_;
  Moment moment_;
  Instance& instance_;
  std::string name_;
  std::vector<double> values_, steps_;
  bool is_per_element_;
};

}  // namespace suture
