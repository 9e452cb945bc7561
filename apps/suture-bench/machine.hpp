// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/suture-bench/body.hpp"

namespace suture::bench {

/// What this machine gives at best: the two roofs of a roofline, measured.
struct Machine {
  double flops = 0;      ///< 1/s: multiply-adds on registers, in the instruction set that loops use
  double bandwidth = 0;  ///< B/s: a[i] = b[i] + s c[i] over 3 x 128 MB, 24 B each
};
/// With `threads` threads at once. Takes about a second; measured once per count.
const Machine& machine(unsigned threads);

/// Most memory that this process has had, B. Throws IoError.
double peak_bytes();
/// From now on peak_bytes() is the peak since this call, where the system allows that.
void forget_peak();

/// Bytes that one evaluation of the forces must move if nothing stays in a cache:
/// vertices and columns of each cell, and once per functor the positions that are
/// read and the forces that are read and written (velocities, masses, rest positions
/// if it declares them). 1/element.
double bytes_per_element(BenchBody& body);

}  // namespace suture::bench
