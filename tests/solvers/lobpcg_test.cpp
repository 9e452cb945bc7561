// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/lobpcg.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"

namespace suture::test {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// A diagonal matrix; T is its inverse, up to a factor that varies from row to row by `spread`.
class Diagonal final : public EigenProblem {
 public:
  explicit Diagonal(VectorXd values, double spread = 1)
      : values_(std::move(values)), spread_(spread) {}
  void multiply(const Vector& x, Result y) override { y = values_.cwiseProduct(x); }
  void precondition(const Vector& r, Result z) override {
    for (Eigen::Index i = 0; i < r.size(); ++i)
      z[i] = r[i] / (std::abs(values_[i]) + 0.1) * (i % 3 == 1 ? spread_ : 1);
  }

 private:
  VectorXd values_;
  double spread_;
};

/// 1, 2, 3, ...
VectorXd counting(Eigen::Index n) { return VectorXd::LinSpaced(n, 1, static_cast<double>(n)); }

MatrixXd start_of(Eigen::Index n, Eigen::Index columns) {
  std::srand(1);
  return MatrixXd::Random(n, columns);
}

TEST(Lobpcg, FindsNegativeZeroAndMultipleEigenvalues) {
  VectorXd values = counting(400);
  values[17] = -2;
  values[200] = 0;
  values[300] = values[301] = 0.5;
  Diagonal problem(values, 3);
  const EigenPairs pairs =
      Lobpcg(problem, {.count = 5, .zero = 1e-9}, start_of(values.size(), 9)).solve();
  ASSERT_TRUE(pairs.converged);
  const double expected[] = {-2, 0, 0.5, 0.5, 1};
  for (Eigen::Index i = 0; i < 5; ++i)
    EXPECT_NEAR(pairs.values[i], expected[i], 1e-7) << pairs.iterations;
  EXPECT_NEAR(std::abs(pairs.vectors(17, 0)), 1, 1e-6);
  EXPECT_LT((pairs.vectors.transpose() * pairs.vectors - MatrixXd::Identity(5, 5)).norm(), 1e-9);
}

TEST(Lobpcg, LeavesDependentStartVectorsOut) {
  MatrixXd start = start_of(100, 8);
  start.col(3) = start.col(1);
  start.col(6) = 2 * start.col(0) - start.col(2);
  start.col(7).setZero();
  Diagonal problem(counting(100));
  const EigenPairs pairs = Lobpcg(problem, {.count = 3}, start).solve();
  ASSERT_TRUE(pairs.converged);
  for (Eigen::Index i = 0; i < 3; ++i)
    EXPECT_NEAR(pairs.values[i], static_cast<double>(i) + 1, 1e-6);
}

TEST(Lobpcg, ReportsThatItDidNotConverge) {
  Diagonal problem(counting(400), 10);
  EigenOptions options;
  options.count = 5;
  options.max_iterations = 2;
  Lobpcg solver(problem, options, start_of(400, 9));
  unsigned reported = 0;
  solver.on_iteration = [&](const Lobpcg::Iteration& i) {
    EXPECT_EQ(i.number, reported++);
    EXPECT_LT(i.converged, 5);
  };
  const EigenPairs pairs = solver.solve();
  EXPECT_FALSE(pairs.converged);
  EXPECT_EQ(pairs.iterations, 2u);
  EXPECT_EQ(reported, 3u);
  EXPECT_GT(pairs.residuals.maxCoeff(), options.tolerance);
}

TEST(Lobpcg, AMatrixThatIsNotFiniteIsANumericalError) {
  VectorXd values = counting(50);
  values[30] = std::nan("");
  Diagonal problem(values);
  EXPECT_THROW(Lobpcg(problem, {.count = 2}, start_of(50, 4)).solve(), NumericalError);
}

}  // namespace
}  // namespace suture::test
