// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/load_steps.hpp"

#include <algorithm>
#include <sstream>

#include "kernel/dynamics/distortion.hpp"
#include "kernel/dynamics/inversion.hpp"

namespace suture {
namespace {

// With so few iterations, the second of two good load steps may be followed by a larger one.
constexpr unsigned few_iterations = 8;

double percent(double part) { return 100 * part; }

}  // namespace

void LoadSteps::solve(const StepEquations& equations) {
  Body& body = motion_.body();
  const double* x = body.attributes().position().rows();
  position_.assign(x, x + std::size_t{body.attributes().vertex_count()} * 4);
  inverted_ = find_inverted(body.complex(), body.attributes());
  end_ = equations;
  if (!try_equations(end_)) walk();
}

/// The path in parts; the first equations that failed were those at its end.
void LoadSteps::walk() {
  report(1, 0, 0.5);
  hold_back();
  double found = 0, step = 0.5;
  bool was_found = false;
  while (found < 1) {
    const double part = std::min(found + step, 1.0);
    if (try_equations(equations_at(part))) {
      found = part;
      if (was_found && newton_.iterations() <= few_iterations) step *= 2;
      was_found = true;
      report(part, found, step);
    } else {
      step /= 2;
      was_found = false;
      report(part, found, step);
      if (step < least_step) refuse(found);
    }
  }
}

/// Moves the vertices to a solution, or back to the last one.
bool LoadSteps::try_equations(const StepEquations& equations) {
  Body& body = motion_.body();
  double* x = body.attributes().position().rows();
  try {
    newton_.solve(equations);
    refuse_inversion();
    std::copy_n(x, position_.size(), position_.begin());
    return true;
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError& error) {
    failure_ = {error.what(), error.element};
    std::ranges::copy(position_, x);
    return false;
  }
}

/// Laws that are finite beyond it have equilibria there, which no path leads to.
void LoadSteps::refuse_inversion() const {
  Body& body = motion_.body();
  const Index element = first_forbidden(body, find_inverted(body, inverted_), forbids_inversion_);
  if (element == none) return;
  const Index number = body.user_element(element);
  throw NumericalError("the solution turns element " + std::to_string(number) + " inside out",
                       number);
}

StepEquations LoadSteps::equations_at(double part) const {
  StepEquations equations = end_;
  const double start = motion_.time();
  equations.motion_time = part == 1 ? end_.time : start + part * (end_.time - start);
  if (motion_.last_step() == 0)
    equations.load = part;
  else
    equations.time = equations.motion_time;
  equations.held_back = unbalanced_;
  for (double& force : equations.held_back) force *= 1 - part;
  return equations;
}

void LoadSteps::hold_back() {
  unbalanced_.clear();
  unbalanced_ = newton_.residual(equations_at(0));
}

void LoadSteps::report(double part, double found, double step) const {
  if (!newton_.on_note) return;
  std::ostringstream text;
  if (part == found)
    text << "equilibrium at " << percent(part) << " % of the change in this step";
  else
    text << "no equilibrium at " << percent(part) << " % of the change in this step ("
         << failure_.reason << "); continuing from " << percent(found) << " % with "
         << percent(step) << " %";
  newton_.on_note(text.str());
}

void LoadSteps::refuse(double found) {
  std::ostringstream text;
  text << "no equilibrium was found: load steps from t = " << motion_.time() << " s to "
       << end_.time << " s end at " << percent(found) << " % of the change of loads and motions, "
       << "where " << describe(measure_distortion(motion_.body()), motion_.body())
       << "; beyond that, " << failure_.reason;
  throw NumericalError(text.str(), failure_.element);
}

}  // namespace suture
