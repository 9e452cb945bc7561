// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <limits>

namespace suture {

/// A number without its fraction; the nearest limit if it is out of range for the integer type; 0
/// for NaN. A cast would be undefined then, and numbers in scenes and files can have any size.
template <std::integral To>
constexpr To saturate(double value) {
  constexpr auto low = static_cast<double>(std::numeric_limits<To>::min());
  constexpr auto high = static_cast<double>(std::numeric_limits<To>::max());
  if (value != value) return 0;
  if (value <= low) return std::numeric_limits<To>::min();
  // The limit of a 64-bit type is rounded up: `high` itself is out of range.
  if (value >= high) return std::numeric_limits<To>::max();
  return static_cast<To>(value);
}

}  // namespace suture
