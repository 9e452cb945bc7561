// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program that runs a simulation changes between two steps, besides its cells and motion:
// models, gravity, and the whole state.
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/forces/gravity.hpp"
#include "kernel/run/run_loop.hpp"
#include "kernel/run/within_steps.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture {

void RunLoop::change_forces(const std::function<void()>& change) {
  sleeper_.wake_all();
  control_.commit();  // no rollback crosses it
  built_.dynamics().change_forces(change);
  control_.after_jump();
  is_unbalanced_ = true;
}

/// Sets, or undoes what it has done.
void RunLoop::change_parameters(const std::function<void()>& set,
                                const std::function<void()>& undo) {
  try {
    change_forces(set);
  } catch (const Error&) {
    undo();
    built_.dynamics().motion().forget_forces();
    throw;
  }
}

void RunLoop::set_parameters(Instance& instance, std::vector<double> values) {
  Body& body = built_.body();
  const std::vector<double> before(instance.parameters().begin(), instance.parameters().end());
  Diagnostics later;  // a model refuses before anything else changes
  instance.set_parameters(values, later);
  instance.set_parameters(before, later);
  const auto set = [&](const std::vector<double>& parameters) {
    body.attributes().set_parameters(instance, parameters, body.complex(), diagnostics_);
  };
  change_parameters([&] { set(values); }, [&] { set(before); });
}

namespace {

/// Throws InputError, naming the element, for a value outside of the parameter's range.
void require_values(const BuiltScene& built, const Instance& instance,
                    const suture_parameter& parameter, std::span<const double> values) {
  const CellSet& elements = instance.table(3).cells;
  if (values.size() != elements.size())
    throw InputError(instance.title() + " has " + std::to_string(elements.size()) +
                     " rows of elements; parameter '" + parameter.name + "' is given " +
                     std::to_string(values.size()) + " values");
  const Limits limits = scene_parts::limits_of(parameter);
  for (Index row = 0; row < values.size(); ++row) {
    if (limits.admits(values[row])) continue;
    std::ostringstream text;
    text << instance.title() << ": parameter '" << parameter.name << "' " << limits.requirement()
         << ", is " << values[row] << " at element " << built.element_name(elements.cell(row));
    throw InputError(text.str());
  }
}

}  // namespace

void RunLoop::set_field(Instance& instance, std::size_t parameter, std::vector<double> values) {
  Body& body = built_.body();
  require_values(built_, instance, instance.model().parameters[parameter], values);
  const std::vector<double> uniform(instance.parameters().begin(), instance.parameters().end());
  std::vector<double> field;
  const Column& column = *instance.parameter_column(parameter);
  for (Index row = 0; row < column.size(); ++row) field.push_back(column.get(row, 0));
  const auto set = [&](const std::vector<double>& rows) {
    body.attributes().set_field(instance, parameter, rows, body.complex(), diagnostics_);
  };
  change_parameters([&] { set(values); },
                    [&] {
                      set(field);
                      body.attributes().set_parameters(instance, uniform, body.complex(),
                                                       diagnostics_);
                    });
}

void RunLoop::set_gravity(const Vec3& value) {
  for (const double component : value)
    if (!std::isfinite(component)) throw InputError("gravity must be finite; nothing was changed");
  change_forces([&] { built_.gravity().set_value(value); });
}

void RunLoop::equilibrate(Observer& observer) {
  if (!built_.dynamics().is_static() || clock_.step() == 0)
    throw InputError(
        "only a static run that has made a step finds its equilibrium again; set /solver/static "
        "and make a step first");
  const WithinSteps within_steps(control_, built_.dynamics(), observer);
  try {
    find_equilibrium([&](const std::string& text) { observer.on_message(text); });
  } catch (const StepAbandoned&) {
    is_unbalanced_ = true;
  }
}

StateTree RunLoop::save(StateTree* spare) {
  StateTree tree;
  save_state(tree, *this, spare);
  return tree;
}

void RunLoop::load(const StateTree& state) {
  load_state(state, *this);
  first_step_ = clock_.step();
}

}  // namespace suture
