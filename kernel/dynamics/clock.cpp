// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/base/saturate.hpp"

namespace suture {
namespace {

// Two times are one if they differ by less than this part of their size.
constexpr double same = 1e-12;
/// Steps to a stop beyond which it is not planned for, and how many are planned then.
constexpr double max_steps = 1e12;
constexpr std::uint64_t block = 1024;
/// s: the step where neither stability nor a stop limits it.
constexpr double unlimited = 1;

}  // namespace

Clock::Clock(std::optional<double> fixed_dt, std::vector<double> stops, double period,
             std::optional<double> end)
    : fixed_dt_(fixed_dt), end_(end), stops_(std::move(stops)), period_(period) {
  if (end_) stops_.push_back(*end_);
  std::sort(stops_.begin(), stops_.end());
}

double Clock::reached_until() const { return time_ + same * std::max(1.0, std::abs(time_)); }

double Clock::tolerance() const {
  return fixed_dt_ ? *fixed_dt_ / static_cast<double>(2 * parts_)
                   : same * std::max(1.0, std::abs(time_));
}

bool Clock::reached(double t) const { return t <= time_ + tolerance(); }

bool Clock::passed(double t) const { return t < time_ - tolerance(); }

double Clock::next_stop() const {
  const double after = reached_until();
  const auto listed = std::upper_bound(stops_.begin(), stops_.end(), after);
  double stop = listed == stops_.end() ? stop_ : std::min(stop_, *listed);
  if (period_ > 0) stop = std::min(stop, period_ * (std::floor(after / period_) + 1));
  return stop;
}

double Clock::next_dt(double stable, double stop) {
  if (fixed_dt_) return *fixed_dt_ / static_cast<double>(parts_);
  const bool is_new = std::exchange(stop_, stop) != stop;
  if (std::isinf(stable) && std::isinf(next_stop())) stable = unlimited;
  if (done_ == steps_ || stable != stable_ || is_new) {
    const double steps = std::ceil((next_stop() - time_) / stable * (1 - same));
    start_ = time_;
    stable_ = stable;
    done_ = 0;
    // Without a stop ahead (a run until rest, an end that no run reaches) continue in blocks.
    const bool is_far = !(steps < max_steps);
    steps_ = is_far ? block : std::max<std::uint64_t>(saturate<std::uint64_t>(steps), 1);
    length_ = is_far ? static_cast<double>(block) * stable : next_stop() - time_;
  }
  return length_ / static_cast<double>(steps_);
}

void Clock::divide(unsigned halvings) {
  wanted_parts_ = std::uint64_t{1} << halvings;
  if (wanted_parts_ <= parts_ && parts_made_ != 0) return;  // advance() takes it over
  parts_made_ *= wanted_parts_ / std::min(parts_, wanted_parts_);
  parts_ = wanted_parts_;
}

void Clock::advance() {
  before_ = {time_, done_, whole_, parts_, parts_made_};
  ++step_;
  if (fixed_dt_) {
    if (++parts_made_ == parts_) {
      ++whole_;
      parts_made_ = 0;
      parts_ = wanted_parts_;
    }
    time_ = (static_cast<double>(whole_) +
             static_cast<double>(parts_made_) / static_cast<double>(parts_)) *
            *fixed_dt_;
  } else {
    ++done_;
    time_ = start_ + length_ * (static_cast<double>(done_) / static_cast<double>(steps_));
  }
}

void Clock::undo_advance() {
  --step_;
  time_ = before_.time;
  done_ = before_.done;
  whole_ = before_.whole;
  parts_ = before_.parts;
  parts_made_ = before_.parts_made;
}

void Clock::state(Archive& archive) {
  archive("step", step_);
  archive("time", time_);
  archive("start", start_);
  archive("length", length_);
  archive("stable", stable_);
  archive("stop", stop_);
  archive("steps", steps_);
  archive("done", done_);
  archive("whole", whole_);
  archive("parts", parts_);
  archive("parts made", parts_made_);
  archive("wanted parts", wanted_parts_);
  archive("before time", before_.time);
  archive("before done", before_.done);
  archive("before whole", before_.whole);
  archive("before parts", before_.parts);
  archive("before parts made", before_.parts_made);
}

}  // namespace suture
