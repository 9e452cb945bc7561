// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/moments.hpp"

#include "kernel/base/vec3.hpp"

namespace suture {

double six_volumes(const std::array<Vec3, 4>& x) {
  return dot(cross(minus(x[1], x[0]), minus(x[2], x[0])), minus(x[3], x[0]));
}

// For a tetrahedron with corners p_k: integral of x_i = V mean p_i, integral of
// x_i x_j = V / 20 (sum_k p_ki p_kj + sum_k p_ki sum_k p_kj).
void MomentSum::add(const std::array<Vec3, 4>& corners) {
  const double volume = six_volumes(corners) / 6;
  Vec3 sum{};
  for (const Vec3& p : corners) sum = plus(sum, p);
  volume_ += volume;
  first_ = plus(first_, scaled(volume / 4, sum));
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    double products = sum[b] * sum[c];
    for (const Vec3& p : corners) products += p[b] * p[c];
    second_[a] += volume / 20 * products;
  }
}

PartMoments MomentSum::moments() const {
  PartMoments result;
  result.fraction = volume_ / 8;
  result.centroid = scaled(1 / volume_, first_);
  for (std::size_t a = 0; a < 3; ++a)
    result.covariance[a] =
        second_[a] / volume_ - result.centroid[(a + 1) % 3] * result.centroid[(a + 2) % 3];
  return result;
}

}  // namespace suture
