// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>

#include "kernel/contact/multiplier_forces.hpp"

namespace suture {

void MultiplierForces::state_of(Archive& archive, Pairs& pairs) {
  std::vector<Index> ends, vertices;
  std::vector<double> weights;
  for (const Pair& pair : pairs) {
    vertices.insert(vertices.end(), pair.vertices.begin(), pair.vertices.end());
    weights.insert(weights.end(), pair.weights.begin(), pair.weights.end());
    ends.push_back(static_cast<Index>(vertices.size()));
  }
  archive.member("touching", pairs, &Pair::key);
  archive("ends", ends);
  archive("vertices", vertices);
  archive("weights", weights);
  archive.member("normals", pairs, &Pair::normal);
  archive.member("beside", pairs, &Pair::beside);
  archive.member("stiffnesses", pairs, &Pair::stiffness);
  archive.member("masses", pairs, &Pair::mass);
  archive.member("start gaps", pairs, &Pair::start_gap);
  archive.member("recoveries", pairs, &Pair::recovery);
  archive.member("pressures", pairs, &Pair::pressure);
  archive.member("friction", pairs, &Pair::friction);
  if (!archive.loads()) return;
  archive.require(ends.size() == pairs.size() && vertices.size() == weights.size() &&
                      std::ranges::is_sorted(ends) &&
                      (ends.empty() ? 0 : ends.back()) == vertices.size(),
                  "contacts without vertices, or the reverse");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto first = std::ptrdiff_t(i == 0 ? 0 : ends[i - 1]), end = std::ptrdiff_t(ends[i]);
    pairs[i].vertices.assign(vertices.begin() + first, vertices.begin() + end);
    pairs[i].weights.assign(weights.begin() + first, weights.begin() + end);
  }
}

void MultiplierForces::state(Archive& archive) {
  if (archive.has_cells()) archive("stiffness", stiffness_);
  for (std::size_t i = 0; i < accepted_of_obstacles_.size(); ++i) {
    std::vector<Multiplier>& of = accepted_of_obstacles_[i];
    archive.member(("pressures " + std::to_string(i)).c_str(), of, &Multiplier::pressure);
    archive.member(("friction " + std::to_string(i)).c_str(), of, &Multiplier::friction);
  }
  state_of(archive, accepted_pairs_);
  archive("bounds stay", accepted_bounds_stay_);
  archive("start", start_);
  archive("start time", start_time_);
  archive("work", work_);
  archive("has step", has_step_);
  archive("largest gap left", largest_gap_left_);
  archive("inexact steps", inexact_steps_);
  archive("accepted steps", accepted_steps_);
  archive("last force", last_force_);
  archive("last position", last_position_);
  archive("last velocity", last_velocity_);
  if (!archive.loads()) return;
  for (const Pair& pair : accepted_pairs_)
    for (const Index v : pair.vertices)
      archive.require(v < attributes_.vertex_count(), "contact is that of another body");
  return_to_accepted();
  last_start_.reset();
}

}  // namespace suture
