// SPDX-License-Identifier: GPL-3.0-or-later
//
// Packs against doubles lane by lane. Built once per width; the widths that are
// no register here are emulated by the compiler and must give the same.
#include <gtest/gtest.h>

#include <random>

#include "suture/kinematics.hpp"
#include "suture/spectral.hpp"

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
  return 1.0 / (1 + x * x) + 2 * sqrt(x) - x / 3 + exp(x) * rsqrt(x) + log(x) * 0.5 +
         log1p(x) * expm1(x) + pow(x, 1.5) + cbrt(x) * sin(x) - cos(2 * x) / x + tanh(x) +
         max(x, T(2.0)) * min(x, T(1.0)) + abs(-x) + select(x > T(1.0), x, x * x) +
         (3 - x) * (x - 1) / (x + 4);
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

// ------------------------------------------------------------------ reverse --

suture::mat3<double> near_identity(std::mt19937& engine) {
  std::uniform_real_distribution<> uniform(-0.2, 0.2);
  auto F = suture::mat3<double>::identity();
  for (int i = 0; i < 9; ++i) F(i / 3, i % 3) += uniform(engine);
  return F;
}

/// Uses every operation of a tape; the logarithm of a negative number is not selected.
template <class T>
T energy_of_everything(const suture::mat3<T>& F) {
  using namespace suture;
  const T J = det(F), trace_of_c = dot(F, F);
  T sum = everything(J) + tanh(F(0, 1)) / (2.0 - J);
  sum += select(F(1, 1) > 5.0, log(F(1, 1) - 5.0), trace_of_c * reciprocal(J));
  return sum * 0.5 - 1.0 / trace_of_c + (4.0 - trace_of_c) / 3.0;
}

TEST(Reverse, GivesTheGradientOfNineDuals) {
  std::mt19937 engine(4);
  const auto W = [](const auto& G) __attribute__((always_inline)) {
    return energy_of_everything(G);
  };
  for (int round = 0; round < 20; ++round) {
    const auto F = near_identity(engine), P = suture::detail::gradient_by_duals(F, W);
    suture::detail::tape<double> notes;
    const auto result = W(suture::detail::inputs_of(notes, F));
    ASSERT_LE(notes.size, notes.capacity);
    EXPECT_NEAR(result.value, W(F), 1e-13);
    const auto by_tape = gradient_of(notes, result);
    EXPECT_GT(std::abs(P(0, 0)), 0.1);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(by_tape(i / 3, i % 3), P(i / 3, i % 3), 1e-12) << i;
  }
}

TEST(Reverse, OfDualsGivesTheTangent) {
  std::mt19937 engine(5);
  const auto W = [](const auto& G) __attribute__((always_inline)) {
    return energy_of_everything(G);
  };
  const auto F = near_identity(engine), direction = near_identity(engine);
  suture::mat3<dual<double>> G;
  for (int i = 0; i < 9; ++i) G(i / 3, i % 3) = {F(i / 3, i % 3), direction(i / 3, i % 3)};
  suture::detail::tape<dual<double>> notes;
  const auto result = W(suture::detail::inputs_of(notes, G));
  const auto P = gradient_of(notes, result);
  const double h = 1e-6;
  const auto up = suture::detail::gradient_by_duals(F + direction * h, W),
             down = suture::detail::gradient_by_duals(F - direction * h, W);
  for (int i = 0; i < 9; ++i)
    EXPECT_NEAR(P(i / 3, i % 3).derivative, (up(i / 3, i % 3) - down(i / 3, i % 3)) / (2 * h),
                1e-6);
}

/// det(F) F_00^n
template <class T, std::size_t... I>
SUTURE_INLINE T power_of(const suture::mat3<T>& F, std::index_sequence<I...>) {
  T power = det(F);
  (((void)I, power *= F(0, 0)), ...);
  return power;
}

TEST(Reverse, FallsBackToDualsBeyondTheCapacityOfTheTape) {
  std::mt19937 engine(6);
  const auto F = near_identity(engine);
  const auto W = [](const auto& G) __attribute__((always_inline)) {
    return power_of(G, std::make_index_sequence<200>());
  };
  const auto P = suture::gradient(F, W), Q = suture::detail::gradient_by_duals(F, W);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(P(i / 3, i % 3), Q(i / 3, i % 3));
  const auto none = suture::gradient(
      F, [](const auto& G)
             __attribute__((always_inline)) { return std::decay_t<decltype(G(0, 0))>(3.0); });
  for (int i = 0; i < 9; ++i) EXPECT_EQ(none(i / 3, i % 3), 0);
}

// -------------------------------------------------------------- kinematics --

using Matrix = suture::mat3<double>;

/// F + d eps
suture::mat3<dual<double>> along(const Matrix& F, const Matrix& d) {
  suture::mat3<dual<double>> G;
  for (int i = 0; i < 9; ++i) G(i / 3, i % 3) = {F(i / 3, i % 3), d(i / 3, i % 3)};
  return G;
}
double largest(const Matrix& A) {
  double size = 0;
  for (int i = 0; i < 9; ++i) size = std::max(size, std::abs(A(i / 3, i % 3)));
  return size;
}

TEST(Kinematics, TheRotationOfAPolarDecompositionLeavesASymmetricStretch) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<> uniform(-1, 1);
  for (int round = 0; round < 200; ++round) {
    Matrix F, d = near_identity(engine);
    do
      for (int i = 0; i < 9; ++i) F(i / 3, i % 3) = uniform(engine);
    while (det(F) < 0.01);
    const Matrix R = polar_rotation(F), U = transpose(R) * F;
    EXPECT_LT(largest(transpose(R) * R - Matrix::identity()), 1e-14);
    EXPECT_LT(largest(U - transpose(U)), 1e-14);
    EXPECT_GT(trace(U), 0);
    const double h = 1e-6;
    const Matrix slope = (polar_rotation(F + d * h) - polar_rotation(F - d * h)) * (0.5 / h);
    const auto with_derivative = polar_rotation(along(F, d));
    for (int i = 0; i < 9; ++i)
      EXPECT_NEAR(with_derivative(i / 3, i % 3).derivative, slope(i / 3, i % 3),
                  1e-6 * (1 + largest(slope)));
  }
}

TEST(Kinematics, RotationsInAPackDoNotDependOnTheirNeighbours) {
  std::mt19937 engine(8);
  using suture::native;
  suture::mat3<native> F;
  Matrix lanes[suture::native_lanes];
  for (int l = 0; l < suture::native_lanes; ++l) {
    lanes[l] = near_identity(engine) * (l == 0 ? 50.0 : 1.0);
    for (int i = 0; i < 9; ++i) F(i / 3, i % 3).v[l] = lanes[l](i / 3, i % 3);
  }
  const auto R = polar_rotation(F);
  for (int l = 0; l < suture::native_lanes; ++l) {
    suture::mat3<native> alone;
    for (int i = 0; i < 9; ++i) alone(i / 3, i % 3) = lanes[l](i / 3, i % 3);
    const auto Q = polar_rotation(alone);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(R(i / 3, i % 3)[l], Q(i / 3, i % 3)[l]);
  }
}

TEST(Kinematics, InvariantsHaveTheirDerivatives) {
  std::mt19937 engine(9);
  const Matrix F = near_identity(engine), d = near_identity(engine);
  const auto at = invariants(F);
  const auto moved = invariants(along(F, d));
  const auto C = right_cauchy_green(F);
  EXPECT_NEAR(at.I2, (trace(C) * trace(C) - dot(C, C)) / 2, 1e-14);
  EXPECT_NEAR(moved.I1.derivative, dot(gradient_of_I1(F), d), 1e-13);
  EXPECT_NEAR(moved.I2.derivative, dot(gradient_of_I2(F), d), 1e-13);
  EXPECT_NEAR(moved.J.derivative, dot(gradient_of_J(F), d), 1e-13);
  const auto shape = isochoric(at), same = invariants(isochoric(F));
  EXPECT_NEAR(same.J, 1, 1e-14);
  EXPECT_NEAR(shape.I1, same.I1, 1e-14);
  EXPECT_NEAR(shape.I2, same.I2, 1e-14);
}

/// Against long double, whose rounding is 1e-19.
TEST(Kinematics, ExcessOfInvariantsKeepsItsDigitsNearRest) {
  std::mt19937 engine(19);
  std::uniform_real_distribution<> uniform(-1, 1);
  for (int round = 0; round < 200; ++round) {
    const double strain = round == 0 ? 0 : std::pow(10, -12.0 * round / 200);
    Matrix F = Matrix::identity();
    suture::mat3<long double> exact;
    for (int i = 0; i < 9; ++i) {
      F(i / 3, i % 3) += 0.3 * strain * uniform(engine);
      exact(i / 3, i % 3) = F(i / 3, i % 3);
    }
    const auto e = excess_invariants(F), shape = isochoric(e);
    EXPECT_EQ(excess_I1(F), e.I1);
    EXPECT_NEAR(excess_J(F), e.J, 1e-15 * strain);
    const auto at = invariants(exact);
    const long double scale = std::pow(at.J, -2 / 3.0L);
    const double allowed = 5e-15 * strain + 5e-18;
    EXPECT_NEAR(e.I1, double(at.I1 - 3), allowed) << strain;
    EXPECT_NEAR(e.I2, double(at.I2 - 3), allowed) << strain;
    EXPECT_NEAR(e.J, double(at.J - 1), allowed) << strain;
    EXPECT_NEAR(shape.I1, double(scale * at.I1 - 3), allowed) << strain;
    EXPECT_NEAR(shape.I2, double(scale * scale * at.I2 - 3), allowed) << strain;
    if (strain == 0) {
      EXPECT_EQ(std::abs(e.I1) + std::abs(e.I2) + std::abs(e.J), 0);
    }
  }
}

TEST(Spectral, DecompositionsGiveTheMatrixAgain) {
  std::mt19937 engine(10);
  std::uniform_real_distribution<> uniform(-1, 1);
  for (int round = 0; round < 200; ++round) {
    suture::sym3<double> A;
    for (double& a : A.c) a = round < 50 ? std::round(2 * uniform(engine)) : uniform(engine);
    const auto e = eigen(A);
    const auto again = suture::detail::recomposed(e.vectors, e.values);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(again.c[i], A.c[i], 1e-14);
    EXPECT_LT(largest(transpose(e.vectors) * e.vectors - Matrix::identity()), 1e-14);
  }
}

TEST(Spectral, FunctionsHaveTheirDerivativesAlsoWhereEigenvaluesCoincide) {
  std::mt19937 engine(11);
  for (const double gap : {0.0, 1e-9, 1e-5, 3e-5, 0.1}) {
    const suture::sym3<double> A{2 + gap, 2, 2 - 0.7 * gap, 0.1 * gap, -0.2 * gap, 0.3 * gap};
    const auto d = symmetric(near_identity(engine));
    suture::sym3<dual<double>> moving;
    for (int i = 0; i < 6; ++i) moving.c[i] = {A.c[i], d.c[i]};
    const double h = 1e-4;
    const auto up = log(A + d * h), down = log(A - d * h), up2 = log(A + d * (2 * h)),
               down2 = log(A - d * (2 * h)), back = exp(log(A)), root = sqrt(A);
    const auto result = log(moving);
    const auto square = symmetric(full(root) * full(root));
    for (int i = 0; i < 6; ++i) {
      EXPECT_NEAR(back.c[i], A.c[i], 1e-14);
      EXPECT_NEAR(square.c[i], A.c[i], 1e-14);
      EXPECT_NEAR(result.c[i].derivative,
                  (8 * (up.c[i] - down.c[i]) - (up2.c[i] - down2.c[i])) / (12 * h), 2e-10)
          << gap;
    }
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
