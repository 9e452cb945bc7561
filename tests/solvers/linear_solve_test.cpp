// SPDX-License-Identifier: GPL-3.0-or-later
//
// The matrix of a Newton step, in products and cell by cell, and conjugate gradients on it.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <random>

#include "kernel/build/built_scene.hpp"
#include "kernel/solvers/block_jacobi.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// A clamped beam of 8 x 2 x 2 elements of one model, moved at random by `part` of 5 cm, with its
/// matrix.
struct System {
  System(const char* model, double part, double mass = 0)
      : scene(beam(tree_plugins(), model, 8, 2, 9.8)),
        built(scene, ignored, true),
        matrix(built.body().attributes(), built.body().terms(), built.body().models().workers()) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-part * 0.05, part * 0.05);
    Attributes& attributes = built.body().attributes();
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        if (attributes.fixed().get(v, 0) == 0)
          attributes.position().set(v, c, attributes.position().get(v, c) + shift(random));
    matrix.set(0, mass);
  }
  std::vector<double> load() const {
    std::mt19937 random(11);
    std::normal_distribution<double> value;
    std::vector<double> b(matrix.size());
    for (double& x : b) x = value(random);
    matrix.restrict(b);
    return b;
  }

  Diagnostics ignored;
  Scene scene;
  BuiltScene built;
  TangentMatrix matrix;
};

Vector product(const TangentMatrix& a, const Vector& x) {
  Vector y(x.size());
  a.apply(x.data(), y.data());
  return y;
}

Matrix by_products(const TangentMatrix& a) {
  const auto size = static_cast<Eigen::Index>(a.size());
  Matrix result(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    result.col(i) = a.free()[static_cast<std::size_t>(i)] ? product(a, Vector::Unit(size, i))
                                                          : Vector::Zero(size);
  return result;
}

Matrix by_cells(const TangentMatrix& a) {
  const auto size = static_cast<Eigen::Index>(a.size());
  Matrix result = Matrix::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) result(i, i) = a.mass_at(static_cast<Index>(i / 3));
  a.for_each_cell([&](const CellTangents& cells) {
    const Index rows = cells.nodes * 3;
    const auto place = [&](Index cell, Index row) {
      return Eigen::Index{cells.vertices[cell * cells.nodes + row / 3]} * 3 + row % 3;
    };
    for (Index l = 0; l < cells.cells; ++l)
      for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < rows; ++j)
          result(place(l, i), place(l, j)) -= cells.values[(j * rows + i) * 8 + l];
  });
  for (Eigen::Index i = 0; i < size; ++i)
    if (!a.free()[static_cast<std::size_t>(i)]) result.row(i).setZero(), result.col(i).setZero();
  return result;
}

class LinearSolves : public testing::TestWithParam<const char*> {};

TEST_P(LinearSolves, CellMatricesAddUpToTheProducts) {
  const System system(GetParam(), 0.1, 1e4);
  const Matrix products = by_products(system.matrix), cells = by_cells(system.matrix);
  EXPECT_LT((products - cells).norm(), 1e-12 * products.norm());
  EXPECT_LT((products - products.transpose()).norm(), 1e-12 * products.norm());
}

TEST_P(LinearSolves, ConjugateGradientsFindTheSolutionOfADenseSolver) {
  const System system(GetParam(), 0.02);
  const std::vector<double> b = system.load();
  std::vector<double> x(b.size());
  const auto preconditioner = make_block_jacobi();
  preconditioner->build(system.matrix);
  const LinearSolve solve =
      ConjugateGradients().solve(system.matrix, *preconditioner, b, x, 1e-10, 1000);
  EXPECT_EQ(solve.outcome, LinearSolve::Outcome::converged);
  EXPECT_LE(solve.residual, 1e-10);
  Matrix dense = by_products(system.matrix);
  for (Eigen::Index i = 0; i < dense.rows(); ++i)
    if (!system.matrix.free()[static_cast<std::size_t>(i)]) dense(i, i) = 1;
  const Vector exact =
      dense.llt().solve(Eigen::Map<const Vector>(b.data(), static_cast<Eigen::Index>(b.size())));
  const Eigen::Map<const Vector> found(x.data(), static_cast<Eigen::Index>(x.size()));
  EXPECT_LT((found - exact).norm(), 1e-7 * exact.norm());
}

TEST_P(LinearSolves, AllowedIterationsAreNotExceeded) {
  const System system(GetParam(), 0);
  const std::vector<double> b = system.load();
  std::vector<double> x(b.size());
  const auto preconditioner = make_block_jacobi();
  preconditioner->build(system.matrix);
  const LinearSolve solve =
      ConjugateGradients().solve(system.matrix, *preconditioner, b, x, 1e-10, 5);
  EXPECT_EQ(solve.outcome, LinearSolve::Outcome::too_many);
  EXPECT_EQ(solve.iterations, 5u);
  EXPECT_GT(dot(b, x), 0);
}

/// A beam that is compressed to 60 % of its length buckles.
TEST_P(LinearSolves, NegativeCurvatureEndsWithADescentDirection) {
  System system(GetParam(), 0);
  Attributes& attributes = system.built.body().attributes();
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    attributes.position().set(v, 0, 0.6 * attributes.position().get(v, 0));
  const std::vector<double> b = system.load();
  std::vector<double> x(b.size());
  const auto preconditioner = make_block_jacobi();
  preconditioner->build(system.matrix);
  ConjugateGradients solver;
  const LinearSolve solve = solver.solve(system.matrix, *preconditioner, b, x, 1e-10, 1000);
  EXPECT_EQ(solve.outcome, LinearSolve::Outcome::indefinite);
  EXPECT_GT(dot(b, x), 0);
  const Eigen::SelfAdjointEigenSolver<Matrix> dense(by_products(system.matrix),
                                                    Eigen::EigenvaluesOnly);
  EXPECT_LT(dense.eigenvalues()[0], 0);
}

INSTANTIATE_TEST_SUITE_P(Models, LinearSolves, testing::Values("tm-faure", "mss-baudet"),
                         [](const auto& test) {
                           return std::string(test.param).starts_with("tm") ? "tm" : "mss";
                         });

}  // namespace
}  // namespace suture::test
