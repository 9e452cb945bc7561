// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/step_slopes.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "kernel/attributes/held.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/forces/nonsmooth_term.hpp"
#include "kernel/gradients/state_slopes.hpp"
#include "kernel/gradients/total_forces.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture {

void refuse_run(const std::string& reason) {
  throw InputError("there is no derivative of this run: " + reason);
}

namespace {

// By which the end of an explicit step may miss that of the run, as a part of its motion and of the
// coordinates: what rounding makes of another order of the sums.
constexpr double same_motion = 1e-9, same_place = 1e-14;

constexpr double asymmetry = 1e-9;  // that rounding makes

[[noreturn]] void refuse_asymmetry() {
  refuse_run(
      "its tangent is not symmetric, as with a model or a force function without an energy, and "
      "the transpose is not available");
}

void require_smooth(Dynamics& dynamics) {
  Body& body = dynamics.body();
  if (const std::string fields = why_fields_have_none(body); !fields.empty()) refuse_run(fields);
  if (!dynamics.is_solved())
    refuse_run(
        "its steps do not solve the equations of motion; remove /solver/budget, or use "
        "another integrator than \"xpbd\"");
  bool touches = body.contact() != nullptr;
  for_each_with<NonsmoothTerm>(body.terms(), [&](NonsmoothTerm&) { touches = true; });
  if (touches)
    refuse_run("contact has a derivative at equilibria only (/solver/static); take it out");
  const std::string without = body.models().without_tangent();
  if (!without.empty())
    refuse_run(without + " has no derivatives by positions (suture.tangent/1), which it needs");
  if (dynamics.newton() != nullptr && dynamics.newton()->holds_free_pieces())
    refuse_run("a piece floats free, and inertia relief holds it; constrain it, or remove it");
}

/// a += factor b
void add(std::vector<double>& a, const std::vector<double>& b, double factor = 1) {
  for (std::size_t i = 0; i < b.size(); ++i) a[i] += factor * b[i];
}

/// The place of a component in rows of 4 numbers per vertex, from that among 3.
std::size_t row_of(std::size_t i) { return i / 3 * 4 + i % 3; }

}  // namespace

std::vector<double> rows_of(const Column& column) {
  return {column.rows(), column.rows() + std::size_t{column.size()} * 4};
}

StepSlopes::StepSlopes(Dynamics& dynamics)
    : dynamics_(dynamics),
      body_(dynamics.body()),
      states_(body_.attributes()),
      solver_(dynamics.motion()) {
  require_smooth(dynamics);
  Attributes& attributes = body_.attributes();
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (std::size_t c = 0; c < 3; ++c) {
      mass_.push_back(attributes.mass().get(v, 0));
      is_free_.push_back(!is_held(held_components(attributes, v), c));
    }
}

void StepSlopes::backward(const StepEnds& step, const ObjectiveSlopes& objective, double tolerance,
                          StateSlope& slope, const Use& use) {
  if (!states_.empty() && objective.energy != 0)
    refuse_run("the energy of a model with a memory has none; choose another objective");
  const StepEquations* const equations = dynamics_.equations(step.dt);
  if (equations != nullptr)
    back_implicitly(*equations, step, objective, tolerance, slope, use);
  else
    back_explicitly(step, objective, slope, use);
}

/// Adds the slopes by displacements and the energy at the end of the step, where the body is.
void StepSlopes::add_objective(const ObjectiveSlopes& objective, double time, StateSlope& slope) {
  add(slope.position, objective.displacement);
  if (objective.energy != 0) add(slope.position, elastic_forces(body_, time), -objective.energy);
}

/// Adds the slopes by the states at the start of the step.
void StepSlopes::add_states(const TangentTime& at, const Multipliers& multipliers,
                            std::vector<double>& states) const {
  if (!states_.empty()) add(states, slopes_by_states(body_, states_, at, multipliers));
}

// --------------------------------------------------------- implicit schemes --

void StepSlopes::back_implicitly(const StepEquations& equations, const StepEnds& step,
                                 const ObjectiveSlopes& objective, double tolerance,
                                 StateSlope& slope, const Use& use) {
  Attributes& attributes = body_.attributes();
  const std::vector<double> position = rows_of(attributes.position()),
                            velocity = rows_of(attributes.velocity());
  const TangentTime at(equations.time, equations.dt);
  std::ranges::copy(step.position, attributes.position().rows());
  require_solved(equations);  // and sets v'
  require_transpose(at);

  add_objective(objective, at.time, slope);
  Multipliers multipliers{std::vector<double>(mass_.size()), objective.energy,
                          std::move(slope.states)};
  const std::vector<double> found =
      find_multipliers(equations, objective, tolerance, slope, multipliers);
  use(true, moment_at_end(equations, step), multipliers);
  slope.states.assign(states_.size(), 0);
  add_states(at, multipliers, slope.states);
  go_to_start(equations, damping_tangent(body_, at, found), found, slope);
  if (equations.start_position == 0 || !step.is_first) return;
  std::ranges::copy(position, attributes.position().rows());
  std::ranges::copy(velocity, attributes.velocity().rows());
  back_through_start(equations, step, slope, use);
}

/// l of the free components, which joins the multipliers; these have the states already, and get
/// those of reactions.
std::vector<double> StepSlopes::find_multipliers(const StepEquations& equations,
                                                 const ObjectiveSlopes& objective, double tolerance,
                                                 const StateSlope& slope,
                                                 Multipliers& multipliers) {
  const TangentTime at(equations.time, equations.dt);
  std::vector<double> right = slope.position;
  add(right, slope.velocity, equations.rate);
  add(right, slope.acceleration, equations.acceleration);
  for (std::size_t i = 0; i < objective.reaction.size(); ++i)
    if (!is_free_[i]) multipliers.force[i] = -objective.reaction[i];
  if (!objective.reaction.empty()) add(right, transposed_tangent(body_, at, multipliers.force));
  if (!states_.empty()) add(right, slopes_by_position(body_, states_, at, multipliers.states));
  std::vector<double> found = solve(equations, right, tolerance, true);
  add(multipliers.force, found);
  motion_ = transposed_tangent(body_, at, found);
  for (std::size_t i = 0; i < motion_.size(); ++i)
    motion_[i] = is_free_[i] ? 0 : motion_[i] + right[i];
  return found;
}

/// Where the body is, a' + alpha v'.
Moment StepSlopes::moment_at_end(const StepEquations& equations, const StepEnds& step) const {
  Moment moment{{equations.time, equations.dt}, std::vector<double>(mass_.size())};
  const double* const velocity = body_.attributes().velocity().rows();
  for (std::size_t i = 0; i < mass_.size(); ++i) {
    const std::size_t row = row_of(i);
    if (is_free_[i])
      moment.inertia[i] = equations.acceleration * (step.position[row] - equations.position[row]) +
                          dynamics_.motion().damping() * velocity[row];
  }
  return moment;
}

/// By X* and V*, from l (`found`) and -C l (`damped`).
void StepSlopes::go_to_start(const StepEquations& equations, const std::vector<double>& damped,
                             const std::vector<double>& found, StateSlope& slope) const {
  const double alpha = dynamics_.motion().damping(), rate = equations.rate;
  slope.acceleration.resize(mass_.size());
  for (std::size_t i = 0; i < mass_.size(); ++i) {
    const double l = mass_[i] * found[i], v = slope.velocity[i], a = slope.acceleration[i];
    double by_place = 0, by_speed = 0;
    if (is_free_[i]) {
      by_place = (equations.acceleration + alpha * rate) * l - rate * (damped[i] + v) -
                 equations.acceleration * a;
      by_speed = v - alpha * l + damped[i];
    }
    slope.position[i] = by_place;
    slope.velocity[i] = equations.dt * by_place + by_speed;
    slope.acceleration[i] =
        equations.start_position * by_place + equations.start_velocity * by_speed;
  }
}

/// From the acceleration at the start of the run, at which the body is.
void StepSlopes::back_through_start(const StepEquations& equations, const StepEnds& step,
                                    StateSlope& slope, const Use& use) {
  if (!states_.empty() && step.start > 0)
    refuse_run(
        "its first acceleration has none with a memory, whose forces have a kink there; keep the "
        "steps from t = 0 on, or choose implicit Euler");
  const TangentTime at(step.start);
  const double alpha = dynamics_.motion().damping();
  Moment moment{at, std::vector<double>(mass_.size())};
  Multipliers multipliers{std::move(slope.acceleration), 0, std::vector<double>(states_.size())};
  const double* const v = body_.attributes().velocity().rows();
  for (std::size_t i = 0; i < mass_.size(); ++i) {
    if (!is_free_[i]) continue;
    // v* = v + d a
    const double a = (equations.velocity[row_of(i)] - v[row_of(i)]) / equations.start_velocity;
    moment.inertia[i] = a + alpha * v[row_of(i)];
    slope.velocity[i] -= alpha * multipliers.force[i];
    multipliers.force[i] /= mass_[i];
  }
  add(slope.position, transposed_tangent(body_, at, multipliers.force));
  add(slope.velocity, damping_tangent(body_, at, multipliers.force));
  add_states(at, multipliers, slope.states);
  use(false, moment, multipliers);
}

StepSlopes::External StepSlopes::external(const ParameterDirection& parameter,
                                          const StepEnds& step) const {
  External change{std::vector<double>(mass_.size()), std::vector<double>(mass_.size())};
  if (parameter.instance != nullptr) return change;
  if (body_.models().reads_velocity())
    refuse_run("the forces of a model depend on velocities, which a prescribed motion changes");
  for (const auto& [body, sign] : {std::pair(parameter.up, 1.0), std::pair(parameter.down, -1.0)}) {
    Attributes& attributes = body->attributes();
    if (std::size_t{attributes.vertex_count()} * 3 != mass_.size())
      refuse_run("cells changed before " + time_text(step.end));
    double* const x = attributes.position().rows();
    std::ranges::copy(step.position, x);
    add(change.forces, load_forces(*body, step.end), sign / (2 * parameter.step));
    body->constraints().apply(attributes, step.end);
    for (std::size_t i = 0; i < mass_.size(); ++i)
      if (!is_free_[i]) change.motion[i] += sign * x[row_of(i)] / (2 * parameter.step);
  }
  return change;
}

/// The derivative of values that depend on a parameter and on the part of it that has changed.
std::vector<double> StepSlopes::slope_of(const ParameterDirection& parameter, const Moment& moment,
                                         const ValuesAt& values_at) {
  if (parameter.instance != nullptr)
    return ParameterSlopes(body_, moment, *parameter.instance, parameter.name)
        .of(parameter.weights, values_at);
  std::vector<double> slope = values_at(parameter.step);
  add(slope, values_at(-parameter.step), -1);
  for (double& value : slope) value /= 2 * parameter.step;
  return slope;
}

// dr = d(f + m (g - a' - alpha v')) at fixed x', with dv' = dv* - r dx* there
void StepSlopes::forward(const StepEnds& step, const ParameterDirection& parameter,
                         double tolerance, StateSensitivity& slope) {
  const StepEquations* const equations = dynamics_.equations(step.dt);
  if (equations == nullptr || equations->start_position != 0)
    refuse_run(
        "there are sensitivities of equilibria and of runs of implicit Euler; take an adjoint");
  const TangentTime at(equations->time, equations->dt);
  const double alpha = dynamics_.motion().damping(), rate = equations->rate;
  const std::vector<double> states = states_.accepted();
  std::ranges::copy(step.position, body_.attributes().position().rows());
  require_solved(*equations);
  require_transpose(at);
  StateSlope& now = slope.state;
  if (rate != 0) add(now.position, now.velocity, step.dt);  // dx*
  const Moment moment = moment_at_end(*equations, step);
  const External change = external(parameter, step);
  std::vector<double> right = slope_of(parameter, moment, [&](double part) {
    move_states(states, now.states, part);
    return balanced_forces(body_, moment);
  });
  states_.set_accepted(states);
  add(right, change.forces);
  add(right, tangent(body_, at, change.motion));
  std::vector<double> speed = now.velocity;
  add(speed, now.position, -rate);
  for (std::size_t i = 0; i < mass_.size(); ++i)
    right[i] += mass_[i] * (equations->acceleration * now.position[i] - alpha * speed[i]);
  add(right, damping_tangent(body_, at, speed));
  std::vector<double> moved = solve(*equations, right, tolerance, false);
  add(moved, change.motion);
  add(speed, moved, rate);
  now = {std::move(moved), std::move(speed), std::move(now.states)};
  finish(parameter, moment, states, slope);
  add(slope.reaction, change.forces, -1);
  for (std::size_t i = 0; i < mass_.size(); ++i)
    if (is_free_[i]) slope.reaction[i] = 0;
}

/// The states and the reactions at the end, where positions and velocities are known.
void StepSlopes::finish(const ParameterDirection& parameter, const Moment& moment,
                        const std::vector<double>& states, StateSensitivity& slope) {
  Attributes& attributes = body_.attributes();
  const std::vector<double> position = rows_of(attributes.position()),
                            velocity = rows_of(attributes.velocity());
  const StateSlope& now = slope.state;
  std::vector<double> ends = slope_of(parameter, moment, [&](double part) {
    move_states(states, now.states, part);
    for (std::size_t i = 0; i < mass_.size(); ++i) {
      const std::size_t row = row_of(i);
      attributes.position().rows()[row] = position[row] + part * now.position[i];
      attributes.velocity().rows()[row] = velocity[row] + part * now.velocity[i];
    }
    std::vector<double> values = total_forces(body_, moment.at);  // and sets trial states
    const std::vector<double> trial = states_.trial();
    values.insert(values.end(), trial.begin(), trial.end());
    return values;
  });
  const auto forces = ends.begin() + static_cast<std::ptrdiff_t>(mass_.size());
  slope.state.states.assign(forces, ends.end());
  slope.reaction.assign(mass_.size(), 0);
  add(slope.reaction, {ends.begin(), forces}, -1);
}

/// The accepted states, and a part of a direction.
void StepSlopes::move_states(const std::vector<double>& states, const std::vector<double>& way,
                             double part) const {
  std::vector<double> moved = states;
  add(moved, way, part);
  states_.set_accepted(moved);
}

void StepSlopes::require_solved(const StepEquations& equations) {
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
  if (!body_.has_transpose(equations.time)) refuse_asymmetry();
}

/// Whether what is used as the transpose of tangents is it, on the free components: by two
/// directions, once.
void StepSlopes::require_transpose(const TangentTime& at) {
  if (is_checked_) return;
  is_checked_ = true;
  std::minstd_rand random(1);
  std::vector<double> a(mass_.size()), b(mass_.size());
  for (std::size_t i = 0; i < mass_.size(); ++i)
    if (is_free_[i]) a[i] = static_cast<double>(random()), b[i] = static_cast<double>(random());
  const auto require = [&](const std::vector<double>& of_a, const std::vector<double>& of_b) {
    if (std::abs(dot(a, of_b) - dot(b, of_a)) > asymmetry * norm(a) * norm(of_b))
      refuse_asymmetry();
  };
  require(transposed_tangent(body_, at, a), tangent(body_, at, b));
  require(damping_tangent(body_, at, a), damping_tangent(body_, at, b));
}

/// The l of a step, from what is on the right.
std::vector<double> StepSlopes::solve(const StepEquations& equations,
                                      const std::vector<double>& right, double tolerance,
                                      bool is_transposed) {
  std::vector<double> found(right.size()), free = right;
  solver_.start(equations.time);
  solver_.set_matrix(equations);
  solver_.set_symmetric(body_.is_conservative(equations.time), is_transposed);
  solver_.matrix().restrict(free);
  if (std::ranges::all_of(free, [](double r) { return r == 0; })) return found;
  const LinearSolve solve = solver_.solve(free, found, tolerance);
  if (solve.outcome == LinearSolve::Outcome::converged) {
    iterations_ += solve.iterations;
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

// --------------------------------------------------------- explicit schemes --

void StepSlopes::back_explicitly(const StepEnds& step, const ObjectiveSlopes& objective,
                                 StateSlope& slope, const Use& use) {
  if (!objective.reaction.empty())
    refuse_run("reactions have none in an explicit run; choose an objective of displacements");
  Attributes& attributes = body_.attributes();
  Motion& motion = dynamics_.motion();
  const ExplicitStep made = dynamics_.explicit_step(step.dt);
  const TangentTime at(step.start, made.forces_dt);
  motion.evaluate(made.forces_dt);
  const Residual now(motion);
  Moment moment{at, std::vector<double>(mass_.size())};
  for (std::size_t i = 0; i < mass_.size(); ++i)
    if (is_free_[i])
      moment.inertia[i] = now.acceleration(static_cast<Index>(i / 3))[i % 3] +
                          motion.damping() * attributes.velocity().rows()[row_of(i)];
  require_reached(step, made, moment.inertia);
  require_transpose(at);

  Multipliers multipliers{std::vector<double>(mass_.size()), objective.energy};
  if (objective.energy != 0) {
    const std::vector<double> position = rows_of(attributes.position());
    std::ranges::copy(step.position, attributes.position().rows());
    add_objective(objective, step.end, slope);
    use(true, {step.end}, multipliers);
    std::ranges::copy(position, attributes.position().rows());
  } else {
    add(slope.position, objective.displacement);
  }
  multipliers.energy = 0;
  multipliers.states = std::move(slope.states);
  motion_.assign(mass_.size(), 0);
  for (std::size_t i = 0; i < mass_.size(); ++i) {
    if (!is_free_[i]) {
      motion_[i] = slope.position[i];
      slope.position[i] = slope.velocity[i] = 0;
      continue;
    }
    const double by_velocity = slope.velocity[i] + step.dt * slope.position[i];
    multipliers.force[i] = made.kick.gain * by_velocity / mass_[i];
    slope.velocity[i] = made.kick.decay * by_velocity;
  }
  add(slope.position, transposed_tangent(body_, at, multipliers.force));
  add(slope.velocity, damping_tangent(body_, at, multipliers.force));
  if (!states_.empty())
    add(slope.position, slopes_by_position(body_, states_, at, multipliers.states));
  slope.states.assign(states_.size(), 0);
  add_states(at, multipliers, slope.states);
  use(false, moment, multipliers);
}

/// `acceleration`: f / m + g, 0 where components are held.
void StepSlopes::require_reached(const StepEnds& step, const ExplicitStep& made,
                                 const std::vector<double>& acceleration) {
  const double* const x = body_.attributes().position().rows();
  const double* const v = body_.attributes().velocity().rows();
  double miss = 0, way = 0, place = 0;
  for (std::size_t i = 0; i < mass_.size(); ++i) {
    if (!is_free_[i]) continue;
    const std::size_t row = row_of(i);
    const double moved = step.dt * (made.kick.decay * v[row] + made.kick.gain * acceleration[i]);
    miss = std::max(miss, std::abs(x[row] + moved - step.position[row]));
    way = std::max(way, std::abs(moved));
    place = std::max(place, std::abs(x[row]));
  }
  if (miss <= same_motion * way + same_place * place) return;
  refuse_run("the state at " + time_text(step.end) +
             " does not follow from the step before; cells, parameters, loads or the motion were "
             "changed in between. Keep the steps after the last change");
}

}  // namespace suture
