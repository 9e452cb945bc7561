// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/state_slopes.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/gradients/element_colours.hpp"
#include "kernel/gradients/rest_slopes.hpp"

namespace suture {
namespace {

// Steps of central differences, of the size of a state, and of an edge. Smaller than the best ones
// for smooth functions: laws with damage have kinks.
constexpr double state_step = 1e-6;
constexpr double least_size = 1e-3;  // of a state that is 0

void require_elements(const ModelStates& states) {
  for (const ModelStates::Component& c : states.components())
    if (c.column->dimension() != 3)
      throw InputError(c.instance->title() + ": the state '" + c.column->spec().name +
                       "' is not on elements, and derivatives cover no other");
}

/// L in each row of an instance.
std::vector<double> work_of(Body& body, const ModelStates& states, const Instance& instance,
                            const TangentTime& at, const Multipliers& multipliers) {
  std::vector<double> work(instance.table(3).cells.size());
  body.models().add_cell_work(instance, 3, multipliers.force.data(), 0, at, work);
  states.add_work(instance, 3, multipliers.states, work);
  return work;
}

double step_of(const ModelStates::Component& c) {
  double size = least_size;
  for (Index row = 0; row < c.column->size(); ++row)
    size = std::max(
        {size, std::abs(c.column->get(row, c.number)), std::abs(c.column->trial(row, c.number))});
  return state_step * size;
}

/// The instances with a memory.
std::vector<Instance*> instances_of(const ModelStates& states) {
  std::vector<Instance*> instances;
  for (const ModelStates::Component& c : states.components())
    if (instances.empty() || instances.back() != c.instance) instances.push_back(c.instance);
  return instances;
}

}  // namespace

std::vector<double> slopes_by_states(Body& body, const ModelStates& states, const TangentTime& at,
                                     const Multipliers& multipliers) {
  require_elements(states);
  std::vector<double> slopes(states.size());
  const std::vector<double> before = states.accepted();
  for (const ModelStates::Component& c : states.components()) {
    const double step = step_of(c);
    const auto move = [&](double way) {
      for (Index row = 0; row < c.column->size(); ++row)
        c.column->set(row, c.number, before[c.place(row)] + way);
    };
    move(step);
    const std::vector<double> up = work_of(body, states, *c.instance, at, multipliers);
    move(-step);
    const std::vector<double> down = work_of(body, states, *c.instance, at, multipliers);
    move(0);
    for (Index row = 0; row < c.column->size(); ++row)
      slopes[c.place(row)] = (up[row] - down[row]) / (2 * step);
  }
  return slopes;
}

std::vector<double> slopes_by_position(Body& body, const ModelStates& states, const TangentTime& at,
                                       const std::vector<double>& weights) {
  require_elements(states);
  Column& position = body.attributes().position();
  std::vector<double> slopes(std::size_t{position.size()} * 3);
  const Multipliers multipliers{std::vector<double>(slopes.size()), 0, weights};
  const double step = state_step * shortest_edge(body);
  const std::vector<double> before(position.rows(),
                                   position.rows() + std::size_t{position.size()} * 4);
  for (Instance* instance : instances_of(states)) {
    const CellSet& elements = instance->table(3).cells;
    for (const std::vector<Index>& group : colour_vertices(body.complex(), elements))
      for (std::size_t c = 0; c < 3; ++c) {
        const auto work_at = [&](double way) {
          for (const Index v : group)
            position.rows()[std::size_t{v} * 4 + c] = before[std::size_t{v} * 4 + c] + way;
          return work_of(body, states, *instance, at, multipliers);
        };
        const std::vector<double> up = work_at(step), down = work_at(-step);
        std::ranges::copy(before, position.rows());
        std::vector<bool> moved(position.size());
        for (const Index v : group) moved[v] = true;
        for (Index row = 0; row < elements.size(); ++row) {
          if (!elements.is_live(row)) continue;
          for (const Index v : body.complex().vertices_of(elements.cell(row)))
            if (moved[v]) slopes[std::size_t{v} * 3 + c] += (up[row] - down[row]) / (2 * step);
        }
      }
  }
  return slopes;
}

}  // namespace suture
