// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/varied_parameter.hpp"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"

namespace suture {
namespace {

/// visit(column) for what parameters may change.
template <class Visit>
void for_each_column(Attributes& attributes, Instance& instance, Visit visit) {
  for (Table& table : instance.tables())
    for (Column& column : table.columns) visit(column);
  visit(attributes.mass());
  for (const VertexField& field : attributes.fields())
    for (Column* sum : field.sums())
      if (sum) visit(*sum);
}

}  // namespace

std::size_t VariedParameter::number_of(const Instance& instance, const std::string& name) {
  const std::span all(instance.model().parameters, instance.model().parameter_count);
  const auto found = std::ranges::find_if(
      all, [&](const suture_parameter& p) { return std::string_view(p.name) == name; });
  if (found == all.end()) {
    std::vector<std::string> names;
    for (const suture_parameter& p : all) names.emplace_back(p.name);
    throw InputError(instance.title() + " has no parameter '" + name + "'" +
                     did_you_mean(name, names));
  }
  if (found->type != SUTURE_NUMBER)
    throw InputError(instance.title() + ": parameter '" + name +
                     "' is not a number, which fields and derivatives need");
  return static_cast<std::size_t>(found - all.begin());
}

VariedParameter::VariedParameter(Attributes& attributes, Instance& instance,
                                 const CellComplex& complex, const std::string& name)
    : attributes_(attributes),
      instance_(instance),
      complex_(complex),
      number_(number_of(instance, name)),
      parameters_(instance.parameters().begin(), instance.parameters().end()) {
  column_ = instance.parameter_column(number_);
  if (column_ == nullptr)
    values_ = {parameters_[number_]};
  else
    for (Index row = 0; row < column_->size(); ++row) values_.push_back(column_->get(row, 0));
}

/// Copies are changed; the columns themselves return.
void VariedParameter::keep_columns() {
  for_each_column(attributes_, instance_, [&](Column& column) {
    kept_.push_back(std::move(column));
    column = Column(kept_.back());
  });
}

VariedParameter::~VariedParameter() {
  if (kept_.empty()) return;
  Diagnostics known;
  instance_.set_parameters(parameters_, known);
  auto kept = kept_.begin();
  for_each_column(attributes_, instance_, [&](Column& column) { column = std::move(*kept++); });
}

void VariedParameter::set(std::span<const double> values) {
  if (kept_.empty()) keep_columns();
  Diagnostics later;  // a model that is varied has said what it had to say
  const bool are_equal = std::ranges::all_of(values, [&](double v) { return v == values[0]; });
  std::vector<double> parameters = parameters_;
  parameters[number_] = are_equal ? values[0] : std::numeric_limits<double>::quiet_NaN();
  instance_.set_parameters(std::move(parameters), later);
  if (!are_equal)
    for (Index row = 0; row < column_->size(); ++row) column_->set(row, 0, values[row]);
  attributes_.sum_again(instance_, complex_);
}

}  // namespace suture
