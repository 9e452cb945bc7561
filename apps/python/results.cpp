// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/results.hpp"

#include <algorithm>

namespace suture::python {
namespace {

template <class Number>
py::array array_of(const Number* values, std::size_t rows, int components) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
  if (components > 1) shape.push_back(components);
  return py::array_t<Number>(shape, values);
}

}  // namespace

py::list fields(Simulation& simulation) {
  py::list list;
  for (const FieldChoice& field : all_fields(simulation.built()))
    if (is_in_frames(field))
      list.append(py::make_tuple(field.name,
                                 field.on == FieldChoice::On::points ? "vertices" : "elements",
                                 field.components, field.unit));
  return list;
}

py::array field(Simulation& simulation, const std::string& name) {
  BuiltScene& built = simulation.built();
  const std::vector<FieldChoice> all = all_fields(built);
  const FieldChoice& choice = field_named(all, name, "field()");
  built.dynamics().synchronise(choice.needs_force);
  const double time = simulation.time();
  FrameField values;
  choice.fill({built, built.body().acceleration(time), time}, values);
  if (!values.ids.empty()) return array_of(values.ids.data(), values.ids.size(), 1);
  const auto width = static_cast<std::size_t>(values.components);
  return array_of(values.values.data(), values.values.size() / width, values.components);
}

py::dict probes(Simulation& simulation, ProbeTable& table) {
  BuiltScene& built = simulation.built();
  built.dynamics().synchronise(table.needs(&FieldChoice::needs_force));
  const double time = simulation.time();
  const std::vector<double>& row = table.row(time, built.body().acceleration(time));
  const double* values = row.data() + 1;  // behind the time
  py::dict result;
  for (const ProbeTable::Quantity& quantity : table.quantities()) {
    const py::str probe(quantity.probe);
    if (!result.contains(probe)) result[probe] = py::dict();
    const py::object value = quantity.components == 1
                                 ? py::object(py::float_(*values))
                                 : array_of(values, 1, quantity.components).attr("ravel")();
    result[probe][py::str(quantity.field)] = value;
    values += quantity.components;
  }
  return result;
}

}  // namespace suture::python
