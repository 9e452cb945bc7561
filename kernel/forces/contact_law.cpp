// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/contact_law.hpp"

#include <algorithm>
#include <limits>

namespace suture {

double ContactLaw::last_change() const {
  double last = 0;
  for (const Obstacle& obstacle : obstacles_) last = std::max(last, obstacle.motion.last_change());
  return last;
}

double ContactLaw::next_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Obstacle& obstacle : obstacles_)
    next = std::min(next, obstacle.motion.next_change(time));
  return next;
}

}  // namespace suture
