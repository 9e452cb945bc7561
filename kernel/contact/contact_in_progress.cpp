// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/contact_in_progress.hpp"

namespace suture {
namespace {

// Between two obstacles that a vertex touches at once.
constexpr int max_sweeps = 16;

}  // namespace

void ContactInProgress::push_path(VertexPath& path, std::span<PushBy> by, double edge) const {
  for (PushBy& each : by) each.push = {};
  bool moved = true;
  for (int sweep = 0; sweep < max_sweeps && moved; ++sweep) {
    moved = false;
    for (auto& [vertex, obstacle, push] : by) {
      const PlacedObstacle& of = placed[obstacle];
      if (sweep > 0 && !of.may_meet(path.start, path.end, -least_push * edge)) continue;
      const double speed = of.push(path, max_push * edge, push);
      moved = moved || path.dt * speed > least_push * edge;
    }
    if (by.size() <= 1) break;  // once is enough
  }
}

}  // namespace suture
