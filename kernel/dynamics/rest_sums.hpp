// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/aligned.hpp"
#include "kernel/dynamics/motion.hpp"

namespace suture {

/// What the search of rest sums up over the vertices (loops::RestSums): forces that are left,
/// and how they changed since the call before. 64 B per vertex.
class RestSums {
 public:
  /// At the present state; evaluates forces that the next step uses.
  loops::RestSums look(Motion& motion);
  void state(Archive& archive);

 private:
  AlignedVector<double> old_position_, old_force_, external_;
  std::uint64_t jumps_ = 0;  ///< of the motion, at the call before
};

}  // namespace suture
