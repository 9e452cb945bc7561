// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/stagnation.hpp"

#include <algorithm>
#include <cmath>

namespace suture {

void Stagnation::state(Archive& archive) {
  archive("best", best_);
  archive("here", window_best_);
  archive("window begin", window_begin_);
  archive("rate", rate_);
  archive("best step", best_step_);
  archive("last step", last_step_);
  archive("here step", window_best_step_);
  archive("checks", checks_);
  archive("idle", idle_);
  archive("restarts", restarts_);
}

double slow_rate(double w, double alpha) {
  const double half = alpha / 2;
  if (half <= w) return std::max(half, 0.01 * w);
  return w * w / (half + std::sqrt(half * half - w * w));
}

void Stagnation::restart() {
  const unsigned restarts = restarts_;
  *this = {};
  restarts_ = restarts;
}

void Stagnation::add(std::uint64_t step, double time, double distance, double rate) {
  if (checks_++ == 0) window_begin_ = time;
  last_step_ = step;
  if (distance < window_best_) {
    window_best_ = distance;
    window_best_step_ = step;
  }
  if (rate > 0) rate_ = std::min(rate_, rate);
  if (checks_ < least_checks || !(rate_ * (time - window_begin_) >= window_decays)) return;
  close_window(step);
}

void Stagnation::close_window(std::uint64_t step) {
  if (window_best_ <= best_ / 2) {
    best_ = window_best_;
    best_step_ = window_best_step_;
    idle_ = 0;
  } else if (window_best_ > 2 * best_ && restarts_ < restarts_allowed) {
    ++restarts_;
    best_ = window_best_;
    best_step_ = step;
    idle_ = 0;
  } else {
    ++idle_;
  }
  window_best_ = rate_ = infinite;
  checks_ = 0;
}

}  // namespace suture
