// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "kernel/forces/body_share.hpp"

namespace suture {

/// The sum of range(first, end) over ranges of `size` vertices, a multiple of a block, in their
/// order. With a share, this process computes the ranges that it steps, and gets the others.
template <class Range>
double sum_of_blocks(BodyShare* share, Index vertices, Index size, Range range) {
  std::vector<double> sums((vertices + BodyShare::block - 1) / BodyShare::block);
  const auto add = [&](Index begin, Index end) {
    for (; begin < end; begin += size)
      sums[begin / BodyShare::block] = range(begin, std::min(begin + size, vertices));
  };
  if (share) {
    for (const auto& [begin, end] : share->own()) add(begin, end);
    add(share->common_begin(), vertices);
    share->join_blocks(sums, 1, true);
  } else {
    add(0, vertices);
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace suture
