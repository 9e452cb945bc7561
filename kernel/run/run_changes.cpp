// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program that runs a simulation changes between two steps, besides its cells and motion:
// models, gravity, and the whole state.
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/forces/gravity.hpp"
#include "kernel/run/run_loop.hpp"

namespace suture {

void RunLoop::change_forces(const std::function<void()>& change) {
  sleeper_.wake_all();
  control_.commit();  // no rollback crosses it
  built_.dynamics().change_forces(change);
  control_.after_jump();
  is_unbalanced_ = true;
}

void RunLoop::set_parameters(Instance& instance, std::vector<double> values) {
  Body& body = built_.body();
  const std::vector<double> before(instance.parameters().begin(), instance.parameters().end());
  Diagnostics later;  // a model refuses before anything else changes
  instance.set_parameters(values, later);
  instance.set_parameters(before, later);
  const auto set = [&](std::vector<double> parameters) {
    body.attributes().set_parameters(instance, std::move(parameters), body.complex(), diagnostics_);
  };
  try {
    change_forces([&] { set(std::move(values)); });
  } catch (const Error&) {
    set(before);
    built_.dynamics().motion().forget_forces();
    throw;
  }
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
  find_equilibrium([&](const std::string& text) { observer.on_message(text); });
}

StateTree RunLoop::save() {
  StateTree tree;
  save_state(tree, *this);
  return tree;
}

void RunLoop::load(const StateTree& state) {
  load_state(state, *this);
  first_step_ = clock_.step();
}

}  // namespace suture
