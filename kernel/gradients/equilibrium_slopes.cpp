// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/equilibrium_slopes.hpp"

#include <algorithm>
#include <sstream>

#include "kernel/attributes/held.hpp"
#include "kernel/base/error.hpp"
#include "kernel/gradients/rest_slopes.hpp"
#include "kernel/gradients/total_forces.hpp"
#include "kernel/implicit/newton.hpp"
#include "kernel/spectrum/scaled_tangent.hpp"

namespace suture {
namespace {

[[noreturn]] void refuse(const std::string& reason) {
  throw InputError("there is no derivative of this state: " + reason);
}

/// The equations of equilibrium at a time.
StepEquations equations_at(Body& body, double time) {
  const double* x = body.attributes().position().rows();
  const std::size_t size = std::size_t{body.attributes().vertex_count()} * 4;
  StepEquations equations;
  equations.time = time;
  equations.position.assign(x, x + size);
  equations.velocity.assign(size, 0);
  return equations;
}

/// Whether a term has neither forces nor a tangent in this state.
bool takes_no_part(Body& body, ForceTerm& term, double time) {
  const std::size_t vertices = body.attributes().vertex_count();
  AlignedVector<double> rows(vertices * 4);
  term.add_forces(time, body.attributes().kernel(0).cells.live(), rows.data());
  std::vector<double> direction, out(vertices * 3);
  Random random;
  for (std::size_t i = 0; i < out.size(); ++i) direction.push_back(random());
  if (auto* stiff = dynamic_cast<TangentTerm*>(&term))
    stiff->add_tangent(direction.data(), 1, 0, time, out.data());
  const auto is_zero = [](double value) { return value == 0; };
  return std::ranges::all_of(rows, is_zero) && std::ranges::all_of(out, is_zero);
}

void require_terms(Body& body, double time) {
  for (const auto& term : body.terms())
    if (dynamic_cast<ConstraintTerm*>(term.get()) && !takes_no_part(body, *term, time))
      refuse(
          "the body is in contact, and its tangent does not hold what touches; differentiate "
          "a state without contact");
  if (body.models().keeps_states())
    refuse("a model has a memory, on which its forces depend; choose models without one");
  if (!body.is_conservative(time))
    refuse(
        "its tangent is not symmetric, as under a pressure up to a free edge or with a model "
        "without an energy, and the transpose is not available");
}

}  // namespace

EquilibriumSlopes::EquilibriumSlopes(Dynamics& dynamics)
    : dynamics_(dynamics), body_(dynamics.body()), time_(dynamics.time()) {
  if (!dynamics.is_static())
    refuse("it is a state of motion, and derivatives are those of equilibria; set /solver/static");
  require_terms(body_, time_);
  Newton& newton = *dynamics.newton();
  if (newton.holds_free_pieces())
    refuse(
        "a piece floats free, and inertia relief holds it; constrain it, or remove it "
        "(remove_islands)");
  const Newton::Balance balance = newton.balance(equations_at(body_, time_));
  if (balance.is_solved) return;
  std::ostringstream text;
  text << "it is no equilibrium, as forces of " << balance.residual / balance.scale
       << " of all are not in balance; make a step, or find the equilibrium again "
          "(equilibrate())";
  refuse(text.str());
}

/// visit(place) for each component that is held, among 3 numbers per vertex.
template <class Visit>
void EquilibriumSlopes::for_each_held(Visit visit) const {
  Attributes& attributes = body_.attributes();
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (std::size_t c = 0; c < 3; ++c)
      if (attributes.mass().get(v, 0) > 0 && is_held(held_components(attributes, v), c))
        visit(std::size_t{v} * 3 + c);
}

std::vector<double> EquilibriumSlopes::solve(const std::vector<double>& right, double tolerance,
                                             unsigned& iterations) const {
  std::vector<double> x(right.size());
  const LinearSolve solve =
      dynamics_.newton()->solve_tangent(equations_at(body_, time_), right, x, tolerance);
  if (solve.outcome == LinearSolve::Outcome::indefinite)
    refuse("its tangent is indefinite, so the equilibrium is unstable or a limit point");
  if (solve.outcome == LinearSolve::Outcome::too_many) {
    std::ostringstream text;
    text << "the linear solve ended at a residual of " << solve.residual << ", above " << tolerance
         << ": the equilibrium is close to a limit point, or the tolerance too small";
    refuse(text.str());
  }
  iterations = solve.iterations;
  return x;
}

Adjoint EquilibriumSlopes::adjoint(const ObjectiveSlopes& objective, double tolerance) const {
  Adjoint adjoint;
  adjoint.multipliers.energy = objective.energy;
  std::vector<double> held(objective.displacement.size());
  std::vector<double> right = objective.displacement;
  if (!objective.reaction.empty()) {
    for_each_held([&](std::size_t i) { held[i] = -objective.reaction[i]; });
    const std::vector<double> more = transposed_tangent(body_, time_, held);
    for (std::size_t i = 0; i < right.size(); ++i) right[i] += more[i];
  }
  if (objective.energy != 0) {
    const std::vector<double> elastic = elastic_forces(body_, time_);
    for (std::size_t i = 0; i < right.size(); ++i) right[i] -= objective.energy * elastic[i];
  }
  std::vector<double>& force = adjoint.multipliers.force;
  force = solve(right, tolerance, adjoint.iterations);
  // right contains (df/dx)^T m already.
  const std::vector<double> reached = transposed_tangent(body_, time_, force);
  adjoint.motion.assign(right.size(), 0);
  for_each_held([&](std::size_t i) {
    adjoint.motion[i] = right[i] + reached[i];
    force[i] = held[i];
  });
  return adjoint;
}

double EquilibriumSlopes::along_rest(const ObjectiveSlopes& objective, const Adjoint& adjoint,
                                     std::span<const double> direction) const {
  if (!body_.constraints().follow_rest(time_))
    throw InputError(
        "there is no derivative by rest positions: a constraint turns what it holds, or holds it "
        "where it was grasped");
  const RestSlope slope = rest_slope(body_, time_, direction);
  // u = x - X, and where a vertex is held, x = X + translation
  return dot(adjoint.multipliers.force, slope.forces) + objective.energy * slope.energy +
         dot(adjoint.motion, direction) - dot(objective.displacement, direction);
}

std::vector<double> EquilibriumSlopes::displacement(const std::vector<double>& forces,
                                                    double tolerance) const {
  unsigned iterations = 0;
  return solve(forces, tolerance, iterations);
}

std::vector<double> EquilibriumSlopes::reaction(const std::vector<double>& forces,
                                                const std::vector<double>& displacement) const {
  const std::vector<double> moved = tangent(body_, time_, displacement);
  std::vector<double> reaction(forces.size());
  for_each_held([&](std::size_t i) { reaction[i] = -forces[i] - moved[i]; });
  return reaction;
}

}  // namespace suture
