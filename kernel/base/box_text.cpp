// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/box_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "kernel/base/saturate.hpp"

namespace suture {

std::string box_text(const Vec3& low, const Vec3& high, int digits) {
  double size = 0, largest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    size = std::max(size, high[a] - low[a]);
    largest = std::max({largest, std::abs(low[a]), std::abs(high[a])});
  }
  if (size > 0 && std::isfinite(largest / size))
    digits = std::clamp(saturate<int>(4 + std::log10(largest / size)), digits, 17);
  char text[200];
  std::snprintf(text, sizeof text, "[%.*g, %.*g, %.*g] to [%.*g, %.*g, %.*g]", digits, low[0],
                digits, low[1], digits, low[2], digits, high[0], digits, high[1], digits, high[2]);
  return text;
}

}  // namespace suture
