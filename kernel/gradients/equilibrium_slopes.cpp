// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/equilibrium_slopes.hpp"

#include <algorithm>
#include <sstream>

#include "kernel/attributes/held.hpp"
#include "kernel/base/error.hpp"
#include "kernel/gradients/rest_slopes.hpp"
#include "kernel/gradients/total_forces.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture {
namespace {

constexpr unsigned max_updates = 50;  // of the multipliers of contact

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

void require_terms(Body& body, double time) {
  for_each_with<ConstraintTerm>(body.terms(), [&](ConstraintTerm& term) {
    if (!term.hold(time))
      refuse(
          "contact with friction, or between pieces, has no derivative; take the friction out, "
          "or keep the pieces apart");
  });
  if (body.models().keeps_states())
    refuse(
        "a model has a memory, on which its forces depend; call keep_steps() before the run, whose "
        "derivatives contain it");
  if (!body.is_conservative(time))
    refuse(
        "its tangent is not symmetric, as under a pressure up to a free edge or with a model "
        "without an energy, and the transpose is not available");
}

}  // namespace

EquilibriumSlopes::EquilibriumSlopes(Dynamics& dynamics)
    : dynamics_(dynamics), body_(dynamics.body()), time_(dynamics.time()) {
  if (!dynamics.is_static())
    refuse(
        "it is a state of motion; set /solver/static for derivatives of equilibria, or take the "
        "adjoint() of a run since keep_steps()");
  if (const std::string fields = why_fields_have_none(body_); !fields.empty()) refuse(fields);
  require_terms(body_, time_);
  Newton& newton = *dynamics.newton();
  if (newton.holds_free_pieces())
    refuse(
        "a piece floats free, and inertia relief holds it; constrain it, or remove it "
        "(remove_islands)");
  const Newton::Balance balance = newton.balance(equations_at(body_, time_));
  if (balance.is_solved) return;
  std::ostringstream text;
  text << "it is not an equilibrium, as forces of " << balance.residual / balance.scale
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

/// x += the solution of A x = right; returns the iterations.
unsigned EquilibriumSlopes::add_solution(const std::vector<double>& right, double tolerance,
                                         std::vector<double>& x) const {
  std::vector<double> more(right.size());
  const LinearSolve solve =
      dynamics_.newton()->solve_tangent(equations_at(body_, time_), right, more, tolerance);
  if (solve.outcome == LinearSolve::Outcome::indefinite)
    refuse("its tangent is indefinite, so the equilibrium is unstable or a limit point");
  if (solve.outcome == LinearSolve::Outcome::too_many) {
    std::ostringstream text;
    text << "the linear solve ended at a residual of " << solve.residual << ", above " << tolerance
         << ": the equilibrium is close to a limit point, or the tolerance too small";
    refuse(text.str());
  }
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += more[i];
  return solve.iterations;
}

// A contains the stiffness of gaps, N k N^T, in place of their multipliers y. As the multipliers of
// contact do, y converges by y += k N^T (x + fixed), with the equations solved again each time.
EquilibriumSlopes::Solution EquilibriumSlopes::solve(const std::vector<double>& right,
                                                     const std::vector<double>& fixed,
                                                     double tolerance) const {
  Solution found{std::vector<double>(right.size()), std::vector<double>(right.size()), 0};
  found.iterations = add_solution(right, tolerance, found.x);
  double scale = norm(right);
  for (unsigned updates = 0; updates < max_updates; ++updates) {
    std::vector<double> whole = found.x, gaps(right.size());
    for (std::size_t i = 0; i < whole.size(); ++i) whole[i] += fixed[i];
    for_each_with<ConstraintTerm>(body_.terms(), [&](ConstraintTerm& term) {
      term.add_gap_tangent(whole.data(), time_, gaps.data());
    });
    const double left = norm(gaps);
    scale = std::max(scale, left);
    if (left <= tolerance * scale) return found;
    for (std::size_t i = 0; i < gaps.size(); ++i) found.held[i] -= gaps[i];
    found.iterations += add_solution(gaps, std::max(tolerance, tolerance * scale / left), found.x);
  }
  refuse("the multipliers of contact do not converge");
}

Adjoint EquilibriumSlopes::adjoint(const ObjectiveSlopes& objective, double tolerance) const {
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
  Solution found = solve(right, held, tolerance);
  // right contains (df/dx)^T m already.
  const std::vector<double> reached = transposed_tangent(body_, time_, found.x);
  Adjoint adjoint{
      {std::move(found.x), objective.energy}, std::vector<double>(right.size()), found.iterations};
  for_each_held([&](std::size_t i) {
    adjoint.motion[i] = right[i] + reached[i] - found.held[i];
    adjoint.multipliers.force[i] = held[i];
  });
  return adjoint;
}

Sensitivity EquilibriumSlopes::sensitivity(const std::vector<double>& forces,
                                           double tolerance) const {
  Solution found = solve(forces, std::vector<double>(forces.size()), tolerance);
  const std::vector<double> moved = tangent(body_, time_, found.x);
  Sensitivity sensitivity{std::move(found.x), std::vector<double>(forces.size())};
  for_each_held(
      [&](std::size_t i) { sensitivity.reaction[i] = -forces[i] - moved[i] + found.held[i]; });
  return sensitivity;
}

void EquilibriumSlopes::require_rest() const {
  if (!body_.constraints().follow_rest(time_))
    throw InputError(
        "there is no derivative by rest positions: a constraint turns what it holds, or holds it "
        "where it was grasped");
}

double EquilibriumSlopes::along_rest(const ObjectiveSlopes& objective, const Adjoint& adjoint,
                                     std::span<const double> direction) const {
  require_rest();
  const RestSlope slope = rest_slope(body_, time_, direction);
  // u = x - X, and where a vertex is held, x = X + translation
  return dot(adjoint.multipliers.force, slope.forces) + objective.energy * slope.energy +
         dot(adjoint.motion, direction) - dot(objective.displacement, direction);
}

std::vector<double> EquilibriumSlopes::by_rest(const ObjectiveSlopes& objective,
                                               const Adjoint& adjoint) const {
  require_rest();
  if (objective.energy != 0)
    throw InputError(
        "there is no derivative of the energy by the rest position of each vertex; take it along "
        "a direction (along_rest)");
  std::vector<double> slopes = rest_slopes(body_, time_, adjoint.multipliers.force);
  for (std::size_t i = 0; i < slopes.size(); ++i)
    slopes[i] += adjoint.motion[i] - objective.displacement[i];
  return slopes;
}

}  // namespace suture
