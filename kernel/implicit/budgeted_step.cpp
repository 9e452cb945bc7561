// SPDX-License-Identifier: GPL-3.0-or-later
//
// A step of implicit Euler that is on time instead of solved.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/motion.hpp"
#include "kernel/implicit/newton.hpp"

// One linearised step
// ===================
//
// With the step's equations (h: its length, U: the energy of the body and its loads at its end, x*
// = x + h v), the positions x' at the end minimise
//
//   I(x') + U(x'),   I = |x' - x*|_M^2 / 2 h^2 + alpha |x' - x|_M^2 / 2 h
//
// One step of Newton's method from x (from x* the motion would lag) gives the way d. Its linear
// system is solved as far as the budget allows: conjugate gradients from 0, so that every iterate
// decreases the quadratic model of I + U, and the last one is what there is. Then d is halved until
// I + U itself does not grow:
//
//   x' = x + s d,   v' = s d / h,   s = 1, 1/2, ...;   no step at all if none helps
//
// As I is the kinetic energy K of v at x and not negative at x', then U(x') <= U(x) + K(v). So the
// velocities can be shortened where K(v') + U(x') would be more than K(v) + U(x): where a linear
// step lengthens what turns. What moves prescribed vertices adds its work to either bound. Where
// some forces have no energy, U is minus the work of all by the trapezoidal rule.

namespace suture {
namespace {

// What more iterations would not improve for the eye.
constexpr double linear_tolerance = 1e-3;
constexpr unsigned max_halvings = 6;
// A part of the energies that are compared.
constexpr double rounding = 1e-12;

/// visit(mass, place among 4 numbers per vertex) for free components.
template <class Visit>
void for_each_free(Attributes& attributes, const std::vector<std::uint8_t>& free, Visit visit) {
  for (std::size_t i = 0; i < free.size(); ++i)
    if (free[i] != 0) visit(attributes.mass().get(static_cast<Index>(i / 3), 0), i / 3 * 4 + i % 3);
}

bool have_energy(const Body& body) {
  return !body.models().has(ForceLoop::Part::without_energy) &&
         std::ranges::all_of(body.loads(), [](const auto& term) {
           return term->adds_no_rows() || dynamic_cast<EnergyTerm*>(term.get()) != nullptr;
         });
}

}  // namespace

/// Where a step begins.
struct Newton::StepStart {
  bool has_energy = false;     ///< all forces have one
  double stored = 0;           ///< U, J
  double kinetic = 0;          ///< K(v) = I, J
  std::vector<double> forces;  ///< of all terms, rows of 4, N
};

/// U(x') - U(x) without the work of what moves prescribed vertices.
double Newton::growth(const StepEquations& equations, const StepStart& start) const {
  const Body& body = motion_.body();
  const double* x = motion_.body().attributes().position().rows();
  double sum = 0;
  if (start.has_energy)
    sum = body.energy(equations.time) + body.potential(equations.time) - start.stored;
  for (std::size_t i = 0; i < direction_.size(); ++i) {
    const std::size_t row = i / 3 * 4 + i % 3;
    const bool is_free = solver_.matrix().free()[i] != 0;
    if (is_free == start.has_energy) continue;
    const double work =
        (start.forces[row] + forces_[row] + loads_[row]) / 2 * (x[row] - start_[row]);
    sum += is_free ? -work : work;
  }
  return sum;
}

/// Moves by a part of the direction; false if I + U would grow, or the forces do not exist there.
bool Newton::try_part(const StepEquations& equations, const StepStart& start, double part) {
  Attributes& attributes = motion_.body().attributes();
  double *x = attributes.position().rows(), *v = attributes.velocity().rows();
  for (std::size_t i = 0; i < direction_.size(); ++i) {
    const std::size_t row = i / 3 * 4 + i % 3;
    x[row] = start_[row] + remaining_[i] + part * (direction_[i] - remaining_[i]);
  }
  try {
    evaluate(equations);
  } catch (const NumericalError&) {
    if (part == 0) throw;
    return false;
  }
  double size = 0, kinetic = 0;
  for_each_free(attributes, solver_.matrix().free(), [&](double mass, std::size_t row) {
    const double off = x[row] - equations.position[row], way = x[row] - start_[row];
    size += mass / 2 *
            (equations.acceleration * off * off + motion_.damping() * equations.rate * way * way);
    kinetic += mass / 2 * v[row] * v[row];
  });
  const double grown = growth(equations, start);
  const double noise = rounding * (std::abs(start.stored) + start.kinetic);
  if (part > 0 && !(size + grown <= start.kinetic + noise)) return false;
  const double allowed = std::max(0.0, start.kinetic - grown);
  if (kinetic <= allowed) return true;
  const double factor = std::sqrt(allowed / kinetic);
  for_each_free(attributes, solver_.matrix().free(),
                [&](double, std::size_t row) { v[row] *= factor; });
  return true;
}

void Newton::take_step(const StepEquations& equations, StepClock& clock) {
  start(equations);
  Body& body = motion_.body();
  StepStart begin;
  for_each_free(body.attributes(), solver_.matrix().free(), [&](double mass, std::size_t row) {
    begin.kinetic += mass / 2 * equations.velocity[row] * equations.velocity[row];
  });
  begin.has_energy = have_energy(body);
  if (begin.has_energy) begin.stored = body.energy(equations.time) + body.potential(equations.time);
  evaluate(equations);
  begin.forces.resize(forces_.size());
  std::ranges::transform(forces_, loads_, begin.forces.begin(), std::plus<>());
  set_remaining(equations.time);
  solver_.set_symmetric(is_symmetric(equations));
  const LinearSolve solve = find_direction(equations, linear_tolerance, &clock);
  ++budgeted_.steps;
  budgeted_.ended += solve.outcome == LinearSolve::Outcome::too_many;
  budgeted_.largest_residual = std::max(budgeted_.largest_residual, solve.residual);
  double part = 1;
  for (unsigned i = 0; !try_part(equations, begin, part); ++i)
    part = i < max_halvings ? part / 2 : 0;
  if (on_iteration)
    on_iteration({1, solve.iterations, norm(residual_), scale_, part,
                  solve.outcome == LinearSolve::Outcome::indefinite});
}

void Newton::prepare(const StepEquations& equations) {
  start(equations);
  solver_.set_matrix(equations);
  solver_.prepare();
}

void Newton::budget_state(Archive& archive) {
  archive("steps", budgeted_.steps);
  archive("ended", budgeted_.ended);
  archive("largest residual", budgeted_.largest_residual);
}

std::string Newton::budget_text() const {
  if (budgeted_.ended == 0) return "";
  std::ostringstream text;
  text << "the budget ended " << budgeted_.ended << " of " << budgeted_.steps
       << " linear solves early; the worst left " << std::setprecision(3)
       << 100 * budgeted_.largest_residual << " % of its residual";
  return text.str();
}

}  // namespace suture
