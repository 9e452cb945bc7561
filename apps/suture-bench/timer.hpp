// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

namespace suture::bench {

/// Seconds of one call: the best and the median of several rounds.
struct Timing {
  double best = 0, median = 0;
};

/// Repeats `call` until `seconds` have passed, at least 5 rounds of at least
/// 10 ms each. With one thread the processor time of this thread counts, which
/// others on the machine disturb less; with more, the wall clock.
Timing measure(const std::function<void()>& call, unsigned threads, double seconds = 0.5);

/// Now, by the same clock, s.
double now(unsigned threads);
/// Now, by the wall clock, s.
double wall();

/// The upper one of two in the middle; of at least one value.
double median(std::vector<double> values);

}  // namespace suture::bench
