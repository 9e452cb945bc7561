// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/obstacle_forces.hpp"

#include <algorithm>
#include <utility>

#include "kernel/forces/quad.hpp"

namespace suture {
namespace {

// Of the bound on the stiffness of the body at a vertex: with less, more updates are needed, with
// more, more iterations of linear solvers.
constexpr double stiffening = 4;
constexpr int all_held = 7;

Vec3 along_surface(const Vec3& a, const Vec3& normal) {
  return minus(a, scaled(dot(a, normal), normal));
}

}  // namespace

ObstacleForces::ObstacleForces(Contact& contact, Attributes& attributes, ForceTerm& models,
                               bool is_static)
    : ContactTerm(contact, attributes, models, stiffening), is_static_(is_static) {
  resize();
}

void ObstacleForces::resize() {
  for (auto* all : {&multipliers_, &accepted_}) {
    all->resize(contact_.obstacles().size());
    for (std::vector<Multiplier>& of : *all) of.resize(attributes_.vertex_count());
  }
  stiffness_.clear();
}

// ------------------------------------------------------------------- forces --

/// visit(push) for all vertices that an obstacle pushes, and for those at its surface, without a
/// force: their tangent holds a body that lies on it.
template <class Visit>
void ObstacleForces::for_each_push(double time, Visit visit) {
  find_stiffness(time);
  const double *x = attributes_.position().rows(), *fixed = attributes_.fixed().rows();
  const double touching = tolerance * contact_.mean_edge();
  for (std::size_t i = 0; i < contact_.obstacles().size(); ++i) {
    const PlacedObstacle placed(contact_.obstacles()[i], contact_.thickness(),
                                start_.empty() ? time : start_time_, time);
    for (const Index v : contact_.surface().vertices()) {
      const double normal = multipliers_[i][v].normal;
      const Vec3 place = row(x, v);
      if (static_cast<int>(fixed[v]) == all_held ||
          (normal == 0 && !placed.may_touch(place, touching)))
        continue;
      const Nearest nearest = placed.gap(place);
      const double pressure = normal - stiffness_[v] * nearest.distance;
      if (pressure > 0 || (normal == 0 && nearest.distance < touching))
        visit(push_of(placed, i, v, nearest, std::max(0.0, pressure)));
    }
  }
}

ObstacleForces::Push ObstacleForces::push_of(const PlacedObstacle& placed, std::size_t obstacle,
                                             Index vertex, const Nearest& nearest,
                                             double pressure) const {
  Push push{obstacle, vertex, nearest.normal, nearest.distance, pressure, {}, {}, 1, {}};
  const double friction = contact_.obstacles()[obstacle].friction;
  if (!(friction > 0) || start_.empty()) return push;
  const Vec3 place = row(attributes_.position().rows(), vertex);
  const Vec3 way = minus(minus(place, row(start_.data(), vertex)), placed.displacement(place));
  push.sliding = along_surface(way, nearest.normal);
  const Vec3 held = along_surface(multipliers_[obstacle][vertex].tangential, nearest.normal);
  push.friction = minus(held, scaled(stiffness_[vertex], push.sliding));
  const double size = norm(push.friction), most = friction * pressure;
  if (size <= most) return push;
  push.direction = scaled(1 / size, push.friction);
  push.friction = scaled(most, push.direction);
  push.holding = most / size;
  return push;
}

/// Those at a surface carry nothing.
std::vector<Contact::Force> ObstacleForces::forces_at(double time) {
  std::vector<Contact::Force> forces;
  for_each_push(time, [&](const Push& push) {
    if (push.pressure > 0)
      forces.push_back(
          {push.vertex, plus(scaled(push.pressure, push.normal), push.friction), push.obstacle});
  });
  return forces;
}

/// At the end of a step, and where a run begins.
void ObstacleForces::add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
  std::vector<double> forces(std::size_t{attributes_.vertex_count()} * 4);
  add_forces(step.time, live, forces.data());
  for (std::size_t i = 0; i < forces.size(); ++i) rows[i] += forces[i];
  contact_.record(forces_at(step.time), step.time, has_step_ ? heat(step.time) : 0);
  if (!last_force_.empty()) book(forces, step.last);
  const double *x = attributes_.position().rows(), *v = attributes_.velocity().rows();
  last_position_.assign(x, x + forces.size());
  last_velocity_.assign(v, v + forces.size());
  last_force_ = std::move(forces);
  has_step_ = false;
}

/// In a motion, the impulse of the step does the work f h . (v- + v+) / 2, exactly what it changes
/// in the kinetic energy; between equilibria, forces do that of their mean.
void ObstacleForces::book(const std::vector<double>& forces, double dt) {
  const double *x = attributes_.position().rows(), *v = attributes_.velocity().rows();
  for (std::size_t i = 0; i < forces.size(); ++i)
    work_ += is_static_  ? (last_force_[i] + forces[i]) / 2 * (x[i] - last_position_[i])
             : has_step_ ? forces[i] * dt * (last_velocity_[i] + v[i]) / 2
                         : 0;
}

/// What friction has dissipated since the start of the step, J.
double ObstacleForces::heat(double time) {
  double heat = 0;
  for_each_push(time, [&](const Push& push) { heat -= dot(push.friction, push.sliding); });
  return heat;
}

// ------------------------------------------------------------------ tangents --

/// With p' = -k n and, where it slides, q' = mu p' t + holding (-k) (1 - n n^T - t t^T), t the
/// direction of friction. Without the derivatives of n, which are smaller by the penetration over
/// the radius of the obstacle; and without that by the pressure, which is not symmetric.
Vec3 ObstacleForces::apply(const Push& push, const Vec3& d) const {
  const double k = stiffness_[push.vertex];
  const Vec3 normal = scaled(-k * dot(push.normal, d), push.normal);
  if (!(contact_.obstacles()[push.obstacle].friction > 0) || start_.empty()) return normal;
  const Vec3 sliding = along_surface(d, push.normal);
  const Vec3 turning = minus(sliding, scaled(dot(push.direction, sliding), push.direction));
  return plus(normal, scaled(-k * push.holding, turning));
}

Vec3 ObstacleForces::apply_skew(const Push& push, const Vec3& d) const {
  const double friction = contact_.obstacles()[push.obstacle].friction;
  return scaled(-stiffness_[push.vertex] * friction * dot(push.normal, d), push.direction);
}

bool ObstacleForces::is_conservative(double) {
  return std::ranges::all_of(contact_.obstacles(),
                             [](const Obstacle& obstacle) { return obstacle.friction == 0; });
}

void ObstacleForces::add_tangent(const double* d, double dx, double, const TangentTime& at,
                                 double* out) {
  for_each_push(at.time, [&](const Push& push) {
    const std::size_t i = std::size_t{push.vertex} * 3;
    const Vec3 f = apply(push, {d[i], d[i + 1], d[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) out[i + c] += dx * f[c];
  });
}

void ObstacleForces::add_skew_tangent(const double* d, double dx, const TangentTime& at,
                                      double* out) {
  for_each_push(at.time, [&](const Push& push) {
    const std::size_t i = std::size_t{push.vertex} * 3;
    const Vec3 f = apply_skew(push, {d[i], d[i + 1], d[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) out[i + c] += dx * f[c];
  });
}

bool ObstacleForces::add_tangent_in_single(const float* d, double dx, double, const TangentTime& at,
                                           float* out) {
  for_each_push(at.time, [&](const Push& push) {
    const std::size_t i = std::size_t{push.vertex} * 4;
    const Vec3 f = apply(push, {d[i], d[i + 1], d[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) out[i + c] += static_cast<float>(dx * f[c]);
  });
  return true;
}

void ObstacleForces::for_each_tangent(double dx, double, const TangentTime& at,
                                      const VisitTangents& visit) {
  for_each_push(at.time, [&](const Push& push) {
    std::array<double, 9 * 8> values{};  // one of 8 cells
    for (std::size_t column = 0; column < 3; ++column) {
      Vec3 d{};
      d[column] = dx;
      const Vec3 f = apply(push, d);
      for (std::size_t r = 0; r < 3; ++r) values[(column * 3 + r) * 8] = f[r];
    }
    visit({1, 1, &push.vertex, values.data()});
  });
}

// --------------------------------------------------------------------- steps --

void ObstacleForces::begin_step(double time) {
  const double* x = attributes_.position().rows();
  start_.assign(x, x + std::size_t{attributes_.vertex_count()} * 4);
  start_time_ = time;
  multipliers_ = accepted_;
}

/// True if the equations have to be solved again.
bool ObstacleForces::update(double time) {
  std::vector<std::vector<Multiplier>> next(multipliers_.size());
  for (std::size_t i = 0; i < next.size(); ++i) next[i].resize(multipliers_[i].size());
  double largest = 0;
  for_each_push(time, [&](const Push& push) {
    const double k = stiffness_[push.vertex];
    const Multiplier& last = multipliers_[push.obstacle][push.vertex];
    const double change = norm(minus(push.friction, last.tangential)) / k;
    largest = std::max({largest, std::abs(push.gap), push.holding < 1 ? 0 : change});
    next[push.obstacle][push.vertex] = {push.pressure, push.friction};
  });
  multipliers_ = std::move(next);
  return largest > tolerance * contact_.mean_edge();
}

void ObstacleForces::accept() {
  accepted_ = multipliers_;
  has_step_ = true;
}

void ObstacleForces::forget_last() {
  last_force_.clear();
  has_step_ = false;
}

void ObstacleForces::restart() {
  work_ = 0;
  forget_last();
}

void ObstacleForces::follow(const CellComplex&, const TopologyChange&) {
  resize();
  start_.clear();
  forget_last();
}

void ObstacleForces::state(Archive& archive) {
  if (archive.has_cells()) archive("stiffness", stiffness_);
  for (std::size_t i = 0; i < multipliers_.size(); ++i) {
    archive.member(("pressures " + std::to_string(i)).c_str(), accepted_[i], &Multiplier::normal);
    archive.member(("friction " + std::to_string(i)).c_str(), accepted_[i],
                   &Multiplier::tangential);
  }
  archive("start", start_);
  archive("start time", start_time_);
  archive("work", work_);
  archive("has step", has_step_);
  archive("last force", last_force_);
  archive("last position", last_position_);
  archive("last velocity", last_velocity_);
  if (archive.loads()) multipliers_ = accepted_;
}

}  // namespace suture
