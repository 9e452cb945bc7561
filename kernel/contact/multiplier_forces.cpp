// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/multiplier_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"

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
// From one iteration of Newton's method to the next.
constexpr double fading = 0.1;

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

/// The size of the box around the displacements of all vertices: 0 for a body that has shifted, m.
double MultiplierForces::deformation() const {
  const double *x = attributes_.position().rows(), *rest = attributes_.rest().rows();
  const LiveMask& live = attributes_.kernel(0).cells.live();
  Box ways = no_box;
  for (Index v = 0; v < attributes_.vertex_count(); ++v)
    if (live[v]) include(ways, minus(row(x, v), row(rest, v)));
  return diagonal_of(ways);
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
