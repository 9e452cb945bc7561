// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/motion_sums.hpp"

#include <algorithm>
#include <cmath>

namespace suture {

void MotionSums::resize(Index vertices) { chunks_.resize((vertices + chunk - 1) / chunk); }

void MotionSums::restart() { *this = {}; }

double MotionSums::noted_before() const {
  double sum = 0;
  for (const Chunk& c : chunks_) sum += c.before;
  return sum;
}

double MotionSums::noted_driven() const {
  double sum = 0;
  for (const Chunk& c : chunks_) sum += c.driven_before;
  return sum;
}

void MotionSums::forget_last() {
  has_last_ = false;
  whole_body_only_ = false;
}

double MotionSums::squared_frequency(double before, double last_after, double last_inertia,
                                     double h) const {
  if (!(last_inertia * h * h > noise_)) return 0;
  return -(before - last_after) * h / last_inertia;
}

void MotionSums::finish_step(double before, double now, bool damps, double contact) {
  Chunk sum;
  double largest = 0;
  fastest_ = none;
  for (Chunk& c : chunks_) {
    sum.before += c.before;
    sum.after += c.after;
    sum.inertia += c.inertia;
    sum.driven.work += c.driven_before + c.driven.work;
    sum.driven.inertia += c.driven.inertia;
    sum.last_after += c.last_after;
    sum.last_inertia += c.last_inertia;
    const double here = squared_frequency(c.before, c.last_after, c.last_inertia, before);
    if (here > largest && !whole_body_only_) {
      largest = here;
      fastest_ = static_cast<Index>(&c - chunks_.data());
    }
    c.last_after = c.after;
    c.last_inertia = c.inertia;
    c.before = c.driven_before = 0;
  }
  if (whole_body_only_)
    largest = squared_frequency(sum.before, sum.last_after, sum.last_inertia, before);
  frequency_ = has_last_ ? std::sqrt(std::max(largest, 0.0)) : 0;
  const double work = (before * sum.before + now * sum.after) / 2;
  work_ += work;
  largest_kinetic_ = std::max(largest_kinetic_, sum.inertia / 2);
  driven_ += sum.driven.work;
  if (damps && has_inertia_)
    damped_ +=
        work + contact + sum.driven.work + sum.driven.inertia - (sum.inertia - last_inertia_) / 2;
  last_inertia_ = sum.inertia;
  has_last_ = has_inertia_ = true;
  whole_body_only_ = false;
}

void MotionSums::add_step(const StepSums& sums) {
  work_ += sums.work;
  damped_ += sums.damped;
  driven_ += sums.driven;
  largest_kinetic_ = std::max(largest_kinetic_, sums.kinetic);
}

void MotionSums::state(Archive& archive) {
  archive.rows<double>("chunks", chunks_);
  archive("has last", has_last_);
  archive("whole body only", whole_body_only_);
  archive("has inertia", has_inertia_);
  archive("last inertia", last_inertia_);
  archive("noise", noise_);
  archive("frequency", frequency_);
  archive("fastest", fastest_);
  archive("work", work_);
  archive("damped", damped_);
  archive("driven", driven_);
  archive("largest kinetic", largest_kinetic_);
}

}  // namespace suture
