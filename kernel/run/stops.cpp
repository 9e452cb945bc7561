// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/stops.hpp"

#include <algorithm>
#include <cmath>

namespace suture {
namespace {

/// Adds the times of a motion that begins at `start`.
void add_motion(const Constraint& constraint, double start, std::vector<double>& stops) {
  stops.insert(stops.end(), {start + constraint.ramp.from, start + constraint.ramp.to});
  for (const double time : constraint.path.corners()) stops.push_back(start + time);
}

}  // namespace

std::vector<double> stops_of(const Scene& scene) {
  std::vector<double> stops{scene.gravity_ramp.from, scene.gravity_ramp.to};
  for (const Event& event : scene.events) {
    for (const double time : {event.start(), event.finish()})
      if (std::isfinite(time)) stops.push_back(time);
    const auto* grasp = std::get_if<Grasp>(&event.what);
    if (grasp && event.is_timed()) add_motion(grasp->held, event.at, stops);
  }
  for (const Constraint& constraint : scene.constraints) add_motion(constraint, 0, stops);
  for (const Load& load : scene.loads) stops.insert(stops.end(), {load.ramp.from, load.ramp.to});
  return stops;
}

}  // namespace suture
