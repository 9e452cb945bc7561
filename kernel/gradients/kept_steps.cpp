// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/kept_steps.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/forces/nonsmooth_term.hpp"
#include "kernel/gradients/total_forces.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture {
namespace {

[[noreturn]] void refuse_run(const std::string& reason) {
  throw InputError("there is no derivative of this run: " + reason);
}

void require_smooth(Body& body) {
  if (body.models().keeps_states())
    refuse_run("a model has a memory, on which its forces depend; choose models without one");
  if (!body.fields().empty())
    refuse_run("fields such as '" + body.fields().front().field().name +
               "' have no derivatives; choose models without them");
  if (!body.models().depends_on_positions_alone())
    refuse_run("the forces of a model depend on velocities; choose models without damping");
  bool touches = body.contact() != nullptr;
  for_each_with<NonsmoothTerm>(body.terms(), [&](NonsmoothTerm&) { touches = true; });
  if (touches)
    refuse_run("contact has a derivative at equilibria only (/solver/static); take it out");
}

/// The rows of a column with three components.
std::vector<double> three_of(const Column& column) {
  std::vector<double> numbers;
  for (Index row = 0; row < column.size(); ++row)
    for (int c = 0; c < 3; ++c) numbers.push_back(column.get(row, c));
  return numbers;
}

std::vector<double> held_by(Attributes& attributes) {
  std::vector<double> held;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    held.push_back(attributes.fixed().get(v, 0));
  return held;
}

}  // namespace

/// Lends the columns of positions and velocities, which return when it ends.
class KeptSteps::Visit {
 public:
  explicit Visit(Attributes& attributes)
      : position_(attributes.position()), velocity_(attributes.velocity()) {
    before_.assign(position_.rows(), position_.rows() + size());
    moving_.assign(velocity_.rows(), velocity_.rows() + size());
  }
  ~Visit() {
    std::ranges::copy(before_, position_.rows());
    std::ranges::copy(moving_, velocity_.rows());
  }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

 private:
  std::size_t size() const { return std::size_t{position_.size()} * 4; }
  Column &position_, &velocity_;
  std::vector<double> before_, moving_;
};

KeptSteps::KeptSteps(Dynamics& dynamics)
    : dynamics_(dynamics),
      body_(dynamics.body()),
      start_(dynamics.time()),
      position_(three_of(body_.attributes().position())),
      velocity_(three_of(body_.attributes().velocity())),
      held_(held_by(body_.attributes())) {
  require_smooth(body_);
}

void KeptSteps::keep() {
  const double time = dynamics_.time(), last = steps_.empty() ? start_ : steps_.back().time;
  if (time == last || !broken_.empty()) return;
  const double dt = dynamics_.motion().last_step();
  if (time < last)
    broken_ = "a step was rejected, and the run went back to " + time_text(time);
  else if (body_.attributes().vertex_count() * std::size_t{3} != position_.size())
    broken_ = "a cut has changed the vertices before " + time_text(time);
  else if (held_by(body_.attributes()) != held_)
    broken_ = "constraints hold other vertices from " + time_text(time) + " on";
  else if (!steps_.empty() && std::abs(dt - steps_[0].dt) > same_step * dt)
    broken_ = "its steps differ in length before " + time_text(time) +
              ", as where one was rejected or /solver/dt is \"auto\"; choose a smaller /solver/dt, "
              "of which the end is a multiple";
  steps_.push_back({time, dt, three_of(body_.attributes().position())});
}

// --------------------------------------------------------------- one step --

/// Those at the end of a step; 0: at the start.
const std::vector<double>& KeptSteps::position_after(std::size_t step) const {
  return step == 0 ? position_ : steps_[step - 1].position;
}

double KeptSteps::velocity_after(std::size_t step, std::size_t i) const {
  if (step == 0) return velocity_[i];
  return (position_after(step)[i] - position_after(step - 1)[i]) / steps_[step - 1].dt;
}

StepEquations KeptSteps::equations(std::size_t step) const {
  const double h = steps_[step - 1].dt;
  StepEquations equations;
  equations.time = steps_[step - 1].time;
  equations.dt = h;
  equations.rate = 1 / h;
  equations.acceleration = 1 / (h * h);
  equations.position.resize(position_.size() / 3 * 4);
  equations.velocity.resize(equations.position.size());
  for (std::size_t i = 0; i < position_.size(); ++i) {
    const std::size_t row = i / 3 * 4 + i % 3;
    equations.velocity[row] = velocity_after(step - 1, i);
    equations.position[row] = position_after(step - 1)[i] + h * equations.velocity[row];
  }
  return equations;
}

/// a + alpha v', 3 numbers per vertex.
std::vector<double> KeptSteps::inertia(std::size_t step) const {
  std::vector<double> inertia(position_.size());
  for (std::size_t i = 0; i < inertia.size(); ++i) {
    const double now = velocity_after(step, i);
    inertia[i] = (now - velocity_after(step - 1, i)) / steps_[step - 1].dt +
                 dynamics_.motion().damping() * now;
  }
  return inertia;
}

void KeptSteps::go_to(std::size_t step) {
  double* x = body_.attributes().position().rows();
  const std::vector<double>& position = position_after(step);
  for (std::size_t i = 0; i < position.size(); ++i) x[i / 3 * 4 + i % 3] = position[i];
}

void KeptSteps::require_solved(const StepEquations& equations) {
  const Newton::Balance balance = dynamics_.newton()->balance(equations);
  if (!balance.is_solved) {
    std::ostringstream text;
    text << "the state at " << time_text(equations.time)
         << " does not follow from the step before, as forces of "
         << balance.residual / balance.scale
         << " of all are not in balance; cells, parameters, loads or the motion were changed in "
            "between, or after it. Keep the steps after the last change";
    refuse_run(text.str());
  }
  if (!body_.is_conservative(equations.time))
    refuse_run(
        "its tangent is not symmetric, as under a pressure up to a free edge or with a model "
        "without an energy, and the transpose is not available");
}

/// The l of a step, from what is on the right; its equations hold in the current state.
std::vector<double> KeptSteps::solve(const StepEquations& equations,
                                     const std::vector<double>& right, double tolerance,
                                     unsigned& iterations) {
  std::vector<double> found(right.size());
  const LinearSolve solve = dynamics_.newton()->solve_tangent(equations, right, found, tolerance);
  if (solve.outcome == LinearSolve::Outcome::converged) {
    iterations += solve.iterations;
    return found;
  }
  std::ostringstream text;
  text << "at " << time_text(equations.time) << ", ";
  if (solve.outcome == LinearSolve::Outcome::indefinite)
    text << "the tangent of the step is indefinite; choose a smaller /solver/dt";
  else
    text << "the linear solve ended at a residual of " << solve.residual << ", above " << tolerance;
  refuse_run(text.str());
}

// -------------------------------------------------------------- all steps --

void KeptSteps::require_unchanged() const {
  if (steps_.empty()) refuse_run("no step was made since keep_steps()");
  if (!broken_.empty()) refuse_run(broken_);
  if (dynamics_.time() != steps_.back().time ||
      three_of(body_.attributes().position()) != steps_.back().position)
    refuse_run("the state has changed since its last step; keep the steps after the last change");
}

RunAdjoint KeptSteps::adjoint(const SlopesAt& slopes_at, double tolerance) {
  require_unchanged();
  const Visit visit(body_.attributes());
  const Column& mass = body_.attributes().mass();
  RunAdjoint adjoint;
  adjoint.steps.resize(count());
  std::vector<double>&by_position = adjoint.position, &by_velocity = adjoint.velocity;
  by_position.assign(position_.size(), 0);
  by_velocity.assign(position_.size(), 0);
  for (std::size_t step = count(); step > 0; --step) {
    go_to(step);
    const StepEquations equations = this->equations(step);
    require_solved(equations);
    const double h = equations.dt, carried = 1 / (h * h) + dynamics_.motion().damping() / h;
    adjoint.steps[step - 1].energy = add_slopes(slopes_at(step), equations.time, by_position);
    std::vector<double> right = by_position;
    for (std::size_t i = 0; i < right.size(); ++i) right[i] += by_velocity[i] / h;
    std::vector<double> found = solve(equations, right, tolerance, adjoint.iterations);
    for (std::size_t i = 0; i < right.size(); ++i) {
      const double weighed = mass.get(static_cast<Index>(i / 3), 0) * found[i];
      by_position[i] = carried * weighed - by_velocity[i] / h;
      by_velocity[i] = weighed / h;
    }
    adjoint.steps[step - 1].force = std::move(found);
  }
  return adjoint;
}

/// To the derivative by the positions of the current state; returns dJ/dW.
double KeptSteps::add_slopes(const ObjectiveSlopes& slopes, double time,
                             std::vector<double>& by_position) {
  if (slopes.displacement.empty()) return 0;
  for (std::size_t i = 0; i < by_position.size(); ++i) by_position[i] += slopes.displacement[i];
  if (slopes.energy == 0) return 0;
  const std::vector<double> elastic = elastic_forces(body_, time);
  for (std::size_t i = 0; i < by_position.size(); ++i) by_position[i] -= slopes.energy * elastic[i];
  return slopes.energy;
}

/// use(slopes, multipliers) of a parameter in the state after each step.
template <class Use>
void KeptSteps::for_each_step(Instance& instance, const std::string& parameter,
                              std::span<const Multipliers> multipliers, Use use) {
  require_unchanged();
  const Visit visit(body_.attributes());
  for (std::size_t step = 1; step <= count(); ++step) {
    go_to(step);
    ParameterSlopes slopes(body_, steps_[step - 1].time, instance, parameter);
    slopes.set_inertia(inertia(step));
    use(slopes, multipliers[step - 1]);
  }
}

std::vector<double> KeptSteps::each(Instance& instance, const std::string& parameter,
                                    std::span<const Multipliers> multipliers) {
  std::vector<double> sum;
  for_each_step(instance, parameter, multipliers,
                [&](ParameterSlopes& slopes, const Multipliers& of_step) {
                  const std::vector<double> part = slopes.each(of_step);
                  sum.resize(part.size());
                  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
                });
  return sum;
}

double KeptSteps::along(Instance& instance, const std::string& parameter,
                        std::span<const double> weights, std::span<const Multipliers> multipliers) {
  double sum = 0;
  for_each_step(instance, parameter, multipliers,
                [&](ParameterSlopes& slopes, const Multipliers& of_step) {
                  sum += slopes.along(of_step, weights);
                });
  return sum;
}

}  // namespace suture
