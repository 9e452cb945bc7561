// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/step_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace suture {
namespace {

constexpr unsigned max_krylov_iterations = 5000;

// A preconditioner from elsewhere may be useless: this many iterations, and twice those of a new
// one, are tried.
constexpr unsigned tried_iterations = 10;

// A new multigrid is slow that needs more iterations than these, and this many for each decrease of
// the residual by e.
constexpr unsigned unconcerned = 4;
constexpr double slow = 2;

// Building a multigrid takes as long as about this many iterations.
constexpr double iterations_worth_a_build = 8;

// The mass term of a matrix for which a preconditioner is good may differ by this factor.
constexpr double max_mass_ratio = 2;

double decrease_to(double residual) { return -std::log(std::clamp(residual, 1e-16, 1.0)); }

}  // namespace

StepSolver::StepSolver(Motion& motion)
    : motion_(motion),
      matrix_(motion.body().attributes(), motion.body().terms(), motion.body().models().workers()) {
}

void StepSolver::start(double time) {
  is_chosen_ = false;
  const Body& body = motion_.body();
  const bool has_multipliers = std::ranges::any_of(body.loads(), [](const auto& term) {
    return dynamic_cast<ConstraintTerm*>(term.get()) != nullptr;
  });
  if (!body.models().depends_on_positions_alone() || has_multipliers) discard();
  built_.is_new = false;
  matrix_.set(time);
}

void StepSolver::start(double time, std::vector<std::size_t> supports) {
  forget();
  matrix_.support(std::move(supports));
  start(time);
}

// ------------------------------------------------------------------- matrix --

void StepSolver::set_matrix(const StepEquations& equations) {
  set({equations.time, equations.dt, equations.acceleration + motion_.damping() * equations.rate,
       equations.rate, equations.loads});
  if (matrix_.free() != free_) forget();
  free_ = matrix_.free();
  if (!is_chosen_) choose();
  const double mass = built_.factors.mass;
  if (mass > max_mass_ratio * factors_.mass || factors_.mass > max_mass_ratio * mass) discard();
}

void StepSolver::set(const Factors& factors) {
  factors_ = factors;
  matrix_.set({factors.time, factors.dt}, factors.mass, factors.velocity, factors.loads);
}

PreconditionerChoice StepSolver::new_choice() const {
  Body& body = motion_.body();
  return choose_preconditioner(body.complex(), body.attributes(), matrix_,
                               {.levels = levels_, .finds_end = finds_end_});
}

/// A preconditioner of the same kind stays.
void StepSolver::choose() {
  is_chosen_ = true;
  PreconditionerChoice next = new_choice();
  if (next.kind != built_.kind) discard();
  if (next.kind != choice_.kind)
    choice_ = std::move(next);
  else
    choice_.reason = next.reason;
}

// ----------------------------------------------------------- preconditioner --

LinearSolve StepSolver::solve(std::span<const double> b, std::span<double> x, double tolerance,
                              const std::function<void()>& check) {
  if (choice_.kind != PreconditionerChoice::Kind::multigrid) levels_ = 0;
  LinearSolve result;
  result.outcome = LinearSolve::Outcome::too_many;
  if (is_ready()) {
    const double expected = built_.expected_iterations(tolerance);
    const unsigned most = tried_iterations + static_cast<unsigned>(std::min<double>(
                                                 2 * expected, max_krylov_iterations));
    result = iterate(checked_limit(most, check), b, x, tolerance);
  }
  if (result.outcome != LinearSolve::Outcome::converged) {
    build();
    result = iterate(checked_limit(max_krylov_iterations, check), b, x, tolerance);
  }
  const bool was_new = built_.decrease == 0;
  if (!built_.note(result) || result.outcome != LinearSolve::Outcome::converged) discard();
  if (was_new && is_slow(result)) find_end();
  return result;
}

LinearSolve StepSolver::iterate(const IterationLimit& limit, std::span<const double> b,
                                std::span<double> x, double tolerance) {
  const Preconditioner& preconditioner = *choice_.preconditioner;
  return is_symmetric_ ? symmetric_.solve(matrix_, preconditioner, b, x, tolerance, limit)
                       : whole_.solve(matrix_, preconditioner, b, x, tolerance, limit);
}

void StepSolver::prepare() {
  if (!is_ready()) build();
}

LinearSolve StepSolver::solve_within(StepClock& clock, std::span<const double> b,
                                     std::span<double> x, double tolerance) {
  prepare();
  const LinearSolve result = iterate(clock.limit(), b, x, tolerance);
  clock.end_solve();
  const bool is_good = built_.note(result) && result.outcome != LinearSolve::Outcome::indefinite;
  if (!is_good && clock.allows_build(build_seconds_)) discard();
  return result;
}

/// A multigrid that is new, and may have been coarsened too far.
bool StepSolver::is_slow(const LinearSolve& solve) const {
  return choice_.kind == PreconditionerChoice::Kind::multigrid && !finds_end_ &&
         solve.iterations > unconcerned + slow * decrease_to(solve.residual);
}

/// From the next hierarchy on, which replaces this one.
void StepSolver::find_end() {
  finds_end_ = true;
  levels_ = 0;
  choice_ = new_choice();
  discard();
}

/// For the current state.
void StepSolver::build() {
  Attributes& attributes = motion_.body().attributes();
  const double* x = attributes.position().rows();
  discard();
  const auto start = std::chrono::steady_clock::now();
  choice_.preconditioner->build(matrix_);
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ++builds_;
  built_.position.assign(x, x + std::size_t{attributes.vertex_count()} * 4);
  built_.factors = factors_;
  built_.kind = choice_.kind;
  is_built_ = true;
}

/// False if there is no preconditioner from before. Where it is not at hand, in a run that is
/// resumed or after a step that was rejected, it is built from what it was built from.
bool StepSolver::is_ready() {
  if (built_.position.empty() || is_built_) return is_built_;
  double* x = motion_.body().attributes().position().rows();
  const std::vector<double> here(x, x + built_.position.size());
  const Factors now = factors_;
  std::ranges::copy(built_.position, x);
  set(built_.factors);
  choice_.preconditioner->build(matrix_);
  ++builds_;
  std::ranges::copy(here, x);
  set(now);
  return is_built_ = true;
}

void StepSolver::discard() {
  built_ = {};
  is_built_ = false;
}

CoarseLevels StepSolver::coarse_levels() {
  discard();
  return choice_.preconditioner->coarse_levels(matrix_);
}

/// How many a new preconditioner needs for this decrease of the residual; 0: not known.
double StepSolver::Built::expected_iterations(double residual) const {
  return decrease > 0 ? decrease_to(residual) * iterations / decrease : 0;
}

/// False if it is of no more use: large steps on the way to a solution change the tangent as much
/// as many small ones.
bool StepSolver::Built::note(const LinearSolve& solve) {
  if (!is_new && decrease > 0) {
    excess = std::max(0.0, excess + solve.iterations - expected_iterations(solve.residual));
    return excess <= iterations_worth_a_build;
  }
  if (decrease == 0) first = solve.iterations;
  decrease += decrease_to(solve.residual);
  iterations += solve.iterations;
  return solve.iterations <= 2 * first + 4;
}

std::string StepSolver::preconditioner() const {
  const std::string name = choice_.preconditioner->name();
  return choice_.preconditioner->shift() > 0 ? name + ", its diagonal raised" : name;
}

// -------------------------------------------------------------------- state --

/// The next hierarchy begins with as many levels, which is where coarsening ended.
void StepSolver::forget() {
  discard();
  levels_ = known_levels();
  finds_end_ = false;
  choice_ = {};
  is_chosen_ = false;
}

std::size_t StepSolver::known_levels() const {
  const std::size_t levels = choice_.preconditioner ? choice_.preconditioner->levels() : 0;
  return levels != 0 ? levels : levels_;
}

void StepSolver::begin_step() {
  before_.built = built_;
  before_.free = free_;
  before_.levels = known_levels();
  before_.finds_end = finds_end_;
  before_.builds = builds_;
}

/// A hierarchy that the rejected step made goes with it.
void StepSolver::reject_step() {
  if (free_ != before_.free || known_levels() != before_.levels ||
      finds_end_ != before_.finds_end) {
    forget();
    free_ = before_.free;
    levels_ = before_.levels;
    finds_end_ = before_.finds_end;
  }
  built_ = before_.built;
  is_built_ &= builds_ == before_.builds;
}

void StepSolver::Factors::state(Archive& archive) {
  archive("time", time);
  archive("dt", dt);
  archive("mass", mass);
  archive("velocity", velocity);
  std::vector<double> numbers;  // time and factor in turn
  for (const LoadTime& load : loads) numbers.insert(numbers.end(), {load.time, load.factor});
  archive("loads", numbers);
  loads.clear();
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
    loads.push_back({numbers[i], numbers[i + 1]});
}

void StepSolver::Built::state(Archive& archive) {
  archive("position", position);
  auto number = static_cast<std::uint32_t>(kind);
  archive("kind", number);
  kind = static_cast<PreconditionerChoice::Kind>(number);
  factors.state(archive);
  archive("decrease", decrease);
  archive("iterations", iterations);
  archive("excess", excess);
  if (archive.loads()) is_new = false;
}

/// A run that is resumed has no hierarchy yet and makes the same one again.
void StepSolver::state(Archive& archive) {
  if (archive.has_cells()) {
    matrix_.set(motion_.time());  // what is free
    if (archive.loads() || matrix_.free() != free_) forget();
    std::uint64_t levels = known_levels();
    archive("levels", levels);
    if (archive.loads()) {
      levels_ = static_cast<std::size_t>(levels);
      free_ = matrix_.free();
    }
  }
  archive("finds_end", finds_end_);
  archive("built", built_);
  if (!archive.loads()) return;
  const std::size_t size = std::size_t{motion_.body().attributes().vertex_count()} * 4;
  archive.require(built_.position.empty() || built_.position.size() == size,
                  "the preconditioner belongs to a different body");
  is_built_ = false;
}

}  // namespace suture
