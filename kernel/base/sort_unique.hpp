// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace suture {

/// Leaves each value from position `first` on once, in ascending order.
template <class T>
void sort_unique(std::vector<T>& values, std::size_t first = 0) {
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, values.end());
  values.erase(std::unique(begin, values.end()), values.end());
}

}  // namespace suture
