// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/timer.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace suture::bench {

double now(unsigned threads) {
  timespec t{};
  clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wall() { return now(2); }

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

Timing measure(const std::function<void()>& call, unsigned threads, double seconds) {
  constexpr double round_seconds = 0.01;
  constexpr std::size_t least_rounds = 5;
  call();  // warm
  const double before = now(threads);
  call();
  const double once = std::max(now(threads) - before, 1e-9);
  const int calls = static_cast<int>(std::ceil(round_seconds / once));
  std::vector<double> rounds;
  double total = 0;
  while (rounds.size() < least_rounds || total < seconds) {
    const double start = now(threads);
    for (int i = 0; i < calls; ++i) call();
    const double spent = now(threads) - start;
    rounds.push_back(spent / calls);
    total += spent;
  }
  std::sort(rounds.begin(), rounds.end());
  return {rounds.front(), rounds[rounds.size() / 2]};
}

}  // namespace suture::bench
