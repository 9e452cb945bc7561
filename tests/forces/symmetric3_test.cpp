// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/symmetric3.hpp"

#include <gtest/gtest.h>

#include <random>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

/// A = sum of w n n^T over three directions n at right angles. Digits are lost where the two
/// largest eigenvalues nearly agree: the cosine is 1 there.
TEST(Symmetric3, FindsTheLargestOfThreeGivenEigenvalues) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> entry(-1, 1);
  const auto unit = [](const Vec3& d) { return scaled(1 / norm(d), d); };
  for (int i = 0; i < 1000; ++i) {
    const Vec3 first = unit({entry(random), entry(random), 1 + entry(random)});
    const Vec3 second = unit(cross(first, {entry(random), 1, entry(random)}));
    const std::array<double, 3> w{entry(random), entry(random), i % 2 ? entry(random) : 0};
    std::array<double, 6> a{};
    std::size_t at = 0;
    for (const Vec3& n : {first, second, cross(first, second)}) {
      const double xx[] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                           n[0] * n[1], n[1] * n[2], n[0] * n[2]};
      for (std::size_t k = 0; k < 6; ++k) a[k] += w[at] * xx[k];
      ++at;
    }
    EXPECT_NEAR(largest_eigenvalue(a), *std::max_element(w.begin(), w.end()), 1e-12);
  }
  EXPECT_EQ(largest_eigenvalue({3, 3, 3, 0, 0, 0}), 3);
}

}  // namespace
}  // namespace suture
