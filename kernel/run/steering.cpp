// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/steering.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/safe_range.hpp"
#include "kernel/build/check_obstacles.hpp"

namespace suture {
namespace {

void check_target(const PoseTarget& target, const std::string& name, double now) {
  const auto complain = [&](const std::string& what) {
    throw InputError("the target of obstacle '" + name + "' " + what);
  };
  const auto is_finite = [](const std::optional<Vec3>& a) {
    return !a || std::ranges::all_of(*a, [](double number) { return std::isfinite(number); });
  };
  if (!std::isfinite(target.at)) complain("has a time that is not finite");
  if (!is_finite(target.translation)) complain("has a translation that is not finite");
  if (!is_finite(target.rotation)) complain("has a rotation that is not finite");
  for (const auto& part : {target.translation, target.rotation})
    if (part && !is_safe_point(*part)) complain("has a component larger than 1e30");
  if (target.at > now) return;
  std::ostringstream text;
  text << "must be later than now, " << time_text(now) << "; its time is " << target.at << " s";
  complain(text.str());
}

}  // namespace

std::size_t obstacle_named(const std::string& name, const ContactLaw* contact) {
  std::span<const Obstacle> obstacles;
  if (contact) obstacles = contact->obstacles();
  const auto found = std::ranges::find(obstacles, name, &Obstacle::name);
  if (found != obstacles.end()) return static_cast<std::size_t>(found - obstacles.begin());
  std::vector<std::string> names;
  for (const Obstacle& obstacle : obstacles) names.push_back(obstacle.name);
  throw InputError("the scene has no obstacle '" + name + "'" + did_you_mean(name, names));
}

Steering steering_to(const PoseTarget& target, const std::string& name, const ContactLaw* contact,
                     double now, const SolverOptions& solver) {
  const std::size_t place = obstacle_named(name, contact);
  check_target(target, name, now);
  Obstacle obstacle = contact->obstacles()[place];
  obstacle.motion = obstacle.motion.steered(now, target);
  const std::string mistake = too_fast(obstacle, *contact, solver, now);
  if (!mistake.empty()) throw InputError("obstacle '" + name + "' " + mistake);
  return {place, std::move(obstacle.motion)};
}

}  // namespace suture
