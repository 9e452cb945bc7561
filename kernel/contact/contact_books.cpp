// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/contact_books.hpp"

#include <algorithm>

namespace suture {

void ContactBooks::vertex(ContactInProgress::Near& near,
                          std::span<const ContactInProgress::PushBy> pushes,
                          std::vector<ContactLaw::Correction>& corrections) {
  const double mass = attributes_.mass().rows()[near.vertex];
  const Vec3 velocity = row(attributes_.velocity().rows(), near.vertex);
  const Vec3 change = minus(velocity, near.free_velocity);
  if (change == Vec3{}) return;
  const Vec3 force = free_force(near);
  near.is_booked = true;
  near.mean = mean_velocity(near, force);
  double heat = 0;
  for (const auto& [vertex, obstacle, push] : pushes) {
    if (push.normal == Vec3{}) continue;
    const Vec3 on = scaled(mass / step_.whole_gain, plus(push.normal, push.tangential));
    heat -= mass * step_.work_gain * dot(push.tangential, minus(near.mean, push.obstacle_velocity));
    kept_.obstacle_forces.push_back({vertex, obstacle, on});
  }
  results_.touches.push_back({near.vertex, scaled(mass / step_.whole_gain, change)});
  const double work = mass * step_.work_gain * dot(change, near.mean);
  results_.step_work += work;
  results_.work += work + heat;
  results_.friction_work -= heat;
  corrections.push_back(
      {near.vertex, dot(force, change),
       mass * (dot(velocity, velocity) - dot(near.free_velocity, near.free_velocity))});
}

/// Without contact, N; of sleepers 0.
Vec3 ContactBooks::free_force(const ContactInProgress::Near& near) const {
  if (!(*step_.moving)[near.vertex]) return {};
  return plus(row(in_progress_.forces.data(), near.vertex),
              scaled(attributes_.mass().rows()[near.vertex], step_.acceleration));
}

Vec3 ContactBooks::mean_velocity(const ContactInProgress::Near& near, const Vec3& force) const {
  const Vec3 kick = scaled(step_.whole_gain / attributes_.mass().rows()[near.vertex], force);
  const Vec3 before = scaled(1 / step_.whole_decay, minus(near.free_velocity, kick));
  return scaled(0.5, plus(before, row(attributes_.velocity().rows(), near.vertex)));
}

Vec3 ContactBooks::mean_velocity(const ContactInProgress::Near& near) const {
  return near.is_booked ? near.mean : mean_velocity(near, free_force(near));
}

Vec3 ContactBooks::mean_velocity(const ContactPoint& point) const {
  Vec3 mean{};
  for (std::size_t j = 0; j < point.vertices.size(); ++j) {
    const auto& near = in_progress_.near[in_progress_.near_of_vertex[point.vertices[j]]];
    mean = plus(mean, scaled(point.weights[j], mean_velocity(near)));
  }
  return mean;
}

void ContactBooks::add_force(const ContactPoint& point, Index obstacle, const Vec3& force) {
  for (std::size_t j = 0; j < point.vertices.size(); ++j)
    kept_.obstacle_forces.push_back({point.vertices[j], obstacle, scaled(point.weights[j], force)});
}

void ContactBooks::point(const ContactPoint& point, const Vec3& mass,
                         std::span<const ContactInProgress::PushBy> pushes) {
  const auto impulse = [&](const Vec3& change) {
    return Vec3{mass[0] * change[0], mass[1] * change[1], mass[2] * change[2]};
  };
  for (const auto& [number, obstacle, push] : pushes) {
    if (push.normal == Vec3{}) continue;
    friction(impulse(push.tangential), minus(mean_velocity(point), push.obstacle_velocity));
    add_force(point, obstacle,
              scaled(1 / step_.whole_gain, impulse(plus(push.normal, push.tangential))));
  }
}

void ContactBooks::friction(const Vec3& impulse, const Vec3& sliding) {
  const double heat = -step_.work_gain * dot(impulse, sliding);
  results_.work += heat;
  results_.friction_work -= heat;
}

void ContactBooks::cutting(const ContactPoint& point, Index obstacle, const Vec3& impulse,
                           const Vec3& velocity) {
  const double taken = -step_.work_gain * dot(impulse, minus(mean_velocity(point), velocity));
  results_.work += taken;
  results_.cutting_work -= taken;
  add_force(point, obstacle, scaled(1 / step_.whole_gain, impulse));
}

void ContactBooks::sum_loads() {
  std::ranges::fill(results_.loads, ContactLaw::Load{});
  for (const KeptContact::ObstacleForce& on : kept_.obstacle_forces) {
    ContactLaw::Load& load = results_.loads[on.obstacle];
    const Vec3 place = row(attributes_.position().rows(), on.vertex);
    const Vec3 arm = minus(place, in_progress_.placed[on.obstacle].centre());
    load.force = minus(load.force, on.force);
    load.torque = minus(load.torque, cross(arm, on.force));
  }
}

}  // namespace suture
