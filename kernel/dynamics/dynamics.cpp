// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics.hpp"

#include <algorithm>

#include "kernel/attributes/held.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/forces_of_step.hpp"
#include "kernel/dynamics/rounding.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {
namespace {

/// The change of a field in a turn, as a part of its largest value, that is no longer followed.
constexpr double agreement = 1e-5;
constexpr unsigned most_turns = 500;

/// Rates that follow the motion of a step need (x' - x) / dt as its velocity, and a relaxation
/// needs turns, which take its effect away.
void require_turns(const VertexField& field, const DynamicsOptions& options) {
  if (options.integrator == "static" || !(field.rate || field.relaxation)) return;
  if (field.rate && options.integrator != "implicit-euler")
    throw InputError("/solver/integrator: field '" + field.name +
                     "' has rates that depend on its change and that of the shape over a step, "
                     "which \"" +
                     options.integrator +
                     "\" does not give; choose \"implicit-euler\", or \"static\"");
  if (options.solver.budget)
    throw InputError("/solver/budget: field '" + field.name +
                     "' is solved in turns with the motion, and steps on a budget have one turn; "
                     "remove it");
}

}  // namespace

Dynamics::Dynamics(Body& body, const DynamicsOptions& options)
    : motion_(body, options.damping),
      integrator_(make_integrator(options.integrator, motion_, options.solver)),
      ledger_(body, motion_.sums()) {
  const std::string without = newton() ? body.models().without_tangent() : "";
  if (!without.empty())
    throw InputError("the integrator '" + options.integrator +
                     "' needs the derivatives of all forces, and " + without +
                     " has none (suture.tangent/1); use an explicit integrator, or add the "
                     "extension to the model");
  for (const FieldEquation& field : body.fields()) require_turns(field.field(), options);
  body.constraints().give_velocity(!is_static());
  body.add_follower(*this);
}

void Dynamics::require_masses() {
  Attributes& attributes = body().attributes();
  const Column& mass = attributes.mass();
  for (Index v = 0; v < attributes.vertex_count(); ++v) {
    if (mass.get(v, 0) > 0 || !body().complex().exists(0, v)) continue;
    const Index element = element_of(body().complex().dart_of(0, v));
    throw InputError("element " + std::to_string(body().user_element(element)) +
                     " has a node without mass: no model with a density acts on it; extend the "
                     "regions of the models to cover the mesh");
  }
}

void Dynamics::start(double time) {
  require_masses();
  motion_.start(time);
  body().constraints().apply(body().attributes(), time);
  for (FieldEquation& field : body().fields())
    field.start(time, is_static()     ? FieldEquation::Steps::steady
                      : is_implicit() ? FieldEquation::Steps::implicit
                                      : FieldEquation::Steps::explicit_);
  ledger_.restart();
  motion_.sums().restart();
  for_each_with<WorkTerm>(body().terms(), [](WorkTerm& term) { term.restart(); });
  if (body().contact()) body().contact()->restart();
  forget_last();
}

void Dynamics::step(double dt, double end) {
  const bool solves_fields = is_implicit() && !body().fields().empty();
  is_whole_ = true;
  if (solves_fields) solve_fields(dt, end);
  try {
    integrator_->begin(dt);
    if (solves_fields) take_turns(dt, end);
  } catch (...) {
    integrator_->reject();
    if (solves_fields)
      for (FieldEquation& field : body().fields()) field.restore();
    throw;
  }
  if (integrator_->is_other_step(dt)) {
    const ForcesOfStep of_step(motion_, true);
    const double difference =
        motion_.leapfrog_part(dt) - motion_.leapfrog_part(motion_.last_step());
    ledger_.change_step(difference);
    motion_.sums().change_step(difference);
  }
  is_whole_ = false;
  integrator_->accept(end);
  is_whole_ = true;
  if (solves_fields || body().fields().empty()) return;
  for (FieldEquation& field : body().fields()) field.advance_explicitly(end - dt, dt);
  fields_have_changed();
}

/// Before the step of the motion, which sees the fields at its end.
void Dynamics::solve_fields(double dt, double end) {
  for (FieldEquation& field : body().fields()) field.keep();
  try {
    advance_fields(dt, end);
  } catch (...) {
    for (FieldEquation& field : body().fields()) field.restore();
    throw;
  }
  fields_have_changed();
}

/// The largest change of a field that feels the motion, as a part of its largest value.
double Dynamics::advance_fields(double dt, double end) {
  if (dt == 0 && !is_static()) return 0;
  double change = 0;
  for (FieldEquation& field : body().fields()) {
    if (is_static())
      field.settle(end);
    else
      field.advance_implicitly(end, dt);
    if (field.feels_motion()) change = std::max(change, field.relative_change());
  }
  return change;
}

/// Where fields feel the motion and it feels them, both are solved in turns until they agree: for a
/// phase field alternate minimisation (Bourdin, Francfort, Marigo, J. Mech. Phys. Solids 48, 2000,
/// 797), for a pressure the fixed-stress split (Kim, Tchelepi, Juanes, SPE Journal 16, 2011, 249).
/// They agree, too, where the motion is in balance as it is: its tolerance refers to the loads, and
/// a field may be small beside them. Steps on a budget have one turn.
void Dynamics::take_turns(double dt, double end) {
  if (!is_solved() || !body().models().reads_fields() ||
      std::ranges::none_of(body().fields(), &FieldEquation::feels_motion))
    return;
  const double* const x = body().attributes().position().rows();
  const std::size_t size = std::size_t{body().attributes().vertex_count()} * 4;
  for (unsigned turn = 0; turn < most_turns; ++turn) {
    if (advance_fields(dt, end) <= agreement) return;
    const std::vector<double> before(x, x + size);
    integrator_->repeat();
    if (std::equal(before.begin(), before.end(), x)) return;
  }
  throw StepRejected("motion and fields do not agree after " + std::to_string(most_turns) +
                         " turns; reduce /solver/dt",
                     0.5);
}

void Dynamics::fields_have_changed() {
  if (body().models().reads_fields()) motion_.discard_forces();
}

void Dynamics::synchronise(bool with_forces) {
  if (!with_forces && !integrator_->waits()) return;
  motion_.evaluate();
  if (with_forces) motion_.require_finite_forces();
  integrator_->synchronise();
}

// ------------------------------------------------------------------- ledger --

double Dynamics::kinetic() {
  motion_.evaluate();
  const ForcesOfStep of_step(motion_, true);
  return motion_.kinetic(integrator_->lacking());
}

/// h-/2 sum m a . v- over what is free: of the half step that no pass has seen.
double Dynamics::unseen_work() {
  const double seen = integrator_->is_lagging() ? motion_.power() : motion_.sums().noted_before();
  return motion_.last_step() * seen / 2;
}

Ledger::Now Dynamics::now() {
  Ledger::Now n;
  n.kinetic = kinetic();  // evaluates the forces
  n.time = time();
  n.half_step = integrator_->is_lagging() ? motion_.last_step() : 0;
  if (!is_implicit()) {
    const ForcesOfStep of_step(motion_, true);
    n.leapfrog_part = motion_.leapfrog_part(motion_.last_step());
  }
  if (body().contact()) n.contact = n.half_step * body().contact()->power() / 2;
  if (ledger_.needs_work()) n.work = unseen_work();
  return n;
}

EnergyBalance Dynamics::balance() { return ledger_.balance(now()); }

EnergyBalance Dynamics::check_balance() {
  const EnergyBalance checked = balance();
  ledger_.keep_scale(checked);
  // Motion that rounding can make has no frequency: 1000 times that of a step.
  const double h = motion_.last_step();
  const Index chunks =
      (body().attributes().vertex_count() + MotionSums::chunk - 1) / MotionSums::chunk;
  const double way = h * h * rounding_of(motion_).energy / 2;
  motion_.sums().set_noise(1e6 * way / chunks);
  return checked;
}

void Dynamics::jump(const std::function<void()>& change, bool keeps_forces) {
  if (ledger_.has_start()) ledger_.before_jump(now());
  const double inertia = motion_.inertia();
  change();
  if (!keeps_forces) motion_.forget_forces();
  forget_last();
  motion_.sums().shift_inertia(motion_.inertia() - inertia);
  if (ledger_.has_start()) ledger_.after_jump(now());
}

/// The velocity of a held vertex is that at the time of the positions; of a free one it lacks a
/// kick:  v = (v(t) - g a) / e    e, g: of that kick
void Dynamics::constrain(const std::function<std::vector<Index>()>& change) {
  motion_.thaw();
  Attributes& attributes = body().attributes();
  jump([&] {
    const std::vector<Index> freed = change();
    if (body().share()) body().models().find_share();  // others may move
    body().constraints().apply(attributes, time());
    const Kick lacking = integrator_->lacking();
    const Vec3 uniform = body().acceleration(time());
    ForcesAt known;
    const std::vector<Vec3> accelerations = accelerations_at(freed, known);
    for (std::size_t i = 0; i < accelerations.size(); ++i) {
      const unsigned held = held_components(attributes, freed[i]);
      double* v = attributes.velocity().rows() + std::size_t{freed[i]} * 4;
      for (std::size_t c = 0; c < 3; ++c)
        if (!is_held(held, c))
          v[c] = (v[c] - lacking.gain * (accelerations[i][c] + uniform[c])) / lacking.decay;
    }
  });
  integrator_->forget_cells();
}

/// f/m and gravity, by vertex, with the contact of the last step.
std::vector<Vec3> Dynamics::accelerations() {
  motion_.evaluate();
  motion_.require_finite_forces();
  const ForcesOfStep of_step(motion_);
  Attributes& attributes = body().attributes();
  std::vector<Vec3> result(attributes.vertex_count(), body().acceleration(time()));
  const double *mass = attributes.mass().rows(), *force = attributes.force().rows();
  for (std::size_t v = 0; v < result.size(); ++v)
    for (std::size_t c = 0; c < 3 && mass[v] > 0; ++c) result[v][c] += force[4 * v + c] / mass[v];
  return result;
}

/// The kick that the velocities lack is another:
///   e v' + g a' = e v + g a       e, g: of that kick
void Dynamics::change_forces(const std::function<void()>& change) {
  motion_.thaw();
  jump([&] {
    const std::vector<Vec3> before = accelerations();
    change();
    require_masses();
    for (const auto& term : body().terms()) term->forget_models();
    for (FieldEquation& field : body().fields()) field.forget_models();
    motion_.forget_forces();
    const std::vector<Vec3> after = accelerations();
    const Kick lacking = integrator_->lacking();
    Attributes& attributes = body().attributes();
    for (Index v = 0; v < attributes.vertex_count(); ++v) {
      const unsigned held = held_components(attributes, v);
      double* velocity = attributes.velocity().rows() + std::size_t{v} * 4;
      for (std::size_t c = 0; c < 3; ++c)
        if (!is_held(held, c))
          velocity[c] += lacking.gain / lacking.decay * (before[v][c] - after[v][c]);
    }
  });
  integrator_->forget_cells();
}

/// Cells, positions or velocities jumped: the step before and the next do not show a frequency.
void Dynamics::forget_last() {
  motion_.sums().resize(body().attributes().vertex_count());
  motion_.sums().forget_last();
  for_each_with<WorkTerm>(body().terms(), [](WorkTerm& term) { term.forget_last(); });
}

// --------------------------------------------------------------- operations --

/// Remembers the accelerations: half a step is still owed to the velocities with the forces
/// before the operation and not with those after it.
void Dynamics::before(const ComingOperation& operation) {
  removal_.reset();
  touched_.clear();
  if (!operation.only_apart || motion_.damping() != 0)
    touched_.assign(operation.vertices.begin(), operation.vertices.end());
  touches_all_ = !operation.only_apart && body().constraints().has_driven();
  inertia_ = touched_inertia();
  ForcesAt known;
  if (!operation.only_apart && ledger_.has_start()) {
    if (changes_locally(operation)) {
      removal_.emplace();
      removal_->elements = body().models().elements_around(operation.vertices);
      removal_->before = part_at(operation.vertices, known);
      for_each_with<WorkTerm>(body().terms(), [&](const WorkTerm& term) {
        removal_->booked.push_back(term.booked_at(operation.vertices));
      });
    } else {
      ledger_.before_jump(now());
    }
  }
  changing_.clear();
  if (!integrator_->is_lagging()) return;
  const std::vector<Vec3> accelerations = accelerations_at(operation.vertices, known);
  for (std::size_t i = 0; i < accelerations.size(); ++i) {
    const Index v = operation.vertices[i];
    changing_.push_back({v, accelerations[i], body().attributes().mass().get(v, 0)});
  }
}

/// Computes them unless they are known.
const std::vector<Vec3>& Dynamics::forces_at(std::span<const Index> vertices, ForcesAt& known) {
  if (!std::ranges::equal(vertices, known.vertices)) {
    known.forces = body().forces_at(vertices, time());
    known.vertices.assign(vertices.begin(), vertices.end());
  }
  return known.forces;
}

/// By the terms, without gravity; none where a model fails, as the step will say so.
std::vector<Vec3> Dynamics::accelerations_at(std::span<const Index> vertices, ForcesAt& known) {
  try {
    std::vector<Vec3> result = forces_at(vertices, known);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const double mass = body().attributes().mass().get(vertices[i], 0);
      for (double& component : result[i]) component /= mass;
    }
    return result;
  } catch (const NumericalError&) {
    return {};
  }
}

/// The kick to come takes the forces f' after the operation for the whole time between two
/// velocities, but its first half belongs to the forces f before it:
///   e (v + g/e (f - f')/m) + g f'/m = e v + g f/m       e, g: of the first half
/// Vertices that meet have had the sum of their forces.
void Dynamics::kick_changed(const TopologyChange& change, ForcesAt& known) {
  const CellComplex& complex = body().complex();
  for (const Merge& merge : change.merges[0]) {
    const auto kept = std::ranges::lower_bound(changing_, merge.kept, {}, &Changing::vertex),
               gone = std::ranges::lower_bound(changing_, merge.gone, {}, &Changing::vertex);
    if (kept == changing_.end() || gone == changing_.end()) continue;
    const double mass = kept->mass + gone->mass;
    kept->acceleration = scaled(1 / mass, plus(scaled(kept->mass, kept->acceleration),
                                               scaled(gone->mass, gone->acceleration)));
    kept->mass = mass;
  }
  std::erase_if(changing_, [&](const Changing& c) { return !complex.exists(0, c.vertex); });
  if (changing_.empty()) return;
  std::vector<Changing> parents = changing_;
  std::ranges::sort(parents, {}, &Changing::vertex);
  for (const Split& split : change.splits[0]) {
    const auto parent = std::ranges::lower_bound(parents, split.old_cell, {}, &Changing::vertex);
    if (parent != parents.end() && parent->vertex == split.old_cell)
      changing_.push_back({split.new_cell, parent->acceleration, parent->mass});
  }
  std::vector<Index> vertices;
  for (const Changing& c : changing_) vertices.push_back(c.vertex);
  const std::vector<Vec3> now = accelerations_at(vertices, known);
  const Kick half = integrator_->lacking();
  Attributes& attributes = body().attributes();
  for (std::size_t i = 0; i < now.size(); ++i) {
    const unsigned held = held_components(attributes, vertices[i]);
    double* v = attributes.velocity().rows() + std::size_t{vertices[i]} * 4;
    for (std::size_t c = 0; c < 3; ++c)
      if (!is_held(held, c))
        v[c] += half.gain / half.decay * (changing_[i].acceleration[c] - now[i][c]);
  }
  if (body().models().reads_velocity()) known = {};  // they were those before the kicks
}

/// Whether all that the operation changes is at its vertices and in the elements around them (what
/// sleeps wakes everywhere), and no term has to book the last step before it.
bool Dynamics::changes_locally(const ComingOperation& operation) {
  return !operation.vertices.empty() && !is_implicit() && !motion_.is_frozen() &&
         !body().contact() && !body().has_loads() && !body().models().books_work() &&
         !body().constraints().has_driven();
}

/// At the vertices of the removal that there are; the others, which are new, follow.
Ledger::Part Dynamics::part_at(std::span<const Index> vertices, ForcesAt& known) {
  const std::vector<Vec3>& forces = forces_at(vertices, known);
  const Motion::Sums sums = motion_.sums_at(vertices, forces, integrator_->lacking());
  const double half_step = motion_.last_step() / 2;
  return {sums.kinetic, body().models().energy_around(removal_->elements, time()), sums.leapfrog,
          integrator_->is_lagging() ? half_step * sums.power : unseen_work()};
}

void Dynamics::book_removal(const TopologyChange& change, ForcesAt& known) {
  for (const Split& copy : change.copies) removal_->elements.push_back(copy.new_cell);
  motion_.sums().resize(body().attributes().vertex_count());
  motion_.sums().forget_last();
  auto booked = removal_->booked.begin();
  for_each_with<WorkTerm>(body().terms(), [&](WorkTerm& term) {
    term.shift_booked(term.booked_at(touched_) - *booked++);
  });
  ledger_.book_jump(removal_->before, part_at(touched_, known));
  removal_.reset();
}

/// The vertices of the operation that there are now.
void Dynamics::follow_touched(const TopologyChange& change) {
  if (touched_.empty()) return;
  const auto before = static_cast<std::ptrdiff_t>(touched_.size());
  for (const Split& split : change.splits[0])
    if (std::binary_search(touched_.begin(), touched_.begin() + before, split.old_cell))
      touched_.push_back(split.new_cell);
  std::erase_if(touched_, [&](Index v) { return !body().complex().exists(0, v); });
}

/// Only mass damping asks for it.
double Dynamics::touched_inertia() const {
  if (motion_.damping() == 0 || is_implicit()) return 0;
  return touches_all_ ? motion_.inertia() : motion_.inertia_at(touched_);
}

void Dynamics::follow(const CellComplex&, const TopologyChange& change) {
  motion_.thaw();
  motion_.follow(change);
  integrator_->follow(change);
  ForcesAt known;
  kick_changed(change, known);
  follow_touched(change);
  motion_.sums().shift_inertia(touched_inertia() - inertia_);
  if (change.faces_sewn == 0 && change.removed[3].empty()) {
    motion_.sums().resize(body().attributes().vertex_count());
    motion_.sums().forget_chunks();
  } else if (removal_) {
    book_removal(change, known);
  } else {
    forget_last();
    if (ledger_.has_start()) ledger_.after_jump(now());
  }
}

// -------------------------------------------------------------------- state --

void Dynamics::state(Archive& archive) {
  archive("motion", motion_);
  archive("integrator", *integrator_);
  archive("ledger", ledger_);
}

Energies energies(Dynamics& dynamics) {
  const double kinetic = dynamics.kinetic(), time = dynamics.time();
  return {kinetic, dynamics.body().energy(time), dynamics.body().potential(time)};
}

}  // namespace suture
