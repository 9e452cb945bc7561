// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/contact.hpp"

#include <algorithm>
#include <limits>

namespace suture {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Where a vertex may end is known before the step but for rounding; of the size of the body.
constexpr double rounding = 1e-9;
// Between two obstacles that a vertex touches at once.
constexpr int max_sweeps = 16;
// Of an element: how far an obstacle moves in a step, and how far a vertex is pushed out of one.
constexpr double max_motion = 0.1, max_push = 0.01;
constexpr int held = 7;  // all components are prescribed

}  // namespace

Contact::Contact(const CellComplex& complex, Attributes& attributes,
                 std::vector<Obstacle> obstacles, double thickness)
    : attributes_(attributes),
      obstacles_(std::move(obstacles)),
      thickness_(thickness),
      surface_(complex),
      loads_(obstacles_.size()) {
  shortest_edge_ = infinity;
  const double* rest = attributes.rest().rows();
  for (const BoundarySurface::Corners& corners : surface_.corners())
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 a = row(rest, corners[i]), b = row(rest, corners[(i + 1) % 4]);
      shortest_edge_ = std::min(shortest_edge_, norm(minus(a, b)));
      include(box_, a);
    }
  size_ = norm(minus(box_.high, box_.low));
}

// --------------------------------------------------------------------- a step --

void Contact::predict(const ContactStep& step) {
  placed_.clear();
  for (const Obstacle& obstacle : obstacles_)
    placed_.emplace_back(obstacle, thickness_, step.time, step.end);
  near_.clear();
  const double *x = attributes_.position().rows(), *v = attributes_.velocity().rows(),
               *f = attributes_.force().rows(), *mass = attributes_.mass().rows(),
               *fixed = attributes_.fixed().rows();
  for (const Index vertex : surface_.vertices()) {
    const int components = static_cast<int>(fixed[vertex]);
    if (components == held || !(*step.moving)[vertex]) continue;
    const Vec3 force = plus(row(f, vertex), scaled(mass[vertex], step.acceleration));
    const Vec3 velocity =
        plus(scaled(step.decay, row(v, vertex)), scaled(step.gain / mass[vertex], force));
    const Vec3 end = plus(row(x, vertex), scaled(step.dt, velocity));
    // Prescribed components go elsewhere.
    const double margin = components == 0 ? rounding * size_ : size_;
    for (const PlacedObstacle& obstacle : placed_)
      if (obstacle.may_touch(end, margin)) {
        near_.push_back({vertex, force});
        break;
      }
  }
}

std::span<const Contact::Correction> Contact::resolve(const ContactStep& step) {
  corrections_.clear();
  touches_.clear();
  std::ranges::fill(loads_, Load{});
  step_work_ = 0;
  for (const Near& near : near_) resolve(near, step);
  return corrections_;
}

void Contact::resolve(const Near& near, const ContactStep& step) {
  double *x = attributes_.position().rows(), *v = attributes_.velocity().rows();
  const Vec3 end = row(x, near.vertex), free_velocity = row(v, near.vertex);
  const auto fixed = static_cast<unsigned>(attributes_.fixed().rows()[near.vertex]);
  VertexPath path{minus(end, scaled(step.dt, free_velocity)), end, fixed, step.dt};
  pushes_.assign(placed_.size(), {});
  if (!push_out(path, pushes_)) return;
  Vec3 change{};
  for (const Push& push : pushes_)
    change = plus(change, path.free_part(plus(push.normal, push.tangential)));
  for (std::size_t c = 0; c < 3; ++c) x[4 * std::size_t{near.vertex} + c] = path.end[c];
  add_to_row(v, near.vertex, change);
  book(near, pushes_, free_velocity, plus(free_velocity, change), step);
}

/// Out of one obstacle after the other, until it is in none; false if it was in none.
bool Contact::push_out(VertexPath& path, std::vector<Push>& pushes) const {
  bool any = false, moved = true;
  for (int sweep = 0; sweep < max_sweeps && moved; ++sweep) {
    moved = false;
    for (std::size_t i = 0; i < placed_.size(); ++i) {
      Push push;
      if (!placed_[i].push(path, max_push * shortest_edge_, push)) continue;
      pushes[i].normal = plus(pushes[i].normal, push.normal);
      pushes[i].tangential = plus(pushes[i].tangential, push.tangential);
      pushes[i].obstacle_velocity = push.obstacle_velocity;
      moved = any = true;
    }
    if (placed_.size() == 1) break;  // once is enough
  }
  return any;
}

/// An impulse J does the work J . (v- + v+)/2, exactly what it changes in the kinetic energy, and
/// friction as much relative to the obstacle.
void Contact::book(const Near& near, const std::vector<Push>& pushes, const Vec3& free_velocity,
                   const Vec3& velocity, const ContactStep& step) {
  const double mass = attributes_.mass().rows()[near.vertex];
  const Vec3 kick = scaled(step.whole_gain / mass, near.force);
  const Vec3 before = scaled(1 / step.whole_decay, minus(free_velocity, kick));
  const Vec3 mean = scaled(0.5, plus(before, velocity)), change = minus(velocity, free_velocity);
  Vec3 total{};
  double heat = 0;
  const Vec3 place = row(attributes_.position().rows(), near.vertex);
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    const Vec3 impulse = scaled(mass, plus(pushes[i].normal, pushes[i].tangential));
    if (impulse == Vec3{}) continue;
    heat -= mass * dot(pushes[i].tangential, minus(mean, pushes[i].obstacle_velocity));
    const Vec3 force = scaled(1 / step.whole_gain, impulse);
    total = plus(total, force);
    loads_[i].force = minus(loads_[i].force, force);
    loads_[i].torque = minus(loads_[i].torque, cross(minus(place, placed_[i].centre()), force));
  }
  touches_.push_back({near.vertex, total});
  const double work = mass * dot(change, mean);
  step_work_ += work;
  work_ += work + heat;
  friction_work_ -= heat;
  corrections_.push_back({near.vertex, dot(near.force, change),
                          mass * (dot(velocity, velocity) - dot(free_velocity, free_velocity))});
}

// -------------------------------------------------------------------- queries --

std::vector<double> Contact::gaps(double time) const {
  std::vector<double> gaps(attributes_.vertex_count(), std::numeric_limits<double>::quiet_NaN());
  for (const Index v : surface_.vertices()) gaps[v] = infinity;
  for (const Obstacle& obstacle : obstacles_) {
    const PlacedObstacle placed(obstacle, thickness_, time, time);
    for (const Index v : surface_.vertices())
      gaps[v] = std::min(gaps[v], placed.gap(row(attributes_.position().rows(), v)).distance);
  }
  return gaps;
}

double Contact::power() const {
  double power = 0;
  for (const Touch& touch : touches_)
    power += dot(touch.force, row(attributes_.velocity().rows(), touch.vertex));
  return power;
}

void Contact::restart() {
  touches_.clear();
  std::ranges::fill(loads_, Load{});
  work_ = friction_work_ = step_work_ = 0;
}

/// Of a half-space that turns, what is as far as the body counts.
double Contact::top_speed(const Obstacle& obstacle, double time) const {
  double reach = obstacle.reach();
  if (reach == infinity) {
    reach = 0;
    for (const Index v : surface_.vertices())
      reach =
          std::max(reach, norm(minus(row(attributes_.rest().rows(), v), obstacle.motion.centre)));
    reach += size_;
  }
  return obstacle.motion.top_speed(time, reach);
}

double Contact::longest_step(double time) const {
  double step = infinity;
  for (const Obstacle& obstacle : obstacles_) {
    if (time >= obstacle.motion.last_change()) continue;
    const double speed = top_speed(obstacle, time);
    if (speed > 0) step = std::min(step, max_motion * shortest_edge_ / speed);
  }
  return step;
}

double Contact::last_change() const {
  double last = 0;
  for (const Obstacle& obstacle : obstacles_) last = std::max(last, obstacle.motion.last_change());
  return last;
}

// ---------------------------------------------------------- operations and state --

void Contact::follow(const CellComplex& complex, const TopologyChange& change) {
  surface_.follow(complex, change);
  std::erase_if(touches_, [&](const Touch& t) { return !complex.exists(0, t.vertex); });
}

void Contact::state(Archive& archive) {
  if (archive.has_cells()) archive("surface", surface_);
  archive.member("touching", touches_, &Touch::vertex);
  archive.member("forces", touches_, &Touch::force);
  archive.rows<double>("loads", loads_);
  archive("work", work_);
  archive("friction work", friction_work_);
}

}  // namespace suture
