// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/multigrid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "kernel/solvers/conjugate_gradients.hpp"
#include "kernel/solvers/galerkin.hpp"
#include "tests/solvers/solver_body.hpp"

namespace suture::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// A slit through half of the body, along its height.
bool slit(const Vec3& a, const Vec3& b) {
  return std::min(a[0], b[0]) < 2 && std::max(a[0], b[0]) > 2 && std::min(a[2], b[2]) > 4;
}

Matrix dense(const Preconditioner& b, const TangentMatrix& a) {
  const auto size = static_cast<Eigen::Index>(a.size());
  Matrix result = Matrix::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    if (a.free()[static_cast<std::size_t>(i)])
      b.apply(Vector(Vector::Unit(size, i)).data(), result.col(i).data());
  return result;
}

Matrix dense(const TangentMatrix& a) {
  const auto size = static_cast<Eigen::Index>(a.size());
  Matrix result = Matrix::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    if (a.free()[static_cast<std::size_t>(i)])
      a.apply(Vector(Vector::Unit(size, i)).data(), result.col(i).data());
  return result;
}

Matrix dense(const Interpolation& p, Index coarse_nodes) {
  Matrix result = Matrix::Zero(p.fine_nodes() * 3, coarse_nodes * 3);
  for (Index v = 0; v < p.fine_nodes(); ++v)
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
      for (Index c = 0; c < 3; ++c) result(v * 3 + c, p.node[i] * 3 + c) = double{p.weight[i]};
  return result;
}

Matrix dense(const BlockRows<double>& a) {
  const BlockPattern& pattern = a.pattern();
  Matrix result = Matrix::Zero(pattern.rows() * 3, pattern.rows() * 3);
  for (Index row = 0; row < pattern.rows(); ++row)
    for (Index i = pattern.begin[row]; i < pattern.begin[row + 1]; ++i)
      result.block<3, 3>(row * 3, pattern.column[i] * 3) =
          Eigen::Map<const Eigen::Matrix3d>(a.block(i));
  return result;
}

unsigned iterations(SolverBody& body, double tolerance = 1e-8) {
  const auto multigrid = make_multigrid(body.complex(), body.attributes());
  multigrid->build(body.matrix());
  const std::vector<double> b = body.weight();
  std::vector<double> x(b.size());
  const LinearSolve solve =
      ConjugateGradients().solve(body.matrix(), *multigrid, b, x, tolerance, 500);
  EXPECT_EQ(solve.outcome, LinearSolve::Outcome::converged);
  return solve.iterations;
}

TEST(Multigrid, IsSymmetricAndPositiveDefinite) {
  SolverBody body(unit_box({4, 2, 8}), slit);
  const auto multigrid = make_multigrid(body.complex(), body.attributes(), {.coarsest_nodes = 20});
  multigrid->build(body.matrix());
  const Matrix b = dense(*multigrid, body.matrix());
  EXPECT_LT((b - b.transpose()).norm(), 1e-5 * b.norm());
  const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(b).eigenvalues();
  const auto held = std::ranges::count(body.matrix().free(), 0);
  EXPECT_GT(values[held], 1e-6 * values[values.size() - 1]);
}

TEST(Multigrid, CoarseOperatorsAreProjections) {
  for (const double mass : {0.0, 1e3}) {
    SolverBody body(unit_box({4, 2, 8}), slit);
    body.matrix().set(0, mass);
    const Coarsening one = coarsen(vertex_graph(body.complex(), body.attributes()));
    const Coarsening two = coarsen(one.coarse);
    const BlockPattern first = pattern_of(one.coarse), second = pattern_of(two.coarse);
    const BlockRows<double> coarse = project(body.matrix(), one.interpolation, first);
    const BlockRows<double> coarser = project(coarse, two.interpolation, second);
    const Matrix p = dense(one.interpolation, one.coarse.nodes());
    const Matrix expected = p.transpose() * dense(body.matrix()) * p;
    EXPECT_LT((dense(coarse) - expected).norm(), 1e-12 * expected.norm());
    const Matrix q = dense(two.interpolation, two.coarse.nodes());
    const Matrix next = q.transpose() * expected * q;
    EXPECT_LT((dense(coarser) - next).norm(), 1e-12 * next.norm());
  }
}

TEST(Multigrid, ASlitSeparatesCoarseNodes) {
  SolverBody whole(unit_box({4, 2, 8})), cut(unit_box({4, 2, 8}), slit);
  EXPECT_EQ(coarsen(vertex_graph(whole.complex(), whole.attributes())).coarse.nodes(), 3u * 2 * 5);
  // The slit opens above z = 4: two more nodes at z = 6 and at z = 8, on each of its sides.
  EXPECT_EQ(coarsen(vertex_graph(cut.complex(), cut.attributes())).coarse.nodes(), 3u * 2 * 5 + 4);
}

TEST(Multigrid, SolvesABeamInFewIterations) {
  SolverBody body(unit_box({10, 10, 40}));
  EXPECT_LE(iterations(body), 15u);
}

}  // namespace
}  // namespace suture::test
