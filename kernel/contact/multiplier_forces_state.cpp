// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "kernel/contact/multiplier_forces.hpp"

namespace suture {

void MultiplierForces::state(Archive& archive) {
  if (archive.has_cells()) archive("stiffness", stiffness_);
  for (std::size_t i = 0; i < accepted_of_obstacles_.size(); ++i) {
    std::vector<Multiplier>& of = accepted_of_obstacles_[i];
    archive.member(("pressures " + std::to_string(i)).c_str(), of, &Multiplier::pressure);
    archive.member(("friction " + std::to_string(i)).c_str(), of, &Multiplier::friction);
  }
  archive.member("touching", accepted_pairs_, &Pair::vertices);
  archive.member("weights", accepted_pairs_, &Pair::weights);
  archive.member("normals", accepted_pairs_, &Pair::normal);
  archive.member("beside", accepted_pairs_, &Pair::beside);
  archive.member("stiffnesses", accepted_pairs_, &Pair::stiffness);
  archive.member("masses", accepted_pairs_, &Pair::mass);
  archive.member("pressures", accepted_pairs_, &Pair::pressure);
  archive.member("friction", accepted_pairs_, &Pair::friction);
  archive("bounds stay", accepted_bounds_stay_);
  archive("start", start_);
  archive("start time", start_time_);
  archive("work", work_);
  archive("has step", has_step_);
  archive("last force", last_force_);
  archive("last position", last_position_);
  archive("last velocity", last_velocity_);
  if (!archive.loads()) return;
  for (const Pair& pair : accepted_pairs_)
    for (const Index v : pair.vertices)
      archive.require(v < attributes_.vertex_count(), "contact is that of another body");
  of_obstacles_ = accepted_of_obstacles_;
  pairs_ = accepted_pairs_;
  bounds_stay_ = accepted_bounds_stay_;
}

}  // namespace suture
