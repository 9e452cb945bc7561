// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/aligned.hpp"
#include "kernel/dynamics/motion.hpp"

namespace suture {

/// The sums over the vertices for the search for rest (loops::RestSums): residual forces, and their
/// change since the previous call. 64 B per vertex.
class RestSums {
 public:
  /// The sums in the current state; evaluates the forces, which the next step uses.
  loops::RestSums evaluate(Motion& motion);
  void state(Archive& archive);

 private:
  AlignedVector<double> old_position_, old_force_, external_;
  std::uint64_t jumps_ = 0;  ///< of the motion, at the previous call
};

}  // namespace suture
