// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/multiplier_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/solvers/links.hpp"

namespace suture {
namespace {

// In multiples of the bound on the stiffness of the body at a vertex: with less, more updates, with
// more, more iterations of linear solvers.
constexpr double stiffening_of_equilibria = 4, stiffening_of_steps = 1;
// The part of an edge by which a depth comes back in a step.
constexpr double eased = 0.0005;
// After so many updates, a step of a motion is taken if no gap is more than this part of an edge
// off its target, and after so many refused if one is.
constexpr unsigned enough_updates = 12, most_updates = 30;
constexpr double gap_allowed = 0.01;
// In equilibria, gaps with a force are at most this part of the deformation off: a small load makes
// a small depth, whose share of the deformation does not become smaller with the load.
constexpr double part_of_deformation = 1e-3;
// Cosine of an angle between the normals of a contact before and after an update.
constexpr double same_direction = 0.95;
// A contact with a force stays until its point has left the place where it was found by more, in
// typical edges.
constexpr double kept_within = 0.01;
// From one iteration of Newton's method to the next.
constexpr double fading = 0.1;

Vec3 along_surface(const Vec3& a, const Vec3& normal) {
  return minus(a, scaled(dot(a, normal), normal));
}

}  // namespace

MultiplierForces::MultiplierForces(Contact& contact, Attributes& attributes, BoundedTerm& models,
                                   bool is_static)
    : ContactTerm(contact, attributes, models, 1), is_static_(is_static) {
  resize();
}

void MultiplierForces::resize() {
  for (auto* all : {&of_obstacles_, &accepted_of_obstacles_}) {
    all->resize(contact_.obstacles().size());
    for (std::vector<Multiplier>& of : *all)
      if (contact_.points().are_embedded())
        of.clear();  // the points are others
      else
        of.resize(attributes_.vertex_count());
  }
  stiffness_.clear();
}

// ------------------------------------------------------------------- pushes --

template <class Number>
Vec3 MultiplierForces::Push::sum(const Number* rows, std::size_t width) const {
  Vec3 total{};
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      total[c] += weights[i] * double{rows[width * vertices[i] + c]};
  return total;
}

template <class Number>
void MultiplierForces::Push::add(const Vec3& force, Number* rows, std::size_t width) const {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      rows[width * vertices[i] + c] += static_cast<Number>(weights[i] * force[c]);
}

double MultiplierForces::stiffening() const {
  return is_static_ ? stiffening_of_equilibria : stiffening_of_steps;
}

/// The gap that the equations reach, for one of a stiffness of the body and a mass: negative where
/// it was negative at the start of the step. Between two steps, what is deep stays as it is.
double MultiplierForces::target(double gap, double start_gap, double stiffness, double mass,
                                double recovery, double time) const {
  if (is_static_) return 0;
  if (start_.empty()) return std::min(0.0, gap);
  const double dt = time - start_time_;
  if (!(start_gap < 0)) return 0;
  const double steps = mass > 0 ? dt * std::sqrt(stiffness / mass) : 1;
  return std::min(0.0, start_gap + eased * recovery * std::clamp(steps, 0.0, 1.0));
}

/// What inertia adds to the stiffness of the equations of a step: multipliers would converge slowly
/// without it.
double MultiplierForces::stiffness_per_mass(double time) const {
  const double dt = time - start_time_;
  return is_static_ || start_.empty() || !(dt > 0) ? 0 : stiffening() / (dt * dt);
}

/// visit(push) for everything that is pushed, and between equilibria for what touches without a
/// force: its tangent holds a body that lies there. Newton's method is slow with the tangent of a
/// force that is not there, so that it fades with the iterations; and between pieces it ends where
/// they move away, as lips often touch without a force.
template <class Visit>
void MultiplierForces::for_each_push(double time, Visit visit) {
  if (!is_listed(time)) list_pushes(time);
  for (const Push& push : listed_) visit(push);
}

/// At these positions: linear solvers ask for the same pushes in each of their iterations.
bool MultiplierForces::is_listed(double time) const {
  const double* x = attributes_.position().rows();
  return is_listed_ && time == listed_time_ && std::equal(listed_at_.begin(), listed_at_.end(), x);
}

void MultiplierForces::list_pushes(double time) {
  find_stiffness(time);
  listed_.clear();
  list_pushes_of_obstacles(time);
  const double per_mass = stiffness_per_mass(time);
  for (Pair& pair : pairs_) {
    const double stiffness = stiffening() * pair.stiffness + per_mass * pair.mass;
    Push push{
        &pair, Contact::between_pieces, pair.vertices, pair.weights, pair.normal, stiffness, 0, 0,
        0};
    const Vec3 offset = push.sum(attributes_.position().rows(), 4);
    push.gap = dot(pair.normal, offset);
    push.target = target_of(pair, time);
    push.pressure = std::max(0.0, pair.pressure - stiffness * (push.gap - push.target));
    if (!has_force(push) && (!is_static_ || pair.pressure != 0 || push.gap > pair.first_gap))
      continue;
    if (!start_.empty())
      add_friction(push, contact_.friction_of_pieces(), minus(offset, push.sum(start_.data(), 4)));
    listed_.push_back(push);
  }
  const double* x = attributes_.position().rows();
  listed_at_.assign(x, x + std::size_t{attributes_.vertex_count()} * 4);
  listed_time_ = time;
  is_listed_ = true;
}

void MultiplierForces::list_pushes_of_obstacles(double time) {
  const double *x = attributes_.position().rows(), *fixed = attributes_.fixed().rows(),
               *mass = attributes_.mass().rows();
  const double per_mass = stiffness_per_mass(time);
  const double touching = tolerance * contact_.mean_edge();
  for (std::size_t i = 0; i < contact_.obstacles().size(); ++i) {
    const Obstacle& obstacle = contact_.obstacles()[i];
    if (!obstacle.pushes) continue;
    const double start_time = start_.empty() ? time : start_time_;
    const PlacedObstacle placed(obstacle, contact_.thickness(), start_time, time);
    const PlacedObstacle at_start(obstacle, contact_.thickness(), start_time, start_time);
    of_obstacles_[i].resize(contact_.points().count());
    contact_.points().for_each([&](const ContactPoint& point) {
      Multiplier& last = of_obstacles_[i][point.number];
      const Vec3 place = point.sum(x), start = start_.empty() ? place : point.sum(start_.data());
      const Vec3* side = contact_.sides().outside(i, point.number);
      if (point.is_held(fixed) ||
          (last.pressure == 0 && !side && !placed.may_meet(start, place, touching)))
        return;
      const Nearest nearest = side ? placed.gap_from(*side, place) : placed.gap(start, place);
      const double of_body = stiffness_of(point), moved = point.in_series(mass, fixed);
      const double stiffness = stiffening() * of_body + per_mass * moved;
      Push push{
          &last, i, point.vertices, point.weights, nearest.normal, stiffness, nearest.distance,
          0,     0};
      if (nearest.distance < 0 || last.pressure > 0) {
        if (!is_static_) {
          const Nearest first = side ? at_start.gap_from(*side, start) : at_start.gap(start);
          push.target =
              target(push.gap, first.distance, of_body, moved, contact_.mean_edge(), time);
        }
        push.pressure = std::max(0.0, last.pressure - stiffness * (push.gap - push.target));
      }
      push.point = point.number;
      if (!has_force(push) && (!is_static_ || last.pressure != 0 || nearest.distance >= touching))
        return;
      push.curvature = placed.curvature(place);
      if (!start_.empty())
        add_friction(push, obstacle.friction,
                     minus(minus(place, start), placed.displacement(place)));
      listed_.push_back(push);
    });
  }
}

/// Sets what a push without pressure has of the tangent. Where the bounds of friction stay, what
/// has let go since the last update still has friction.
bool MultiplierForces::has_force(Push& push) const {
  if (push.pressure > 0) return true;
  if (push.last->pressure == 0) {
    push.stiffness *= support_;
    return false;
  }
  push.pressing = 0;
  return bounds_stay_;
}

/// Against the way of the point since the start of the step, relative to what it touches.
void MultiplierForces::add_friction(Push& push, double coefficient, const Vec3& way) const {
  if (!(coefficient > 0)) return;
  push.coefficient = coefficient;
  push.sliding = along_surface(way, push.normal);
  push.friction =
      minus(along_surface(push.last->friction, push.normal), scaled(push.stiffness, push.sliding));
  const double size = norm(push.friction);
  const double most = coefficient * (bounds_stay_ ? push.last->pressure : push.pressure);
  if (size <= most) return;
  push.direction = scaled(1 / size, push.friction);
  push.friction = scaled(most, push.direction);
  push.holding = most / size;
}

// ------------------------------------------------------------------- forces --

/// Those that touch without a force carry nothing.
std::vector<Contact::Force> MultiplierForces::forces_at(double time) {
  std::vector<Contact::Force> forces;
  for_each_push(time, [&](const Push& push) {
    if (push.pressure == 0 && push.friction == Vec3{}) return;
    const Vec3 force = plus(scaled(push.pressure, push.normal), push.friction);
    for (std::size_t i = 0; i < push.vertices.size(); ++i)
      forces.push_back({push.vertices[i],
                        scaled(push.weights[i], force),
                        push.obstacle,
                        push.point,
                        {push.gap, push.normal}});
  });
  return forces;
}

/// At the end of a step, and where a run begins.
void MultiplierForces::add_forces_in_step(const StepTimes& step, const LiveMask& live,
                                          double* rows) {
  std::vector<double> forces(std::size_t{attributes_.vertex_count()} * 4);
  add_forces(step.time, live, forces.data());
  for (std::size_t i = 0; i < forces.size(); ++i) rows[i] += forces[i];
  contact_.record(forces_at(step.time), step.time, has_step_ ? heat(step.time) : 0);
  is_listed_ = false;  // sides may be others
  if (!last_force_.empty()) book_work(forces, step.last);
  const double *x = attributes_.position().rows(), *v = attributes_.velocity().rows();
  last_position_.assign(x, x + forces.size());
  last_velocity_.assign(v, v + forces.size());
  last_force_ = std::move(forces);
  has_step_ = false;
}

/// In a motion, the impulse of the step does the work f h . (v- + v+) / 2, exactly what it changes
/// in the kinetic energy; between equilibria, forces do that of their mean.
void MultiplierForces::book_work(const std::vector<double>& forces, double dt) {
  const double *x = attributes_.position().rows(), *v = attributes_.velocity().rows();
  for (std::size_t i = 0; i < forces.size(); ++i)
    work_ += is_static_  ? (last_force_[i] + forces[i]) / 2 * (x[i] - last_position_[i])
             : has_step_ ? forces[i] * dt * (last_velocity_[i] + v[i]) / 2
                         : 0;
}

/// What friction has dissipated since the start of the step, J.
double MultiplierForces::heat(double time) {
  double heat = 0;
  for_each_push(time, [&](const Push& push) { heat -= dot(push.friction, push.sliding); });
  return heat;
}

// ------------------------------------------------------------------ tangents --

/// With p' = -k n and, where it slides, q' = mu p' t + holding (-k) (1 - n n^T - t t^T), t the
/// direction of friction, and p n' where an obstacle is round: a soft body that a sphere presses
/// feels that as much as its own stiffness. Without what n' does to friction, and without the
/// derivative of friction by the pressure, which is not symmetric.
Vec3 MultiplierForces::Push::tangent(const Vec3& d) const {
  const Vec3 along = along_surface(d, normal), &straight = curvature.straight;
  const Vec3 normal_part = plus(
      scaled(-stiffness * pressing * dot(normal, d), normal),
      scaled(pressure * curvature.per_metre, minus(along, scaled(dot(straight, along), straight))));
  if (coefficient == 0) return normal_part;
  const Vec3 turning = minus(along, scaled(dot(direction, along), direction));
  return plus(normal_part, scaled(-stiffness * holding, turning));
}

Vec3 MultiplierForces::Push::skew_tangent(const Vec3& d) const {
  return scaled(-stiffness * coefficient * dot(normal, d), direction);
}

bool MultiplierForces::is_conservative(double) {
  if (bounds_stay_) return true;
  return !(contact_.friction_of_pieces() > 0) &&
         std::ranges::all_of(contact_.obstacles(),
                             [](const Obstacle& obstacle) { return obstacle.friction == 0; });
}

void MultiplierForces::add_tangent(const double* d, double dx, double, const TangentTime& at,
                                   double* out) {
  for_each_push(at.time, [&](const Push& push) {
    push.add(scaled(dx, push.tangent(push.sum(d, 3))), out, 3);
  });
}

void MultiplierForces::add_skew_tangent(const double* d, double dx, const TangentTime& at,
                                        double* out) {
  if (bounds_stay_) return;
  for_each_push(at.time, [&](const Push& push) {
    push.add(scaled(dx, push.skew_tangent(push.sum(d, 3))), out, 3);
  });
}

bool MultiplierForces::add_tangent_in_single(const float* d, double dx, double,
                                             const TangentTime& at, float* out) {
  for_each_push(at.time, [&](const Push& push) {
    push.add(scaled(dx, push.tangent(push.sum(d, 4))), out, 4);
  });
  return true;
}

/// Between pieces as links: cells of 8 nodes. The last ones do not count if there are fewer; if
/// there are more, those with the largest weights do, as the matrix only preconditions.
void MultiplierForces::for_each_tangent(double dx, double, const TangentTime& at,
                                        const VisitTangents& visit) {
  std::vector<Index> vertices;
  std::vector<std::size_t> order;  // of the vertices of a push
  std::vector<double> values;
  for_each_push(at.time, [&](const Push& push) {
    const bool is_link = push.obstacle == Contact::between_pieces;
    order.resize(push.vertices.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (order.size() > 8)
      std::ranges::stable_sort(order, std::ranges::greater{},
                               [&](std::size_t i) { return std::abs(push.weights[i]); });
    const std::size_t used = std::min<std::size_t>(order.size(), 8), nodes = is_link ? 8 : used;
    vertices.assign(nodes, push.vertices[order[used - 1]]);
    for (std::size_t i = 0; i < used; ++i) vertices[i] = push.vertices[order[i]];
    values.assign(9 * nodes * nodes * 8, 0);  // one of 8 cells
    for (std::size_t column = 0; column < 3 * used; ++column) {
      Vec3 d{};
      d[column % 3] = dx * push.weights[order[column / 3]];
      const Vec3 f = push.tangent(d);
      for (std::size_t r = 0; r < 3 * used; ++r)
        values[(column * 3 * nodes + r) * 8] = push.weights[order[r / 3]] * f[r % 3];
    }
    visit(
        {1, static_cast<Index>(nodes), vertices.data(), values.data(), is_link ? link_functor : 0});
  });
}

// --------------------------------------------------------------------- pairs --

/// The way of the vertex from the face, or of the first edge from the second one.
Vec3 MultiplierForces::offset_of(const Pair& pair) const {
  Vec3 sum{};
  for (std::size_t i = 0; i < pair.vertices.size(); ++i)
    sum = plus(sum, scaled(pair.weights[i], row(attributes_.position().rows(), pair.vertices[i])));
  return sum;
}

/// Along its normal, at the start of the step.
double MultiplierForces::start_gap_of(const Pair& pair) const {
  if (start_.empty()) return 0;
  Vec3 sum{};
  for (std::size_t i = 0; i < pair.vertices.size(); ++i)
    sum = plus(sum, scaled(pair.weights[i], row(start_.data(), pair.vertices[i])));
  return dot(sum, pair.normal);
}

double MultiplierForces::target_of(const Pair& pair, double time) const {
  const double gap = start_.empty() ? dot(pair.normal, offset_of(pair)) : 0;
  return target(gap, pair.start_gap, pair.stiffness, pair.mass, pair.recovery, time);
}

/// Replaces the pairs; those of the same vertex or edge in about the same direction pass their
/// multipliers on. In inner corners, where faces are equally near, rounding decides which of them
/// is found: contacts with a force stay.
MultiplierForces::Change MultiplierForces::take_over(Pairs found, double time) {
  const auto is_before = [](const Pair& a, const Pair& b) { return is_found_before(a.key, b.key); };
  const auto stays = [&](const Pair& pair) {
    const Vec3 way = minus(along_surface(offset_of(pair), pair.normal), pair.beside);
    return norm(way) < kept_within * contact_.mean_edge();
  };
  Change largest;
  std::size_t first = 0;
  for (Pair& pair : found) {
    while (first < pairs_.size() && is_before(pairs_[first], pair)) ++first;
    const Vec3 offset = offset_of(pair);
    pair.start_gap = start_gap_of(pair);
    const double gap = dot(pair.normal, offset) - target_of(pair, time);
    pair.beside = along_surface(offset, pair.normal);
    largest.depth = std::max(largest.depth, -gap);
    for (std::size_t i = first; i < pairs_.size() && !is_before(pair, pairs_[i]); ++i) {
      Pair& before = pairs_[i];
      if (before.pressure == 0 || dot(before.normal, pair.normal) < same_direction) continue;
      if (before.key != pair.key && stays(before)) continue;
      static_cast<Multiplier&>(pair) = std::exchange(static_cast<Multiplier&>(before), {});
      largest.other = std::max({largest.other, gap, norm(minus(offset, offset_of(before)))});
      break;
    }
  }
  for (const Pair& before : pairs_) {
    if (before.pressure == 0) continue;
    if (stays(before))
      found.push_back(before);
    else
      largest.other = std::max(largest.other, before.pressure / (stiffening() * before.stiffness));
  }
  std::ranges::stable_sort(found, is_before);
  pairs_ = std::move(found);
  is_listed_ = false;
  return largest;
}

// --------------------------------------------------------------------- steps --

/// l = p, t = q.
void MultiplierForces::improve(double time) {
  std::vector<std::pair<Multiplier*, Multiplier>> next;
  for_each_push(time, [&](const Push& push) {
    next.push_back({push.last, {push.pressure, push.friction}});
  });
  for (std::vector<Multiplier>& of : of_obstacles_) std::ranges::fill(of, Multiplier{});
  for (Multiplier& of : pairs_) of = {};
  for (const auto& [multiplier, value] : next) *multiplier = value;
  is_listed_ = false;
}

void MultiplierForces::return_to_accepted() {
  of_obstacles_ = accepted_of_obstacles_;
  pairs_ = accepted_pairs_;
  bounds_stay_ = accepted_bounds_stay_;
  is_listed_ = false;
}

/// Again at the same time, if equations of the step had no solution: with the multipliers and the
/// positions at its start.
void MultiplierForces::begin_step(double time) {
  support_ = 1;
  updates_ = 0;
  gap_left_ = 0;
  return_to_accepted();
  improve(time);
  bounds_stay_ = false;
  if (!last_start_) last_start_.emplace(start_, start_time_);
  if (start_.empty() || time != start_time_) {
    const double* x = attributes_.position().rows();
    start_.assign(x, x + std::size_t{attributes_.vertex_count()} * 4);
    start_time_ = time;
  }
  take_over(find_pairs(time), time);
  note_places();
  for (Pair& pair : pairs_) {
    const double gap = pair.start_gap = dot(pair.normal, offset_of(pair));
    if (gap < tolerance * contact_.mean_edge()) pair.first_gap = gap;
  }
  is_listed_ = false;
}

void MultiplierForces::reject_step() {
  support_ = 1;
  return_to_accepted();
  if (last_start_) std::tie(start_, start_time_) = *std::exchange(last_start_, {});
  is_listed_ = false;
}

void MultiplierForces::begin_iteration(unsigned number, double time) {
  if (number > 0) {
    support_ *= fading;
    is_listed_ &= !is_static_;  // nothing without a force is listed in a motion
  }
  regimes_.begin(number);
  for_each_push(time, [&](const Push& push) {
    if (push.pressure > 0) regimes_.note(push.obstacle, push.vertices.front(), push.holding < 1);
  });
  regimes_.end();
}

/// With Coulomb's law, the bound of friction follows the pressure, and there is no energy that a
/// line search could decrease. With the bound of the last update (that of Tresca), there is one.
bool MultiplierForces::simplify() {
  is_listed_ = false;
  return !is_conservative(start_time_) && !std::exchange(bounds_stay_, true);
}

/// True if the equations have to be solved again. Otherwise nothing changes: the forces are those
/// that are in balance.
bool MultiplierForces::update(double time) {
  const double edge = contact_.mean_edge();
  double off = 0, other = 0, off_with_force = 0;
  for_each_push(time, [&](const Push& push) {
    if (push.pressure > 0) off_with_force = std::max(off_with_force, std::abs(push.gap));
    const double change = norm(minus(push.friction, push.last->friction)) / push.stiffness;
    off = std::max(off, std::abs(push.gap - push.target));
    other = std::max(other, push.holding < 1 ? 0 : change);
  });
  const OfObstacles of_obstacles = of_obstacles_;
  const Pairs pairs = pairs_;
  improve(time);
  const Change taken = take_over(find_pairs(time), time);
  refuse_crossings(time);
  note_places();
  off = std::max(off, taken.depth);
  ++updates_;
  const bool is_near = std::max({off, other, taken.other}) <= tolerance * edge;
  const bool is_settled = is_near && (!is_static_ || updates_ > enough_updates ||
                                      off_with_force <= part_of_deformation * deformation());
  const bool is_enough = !is_static_ && updates_ > enough_updates && off <= gap_allowed * edge;
  if (!is_settled && !is_enough) {
    if (!is_static_ && updates_ > most_updates) refuse_gap(off, time);
    return true;
  }
  gap_left_ = is_settled ? 0 : off;
  of_obstacles_ = of_obstacles;
  pairs_ = pairs;
  is_listed_ = false;
  return false;
}

void MultiplierForces::refuse_gap(double off, double time) const {
  std::ostringstream text;
  text << "contact does not settle at " << time_text(time) << ": after " << most_updates
       << " updates of its forces, a gap is " << off << " m off, which is "
       << off / contact_.mean_edge() << " of a typical edge; " << gap_allowed << " is allowed";
  throw NumericalError(text.str());
}

/// On steps whose contacts did not settle; none: all did.
std::string MultiplierForces::note() const {
  if (inexact_steps_ == 0) return "";
  std::ostringstream text;
  text << "contact did not settle to its tolerance in " << inexact_steps_ << " of "
       << count_text(accepted_steps_, "step") << ": the largest gap left is " << largest_gap_left_
       << " m, " << largest_gap_left_ / contact_.mean_edge() << " of a typical edge";
  return text.str();
}

bool MultiplierForces::hold(double time) {
  support_ = 0;
  is_listed_ = false;
  bool is_whole = true;
  for_each_push(time, [&](const Push& push) {
    if (push.pressure > 0)
      is_whole &= push.obstacle != Contact::between_pieces && push.coefficient == 0;
  });
  return is_whole;
}

void MultiplierForces::add_gap_tangent(const double* d, double time, double* out) {
  for_each_push(time, [&](const Push& push) {
    if (push.pressure > 0)
      push.add(scaled(-push.stiffness * dot(push.normal, push.sum(d, 3)), push.normal), out, 3);
  });
}

void MultiplierForces::accept() {
  accepted_of_obstacles_ = of_obstacles_;
  accepted_pairs_ = pairs_;
  accepted_bounds_stay_ = bounds_stay_;
  last_start_.reset();
  has_step_ = true;
  ++accepted_steps_;
  if (gap_left_ > 0) ++inexact_steps_;
  largest_gap_left_ = std::max(largest_gap_left_, gap_left_);
}

void MultiplierForces::forget_last() {
  last_force_.clear();
  has_step_ = false;
}

void MultiplierForces::restart() {
  work_ = 0;
  forget_last();
}

void MultiplierForces::follow(const CellComplex& complex, const TopologyChange&) {
  resize();
  for (Pairs* pairs : {&pairs_, &accepted_pairs_}) {
    std::erase_if(*pairs, [&](const Pair& pair) {
      return std::ranges::any_of(pair.vertices, [&](Index v) { return !complex.exists(0, v); });
    });
    for (Pair& pair : *pairs)  // they end if they are not found again: faces may be gone
      pair.beside[0] = std::numeric_limits<double>::infinity();
  }
  start_.clear();
  last_start_.reset();
  found_at_.clear();
  is_listed_ = false;
  forget_last();
}

}  // namespace suture
