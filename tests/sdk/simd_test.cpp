// SPDX-License-Identifier: GPL-3.0-or-later
//
// Packs against doubles lane by lane. Built once per width; the widths that are
// no register here are emulated by the compiler and must give the same.
#include <gtest/gtest.h>

#include <random>

#include "suture/dual.hpp"
#include "suture/tensor.hpp"

namespace {

using suture::dual;
using suture::pack;

template <class Pack>
class Packs : public testing::Test {
 protected:
  static constexpr int n = suture::lanes_of<Pack>;
  /// Lanes of any sign and magnitude 1e-100 .. 1e100.
  Pack random() {
    typename Pack::vector v;
    for (int i = 0; i < n; ++i)
      v[i] = (engine() & 1 ? 1 : -1) *
             std::pow(10, std::uniform_real_distribution<>(-100, 100)(engine));
    return v;
  }
  std::mt19937_64 engine{7};
};
using Widths = testing::Types<pack<2>, pack<4>, pack<8>>;
TYPED_TEST_SUITE(Packs, Widths);

TYPED_TEST(Packs, ActLaneByLane) {
  for (int round = 0; round < 100; ++round) {
    const TypeParam a = this->random(), b = this->random();
    const auto larger = max(a, b), smaller = min(a, b), chosen = select(a < b, a + b, a * b);
    for (int i = 0; i < this->n; ++i) {
      EXPECT_EQ((a / b)[i], a[i] / b[i]);
      EXPECT_EQ((2.0 - a)[i], 2 - a[i]);
      EXPECT_EQ(larger[i], std::max(a[i], b[i]));
      EXPECT_EQ(smaller[i], std::min(a[i], b[i]));
      EXPECT_EQ(abs(a)[i], std::abs(a[i]));
      EXPECT_EQ(sqrt(abs(a))[i], std::sqrt(std::abs(a[i])));
      EXPECT_EQ(chosen[i], a[i] < b[i] ? a[i] + b[i] : a[i] * b[i]);
    }
    EXPECT_EQ(any(a < b), !all(a >= b));
  }
}

TYPED_TEST(Packs, ReciprocalsAreGoodToTwoUnitsInTheLastPlace) {
  double worst_root = 0, worst = 0;
  for (int round = 0; round < 20000; ++round) {
    const TypeParam x = abs(this->random()), r = rsqrt(x), q = reciprocal(x);
    for (int i = 0; i < this->n; ++i) {
      worst_root = std::max<double>(worst_root, std::abs(r[i] * std::sqrt((long double)x[i]) - 1));
      worst = std::max<double>(worst, std::abs(q[i] * (long double)x[i] - 1));
    }
  }
  EXPECT_LE(worst_root, 4.5e-16);
  EXPECT_LE(worst, 4.5e-16);
}

TYPED_TEST(Packs, NonFiniteLanesStayNonFiniteAndAlone) {
  typename TypeParam::vector v{};
  for (int i = 0; i < this->n; ++i) v[i] = i + 1;
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    auto w = v;
    w[1] = bad;
    const TypeParam x(w), r = rsqrt(x), sum = x + x;
    EXPECT_FALSE(std::isfinite(sum[1]));
    EXPECT_FALSE(std::isfinite(r[1]) && std::isnan(bad));
    EXPECT_TRUE(any(sum - sum != 0.0));
    EXPECT_NEAR(r[0], 1, 1e-15);
  }
  EXPECT_FALSE(any(TypeParam(v) - TypeParam(v) != 0.0));
}

// ------------------------------------------------------------- dual numbers --

/// Every function that dual numbers know.
template <class T>
T everything(T x) {
  using namespace suture;  // for T = double; other types find these by themselves
  return 1.0 / (1 + x * x) + 2 * sqrt(x) - x / 3 + exp(x) * rsqrt(x) + log(x) * 0.5 + pow(x, 1.5) +
         cbrt(x) * sin(x) - cos(2 * x) / x + tanh(x) + max(x, T(2.0)) * min(x, T(1.0)) + abs(-x) +
         select(x > T(1.0), x, x * x) + (3 - x) * (x - 1) / (x + 4);
}

TEST(DualNumbers, GiveTheDerivative) {
  for (const double x : {0.3, 0.9, 1.4, 2.7}) {
    const double h = 1e-6, difference = (everything(x + h) - everything(x - h)) / (2 * h);
    const double exact = everything(dual<double>(x, 1.0)).derivative;
    EXPECT_GT(std::abs(exact), 0.1);
    EXPECT_NEAR(exact, difference, 1e-8);
    const auto packed = everything(dual<suture::native>(suture::native(x), suture::native(1.0)));
    EXPECT_NEAR(packed.derivative[0], exact, 1e-13);
  }
}

TEST(DualNumbers, NestToSecondDerivatives) {
  const auto first = [](double x) { return everything(dual<double>(x, 1.0)).derivative; };
  for (const double x : {0.3, 0.9, 1.4, 2.7}) {
    const double h = 1e-6;
    using Second = dual<dual<double>>;
    const Second y = everything(Second(dual<double>(x, 1.0), dual<double>(1.0, 0.0)));
    EXPECT_NEAR(y.derivative.derivative, (first(x + h) - first(x - h)) / (2 * h), 1e-6);
  }
}

TEST(Tensors, KeepTheirIdentities) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<> uniform(-1, 1);
  suture::mat3<double> A, B;
  for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = uniform(engine), B(i / 3, i % 3) = uniform(engine);
  EXPECT_NEAR(det(A * B), det(A) * det(B), 1e-14);
  EXPECT_NEAR(dot(A, B), trace(transpose(A) * B), 1e-14);
  const auto I = A * inverse(A);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(I(i / 3, i % 3), i % 4 ? 0 : 1, 1e-13);
  // d det(A)/dA_ij is the cofactor.
  suture::mat3<dual<double>> D;
  for (int i = 0; i < 9; ++i) D(i / 3, i % 3) = A(i / 3, i % 3);
  D(1, 2).derivative = 1;
  EXPECT_NEAR(det(D).derivative, cofactor(A)(1, 2), 1e-14);
  const auto E = green_strain(A);
  const auto C = transpose(A) * A;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(2 * E(i, j) + (i == j), C(i, j), 1e-14);
  // von Mises of a uniaxial stress is that stress; of a pressure, zero.
  EXPECT_NEAR(von_mises(suture::sym3<double>{{-5, 0, 0, 0, 0, 0}}), 5, 1e-14);
  EXPECT_NEAR(von_mises(suture::sym3<double>{{2, 2, 2, 0, 0, 0}}), 0, 1e-14);
}

}  // namespace
