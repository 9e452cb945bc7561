// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

#include "kernel/forces/body_share.hpp"

namespace suture {

/// The sums of the arrays range(first, end) over ranges of `size` vertices, a multiple of a block,
/// in their order. With a share, this process computes the ranges that it steps, and gets the
/// others.
template <std::size_t n, class Range>
std::array<double, n> sums_of_blocks(BodyShare* share, Index vertices, Index size, Range range) {
  std::vector<std::array<double, n>> sums((vertices + BodyShare::block - 1) / BodyShare::block);
  const auto add = [&](Index begin, Index end) {
    for (; begin < end; begin += size)
      sums[begin / BodyShare::block] = range(begin, std::min(begin + size, vertices));
  };
  if (share) {
    for (const auto& [begin, end] : share->own()) add(begin, end);
    add(share->common_begin(), vertices);
    share->join_blocks(std::span(sums.data()->data(), n * sums.size()), n, true);
  } else {
    add(0, vertices);
  }
  std::array<double, n> total{};
  for (const auto& sum : sums)
    for (std::size_t i = 0; i < n; ++i) total[i] += sum[i];
  return total;
}

/// The same for one number.
template <class Range>
double sum_of_blocks(BodyShare* share, Index vertices, Index size, Range range) {
  const auto one = [&](Index first, Index end) { return std::array{range(first, end)}; };
  return sums_of_blocks<1>(share, vertices, size, one)[0];
}

}  // namespace suture
