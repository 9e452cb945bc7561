// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace suture {

/// Largest eigenvalue of the symmetric matrix XX YY ZZ XY YZ XZ.
///   q = tr A / 3,  p^2 = |A - q I|^2 / 6,  cos 3 phi = det((A - q I)/p) / 2
///   largest = q + 2 p cos phi
/// O. K. Smith, Communications of the ACM 4 (1961) 168.
inline double largest_eigenvalue(const std::array<double, 6>& a) {
  const double q = (a[0] + a[1] + a[2]) / 3;
  const double x = a[0] - q, y = a[1] - q, z = a[2] - q;
  const double off = a[3] * a[3] + a[4] * a[4] + a[5] * a[5];
  const double p = std::sqrt((x * x + y * y + z * z + 2 * off) / 6);
  if (p == 0) return q;
  const double determinant =
      x * (y * z - a[4] * a[4]) - a[3] * (a[3] * z - a[4] * a[5]) + a[5] * (a[3] * a[4] - y * a[5]);
  const double cosine = std::clamp(determinant / (2 * p * p * p), -1.0, 1.0);
  return q + 2 * p * std::cos(std::acos(cosine) / 3);
}

}  // namespace suture
