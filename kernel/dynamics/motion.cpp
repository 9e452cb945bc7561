// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/motion.hpp"

#include <algorithm>
#include <atomic>
#include <string>

#include "kernel/attributes/held.hpp"
#include "kernel/base/aligned.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/forces/loops/dispatch.hpp"
#include "kernel/forces/sum_of_blocks.hpp"

namespace suture {
namespace {

constexpr Index pass_chunk = MotionSums::chunk;
static_assert(pass_chunk % ElementBlocks::vertices_read == 0);
/// Below, one thread is as fast. A pass between two parallel loops pays early, because
/// threads that wait through it fall asleep.
constexpr Index parallel_vertices = 8192;
constexpr Index sum_chunk = 4096;
static_assert(pass_chunk == BodyShare::block && sum_chunk % BodyShare::block == 0);

/// The chunks of the vertices that this process steps.
std::vector<std::size_t> own_chunks(const BodyShare& share, std::size_t all) {
  std::vector<std::size_t> chunks;
  const auto add = [&](std::size_t first, std::size_t end) {
    while (first < end) chunks.push_back(first++);
  };
  for (const auto& [begin, end] : share.own()) add(begin / pass_chunk, end / pass_chunk);
  add(share.common_begin() / pass_chunk, all);
  return chunks;
}

bool is_finite(const Column& column, Index row) {
  return std::isfinite(column.get(row, 0)) && std::isfinite(column.get(row, 1)) &&
         std::isfinite(column.get(row, 2));
}

}  // namespace

Motion::Motion(Body& body, double damping) : body_(body), loops_(hot_loops()), damping_(damping) {
  sums_.resize(body.attributes().vertex_count());
}

void Motion::start(double time) {
  time_ = time;
  forget_forces();
}

// ------------------------------------------------------------------- forces --

void Motion::evaluate(double dt) {
  if (evaluated_ && evaluated_dt_ == dt) return;
  if (evaluated_) clear_forces();
  evaluated_ = false;
  const bool divides = this->divides();
  double* rows = body_.attributes().force().rows();
  PartialRows& partial = body_.attributes().partial_rows();
  try {
    for (const auto& term : body_.terms()) {
      // Loads have their vertices; gravity may book its work on all of them.
      const PartialRows::OwnIsEnough own(partial, divides && !term->adds_no_rows());
      if (divides && term.get() == &body_.models())
        body_.models().add_own_forces({time_, dt, last_}, rows);
      else
        term->add_forces_in_step({time_, dt, last_}, moving(), rows);
    }
    partial.set(PartialRows::force, divides);
    require_finite_reactions(divides);
  } catch (...) {
    clear_forces();  // passes rely on zeros; the state before the step is whole
    throw;
  }
  evaluated_ = true;
  evaluated_dt_ = dt;
}

void Motion::clear_forces() {
  PartialRows& partial = body_.attributes().partial_rows();
  const PartialRows::OwnIsEnough all_are_cleared(partial, !frozen_);
  double* rows = body_.attributes().force().rows();
  const Index vertices = body_.attributes().vertex_count();
  const PartialRows::Range all{0, vertices};
  std::span<const PartialRows::Range> ranges;
  if (partial.is_partial(PartialRows::force)) ranges = partial.known();
  if (ranges.empty()) ranges = {&all, 1};
  for (const auto& [first, end] : ranges)
    if (!frozen_) std::fill(rows + std::size_t{first} * 4, rows + std::size_t{end} * 4, 0.0);
  for (Index v = 0; frozen_ && v < vertices; ++v)  // what is frozen keeps its forces
    if (awake_[v]) std::fill_n(rows + std::size_t{v} * 4, 4, 0.0);
  partial.set(PartialRows::force, false);
}

void Motion::discard_forces() {
  withheld_.clear();
  if (evaluated_) clear_forces();  // else they are zero already
  evaluated_ = false;
}

void Motion::forget_forces() {
  discard_forces();
  ++jumps_;
  is_placed_ = false;
}

void Motion::follow(const TopologyChange& change) {
  const bool is_placed = is_placed_;
  forget_forces();
  if (!blocks_) return;
  if (!change.copies.empty()) return blocks_.reset();
  blocks_->follow(body_.complex(), change, places());
  is_placed_ = is_placed;
}

const ElementBlocks& Motion::blocks() {
  steps_since_asked_ = 0;
  if (!blocks_)
    blocks_.emplace(body_.complex(), places());
  else if (!is_placed_)
    blocks_->read(0, body_.attributes().vertex_count(), places());
  is_placed_ = true;
  return *blocks_;
}

/// Contact moves vertices after the pass.
bool Motion::keeps_blocks() {
  constexpr unsigned steps_kept = 512;
  return blocks_ && !body_.contact() && ++steps_since_asked_ < steps_kept;
}

const LiveMask& Motion::moving() const {
  return frozen_ ? awake_ : body_.attributes().kernel(0).cells.live();
}

void Motion::freeze(std::span<const Index> vertices) {
  Attributes& attributes = body_.attributes();
  if (!frozen_) awake_ = attributes.kernel(0).cells.live();
  frozen_ = true;
  for (const Index v : vertices) {
    awake_.kill(v, attributes.vertex_count());
    for (int c = 0; c < 3; ++c) attributes.velocity().set(v, c, 0);
  }
}

void Motion::thaw() {
  if (!frozen_) return;
  frozen_ = false;
  body_.models().wake_all();
  clear_forces();
  evaluated_ = false;
}

void Motion::thaw_except(std::span<const Index> vertices) {
  evaluate();
  frozen_ = false;
  if (!vertices.empty()) freeze(vertices);
}

// ------------------------------------------------------------------- passes --

loops::Motion Motion::pass(std::span<const Kick> kicks) const {
  Attributes& attributes = body_.attributes();
  loops::Motion m{};
  m.position = attributes.position().rows();
  m.velocity = attributes.velocity().rows();
  m.force = attributes.force().rows();
  m.mass = attributes.mass().rows();
  std::ranges::copy(body_.acceleration(time_), m.gravity);
  m.decay[0] = m.decay[1] = 1;
  for (std::size_t i = 0; i < kicks.size(); ++i) {
    m.decay[i] = kicks[i].decay;
    m.gain[i] = kicks[i].gain;
  }
  m.live = moving().data();
  return m;
}

/// chunk(number, first vertex, end) for all vertices, or for those of this process; true if each
/// returned true.
template <class Chunk>
bool Motion::for_each_chunk(bool divides, Chunk chunk) const {
  const Index vertices = body_.attributes().vertex_count();
  const std::size_t all = (vertices + pass_chunk - 1) / pass_chunk;
  std::vector<std::size_t> own;
  if (divides) own = own_chunks(*body_.share(), all);
  const std::size_t parts = divides ? own.size() : all;
  std::atomic<bool> good{true};
  const auto one = [&](std::size_t i) {
    const std::size_t part = divides ? own[i] : i;
    const Index first = static_cast<Index>(part) * pass_chunk;
    if (!chunk(part, first, std::min(first + pass_chunk, vertices))) good = false;
  };
  if (parts * pass_chunk >= parallel_vertices)
    body_.models().workers().parallel_for(parts, one);
  else
    for (std::size_t part = 0; part < parts; ++part) one(part);
  return good;
}

ContactStep Motion::contact_step(std::span<const Kick> kicks, double dt, double end) const {
  ContactStep step;
  step.time = time_;
  step.end = end;
  step.dt = dt;
  for (const Kick& kick : kicks) {
    step.decay *= kick.decay;
    step.gain = step.gain * kick.decay + kick.gain;
  }
  const Kick whole(damping_, (last_ + dt) / 2);
  step.whole_decay = last_ != 0 ? whole.decay : step.decay;
  step.whole_gain = last_ != 0 ? whole.gain : step.gain;
  if (last_ != 0) step.work_gain = (last_ + dt) / 2 / whole.gain;
  step.acceleration = body_.acceleration(time_);
  step.moving = &moving();
  return step;
}

/// Returns its work in this step.
double Motion::resolve_contact(const ContactStep& step) {
  for (const ContactLaw::Correction& c : body_.contact()->resolve(step))
    sums_.correct_after(c.vertex, c.after, c.inertia);
  return body_.contact()->step_work();
}

void Motion::kick_and_drift(std::span<const Kick> kicks, double dt, double end, double unseen) {
  const bool divides = this->divides();
  const PartialRows::OwnIsEnough own(body_.attributes().partial_rows(), divides);
  loops::Motion m = pass(kicks);
  m.drift = dt;
  const auto run = kicks.size() == 2 ? loops_.kick_kick_drift : loops_.kick_drift;
  const Vec3 g = body_.acceleration(time_);
  Attributes& attributes = body_.attributes();
  Constraints& constraints = body_.constraints();
  const bool has_impulses = body_.contact() && !body_.contact()->is_term();
  const ContactStep step = has_impulses ? contact_step(kicks, dt, end) : ContactStep{};
  if (has_impulses) body_.contact()->prepare(step);
  evaluated_ = is_placed_ = false;
  const bool keeps_blocks = !divides && this->keeps_blocks();
  if (divides) drift_driven_of_others(dt, end);
  bool good = for_each_chunk(divides, [&](std::size_t part, Index first, Index last) {
    loops::PassSums sums;
    constraints.before_drift(attributes, g, first, last);
    if (run(&m, first, last, &sums) != 0) return false;
    constraints.apply(attributes, end, first, last);
    if (keeps_blocks) blocks_->read(first, last, places());
    const DrivenWork driven = constraints.after_drift(attributes, unseen, dt, first, last, sums);
    if (unseen > 0) sums_.note_before(part, sums, {});
    sums_.note_after(part, sums, driven);
    return true;
  });
  if (divides) good = join_pass(good);
  if (!good) refuse_not_finite();
  is_placed_ = keeps_blocks;
  const double contact = has_impulses ? resolve_contact(step) : 0;
  sums_.finish_step(last_ != 0 ? last_ : dt, dt, damping_ != 0, contact);
  time_ = end;
  last_ = end_dt_ = dt;
  for (const auto& term : body_.terms()) term->accept();
}

void Motion::kick(const Kick& kick) {
  loops::Motion m = pass({&kick, 1});
  const Vec3 g = body_.acceleration(time_);
  Attributes& attributes = body_.attributes();
  Constraints& constraints = body_.constraints();
  const bool good = for_each_chunk(false, [&](std::size_t part, Index first, Index last) {
    loops::PassSums sums;
    constraints.before_kick(attributes, first, last);
    if (loops_.kick(&m, first, last, &sums) != 0) return false;
    constraints.apply(attributes, time_, first, last);
    const DrivenWork driven = constraints.after_kick(attributes, g, last_, first, last, sums);
    sums_.note_before(part, sums, driven);
    return true;
  });
  if (!good) refuse_not_finite();
}

void Motion::arrive(double dt, double end) {
  discard_forces();
  is_placed_ = false;
  time_ = end;
  if (dt > 0) last_ = dt;
  for (const auto& term : body_.terms()) term->accept();
  evaluate(end_dt_);
}

void Motion::require_finite_forces() const {
  require_finite_forces(divides(), [](const Column& force, Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      if (!is_finite(force, v)) return v;
    return none;
  });
}

void Motion::refuse_vertex(const char* what, Index vertex) const {
  const Index element = element_of(body_.complex().dart_of(0, vertex));
  throw NotFinite(what + std::to_string(vertex) + " is not finite", body_.user_element(element));
}

void Motion::refuse_not_finite() const {
  const PartialRows::OwnIsEnough all(body_.attributes().partial_rows(), false);
  const Column& velocity = body_.attributes().velocity();
  Index vertex = 0;
  while (vertex + 1 < velocity.size() && is_finite(velocity, vertex)) ++vertex;
  refuse_vertex("velocity of node ", vertex);
}

double Motion::sum_over_vertices(const loops::Motion& m, loops::VertexSum sum) const {
  return sum_of_blocks(divides() ? body_.share() : nullptr, body_.attributes().vertex_count(),
                       sum_chunk, [&](Index first, Index last) {
                         return sum(&m, body_.attributes().fixed().rows(), first, last);
                       });
}

double Motion::kinetic(const Kick& kick) {
  const PartialRows::OwnIsEnough own(body_.attributes().partial_rows(), divides());
  return sum_over_vertices(pass({&kick, 1}), loops_.kinetic);
}

double Motion::leapfrog_part(double h) {
  const Kick kick(damping_, h);
  const PartialRows::OwnIsEnough own(body_.attributes().partial_rows(), divides());
  return h == 0 ? 0 : sum_over_vertices(pass({&kick, 1}), loops_.forcing) / 8;
}

double Motion::power() {
  const PartialRows::OwnIsEnough own(body_.attributes().partial_rows(), divides());
  const loops::Motion m = pass({});
  return sum_of_blocks(divides() ? body_.share() : nullptr, body_.attributes().vertex_count(),
                       pass_chunk, [&](Index first, Index last) {
                         loops::PassSums sums;
                         loops_.kick(&m, first, last, &sums);
                         return sums.before;
                       });
}

Motion::Sums Motion::sums_at(std::span<const Index> vertices, std::span<const Vec3> forces,
                             const Kick& kick) const {
  Attributes& attributes = body_.attributes();
  AlignedVector<double> velocity, force, mass, fixed;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Index v = vertices[i];
    if (!moving()[v]) continue;
    const double* row = attributes.velocity().rows() + std::size_t{v} * 4;
    velocity.insert(velocity.end(), row, row + 4);
    force.insert(force.end(), {forces[i][0], forces[i][1], forces[i][2], 0});
    mass.push_back(attributes.mass().get(v, 0));
    fixed.push_back(attributes.fixed().get(v, 0));
  }
  const auto with = [&](std::span<const Kick> kicks) {
    loops::Motion m = pass(kicks);
    m.velocity = velocity.data();
    m.force = force.data();
    m.mass = mass.data();
    m.live = nullptr;
    return m;
  };
  const auto count = static_cast<std::uint32_t>(mass.size());
  Sums sums;
  loops::Motion m = with({&kick, 1});
  sums.kinetic = loops_.kinetic(&m, fixed.data(), 0, count);
  const Kick last(damping_, last_);
  m = with({&last, 1});
  if (last_ != 0) sums.leapfrog = loops_.forcing(&m, fixed.data(), 0, count) / 8;
  loops::PassSums power;
  m = with({});
  loops_.kick(&m, 0, count, &power);  // with no length: nothing changes
  sums.power = power.before;
  return sums;
}

double Motion::inertia_at(std::span<const Index> vertices) const {
  Attributes& attributes = body_.attributes();
  double sum = 0;
  for (const Index v : vertices) {
    const unsigned held = held_components(attributes, v);
    const double* velocity = attributes.velocity().rows() + std::size_t{v} * 4;
    for (std::size_t c = 0; c < 3; ++c)
      if (!is_held(held, c)) sum += attributes.mass().get(v, 0) * velocity[c] * velocity[c];
  }
  return sum;
}

double Motion::inertia() const {
  std::vector<Index> all;
  for (Index v = 0; v < body_.attributes().vertex_count(); ++v)
    if (moving()[v]) all.push_back(v);
  return inertia_at(all) + body_.constraints().driven_inertia(body_.attributes());
}

Index Motion::fastest_vertex() const {
  Attributes& attributes = body_.attributes();
  const Index chunk = sums_.fastest_chunk(), vertices = attributes.vertex_count();
  const Index first = chunk == none ? 0 : chunk * pass_chunk;
  const Index last = chunk == none ? vertices : std::min(first + pass_chunk, vertices);
  const auto energy = [&](Index v) {
    const double* row = attributes.velocity().rows() + std::size_t{v} * 4;
    return attributes.mass().get(v, 0) * (row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
  };
  Index fastest = first;
  double most = -1;
  for (Index v = first; v < last; ++v)
    if (body_.complex().exists(0, v) && energy(v) > most) most = energy(fastest = v);
  return fastest;
}

void Motion::state(Archive& archive) {
  if (archive.loads()) {
    forget_forces();
    clear_forces();  // a pass that failed has left some
    if (archive.has_cells()) blocks_.reset();
  }
  archive("time", time_);
  archive("last step", last_);
  archive("end dt", end_dt_);
  archive("sums", sums_);
  archive("body", body_);
  if (archive.loads() && !archive.has_cells() && body_.share()) {  // own rows alone may be saved
    PartialRows& partial = body_.attributes().partial_rows();
    partial.set(PartialRows::position, true);
    partial.set(PartialRows::velocity, true);
  }
  if (!archive.has_cells()) return;
  archive("damping", damping_);
  archive("evaluated", evaluated_);
  archive("evaluated dt", evaluated_dt_);
  archive("withheld", withheld_);
  archive.require(
      withheld_.empty() || withheld_.size() == std::size_t{body_.attributes().vertex_count()} * 4,
      "the withheld forces belong to a different body");
  archive("jumps", jumps_);
  archive("frozen", frozen_);
  archive("awake", awake_);
}

}  // namespace suture
