// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace suture::python {
namespace {

py::object by_element(const Instance& instance, const std::string& name) {
  const auto columns = instance.parameter_columns();
  const auto found = std::ranges::find_if(
      columns, [&](const Column* column) { return column->spec().name == name; });
  if (found == columns.end()) return py::none();
  const Column& column = **found;
  const int components = column.spec().components;
  py::array_t<double> values({py::ssize_t{column.size()}, py::ssize_t{components}});
  for (Index row = 0; row < column.size(); ++row)
    for (int c = 0; c < components; ++c) values.mutable_at(row, c) = column.get(row, c);
  return components == 1 ? values.attr("ravel")() : values;
}

py::object value_of(const Instance& instance, const suture_parameter& parameter, double value) {
  if (std::isnan(value)) return by_element(instance, parameter.name);
  switch (parameter.type) {
    case SUTURE_INTEGER:
      return py::int_(static_cast<std::int64_t>(value));
    case SUTURE_BOOLEAN:
      return py::bool_(value != 0);
    case SUTURE_CHOICE:
      return py::str(parameter.choices[static_cast<std::size_t>(value)]);
    default:
      return py::float_(value);
  }
}

}  // namespace

py::dict parameters(const Instance& instance) {
  py::dict values;
  const std::span all(instance.model().parameters, instance.model().parameter_count);
  for (std::size_t i = 0; i < all.size(); ++i)
    values[py::str(all[i].name)] = value_of(instance, all[i], instance.parameters()[i]);
  return values;
}

}  // namespace suture::python
