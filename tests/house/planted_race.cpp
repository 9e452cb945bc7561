// SPDX-License-Identifier: GPL-3.0-or-later
// A deliberate race, of the kind that an incorrect force loop would have: two tasks add to one
// vertex. Built only under the preset `tsan`, where the test passes if ThreadSanitizer reports it
// despite the suppressions for TBB.
#include <cstddef>
#include <cstdio>
#include <vector>

#include "kernel/base/parallel.hpp"

int main() {
  std::vector<double> force(3, 0.0);
  suture::Workers workers(2);
  for (int step = 0; step < 1000; ++step) {
    workers.parallel_for(64, [&](std::size_t chunk) { force[chunk % 3] += 1.0; });
  }
  std::printf("%g\n", force[0] + force[1] + force[2]);
}
