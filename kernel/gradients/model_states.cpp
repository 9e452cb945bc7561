// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/model_states.hpp"

namespace suture {

ModelStates::ModelStates(Attributes& attributes) {
  for (const auto& instance : attributes.instances())
    for (Table& table : instance->tables())
      for (Column& column : table.columns) {
        if (!column.has_trial()) continue;
        const auto stride = static_cast<std::size_t>(column.spec().components);
        for (int c = 0; c < column.spec().components; ++c)
          components_.push_back({instance.get(), &column, c, size_, stride});
        size_ += column.size() * stride;
      }
}

/// visit(component, row, place).
template <class Visit>
void ModelStates::for_each(Visit visit) const {
  for (const Component& c : components_)
    for (Index row = 0; row < c.column->size(); ++row) visit(c, row, c.place(row));
}

std::vector<double> ModelStates::accepted() const {
  std::vector<double> values(size_);
  for_each([&](const Component& c, Index row, std::size_t place) {
    values[place] = c.column->get(row, c.number);
  });
  return values;
}

std::vector<double> ModelStates::trial() const {
  std::vector<double> values(size_);
  for_each([&](const Component& c, Index row, std::size_t place) {
    values[place] = c.column->trial(row, c.number);
  });
  return values;
}

void ModelStates::set_accepted(std::span<const double> values) const {
  for_each([&](const Component& c, Index row, std::size_t place) {
    c.column->set(row, c.number, values[place]);
  });
}

double ModelStates::work(std::span<const double> weights) const {
  double sum = 0;
  for_each([&](const Component& c, Index row, std::size_t place) {
    sum += weights[place] * c.column->trial(row, c.number);
  });
  return sum;
}

void ModelStates::add_work(const Instance& instance, int dimension, std::span<const double> weights,
                           std::span<double> out) const {
  for (const Component& c : components_) {
    if (c.instance != &instance || c.column->dimension() != dimension) continue;
    for (Index row = 0; row < c.column->size(); ++row)
      out[row] += weights[c.place(row)] * c.column->trial(row, c.number);
  }
}

}  // namespace suture
