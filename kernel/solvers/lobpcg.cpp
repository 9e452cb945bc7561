// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/lobpcg.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/solvers/ritz.hpp"

namespace suture {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using EigenIndex = Eigen::Index;
using Columns = Eigen::Ref<const MatrixXd>;

/// A^T B, which is symmetric.
MatrixXd symmetric_product(const Columns& a, const Columns& b) {
  MatrixXd product = MatrixXd::Zero(a.cols(), a.cols());
  product.triangularView<Eigen::Lower>() = a.transpose() * b;
  return product.selfadjointView<Eigen::Lower>();
}

}  // namespace

Lobpcg::Lobpcg(EigenProblem& problem, const EigenOptions& options, const MatrixXd& start)
    : problem_(problem),
      options_(options),
      pairs_(start.cols()),
      basis_(start.rows(), 3 * start.cols()),
      images_(start.rows(), 3 * start.cols()) {
  basis_.leftCols(pairs_) = start;
}

void Lobpcg::multiply(EigenIndex first, EigenIndex count) {
  for (EigenIndex i = first; i < first + count; ++i) {
    problem_.multiply(basis_.col(i), images_.col(i));
    if (!std::isfinite(images_.col(i).squaredNorm()))
      throw NumericalError("the tangent is not finite");
  }
}

/// Against X, and normalises; so that the projected problem stays well conditioned.
void Lobpcg::orthogonalise(EigenIndex first, EigenIndex count) {
  auto columns = basis_.middleCols(first, count);
  const auto x = basis_.leftCols(pairs_);
  const MatrixXd amounts = x.transpose() * columns;
  columns.noalias() -= x * amounts;
  for (EigenIndex i = 0; i < count; ++i)
    if (const double length = columns.col(i).norm(); length > 0) columns.col(i) /= length;
}

bool Lobpcg::needs_work(EigenIndex pair, double residual_norm) const {
  return locked_[pair] == 0 || residual_norm > 2 * locked_[pair];
}

bool Lobpcg::is_converged(EigenIndex pair, double error) const {
  const double value = std::abs(values_[pair]), tolerance = options_.tolerance;
  return error <= (value <= options_.zero ? options_.zero : tolerance * tolerance * value);
}

/// W of the pairs that have not converged; returns their number.
EigenIndex Lobpcg::precondition_residuals() {
  working_.clear();
  for (EigenIndex i = 0; i < pairs_; ++i) {
    const VectorXd residual = images_.col(i) - values_[i] * basis_.col(i);
    const double norm = residual.norm();
    if (!needs_work(i, norm)) continue;
    const EigenIndex column = pairs_ + static_cast<EigenIndex>(working_.size());
    problem_.precondition(residual, basis_.col(column));
    const double error = std::max(residual.dot(basis_.col(column)), 0.0);
    residuals_[i] = std::sqrt(error / std::max({std::abs(values_[i]), options_.zero, 1e-300}));
    locked_[i] = is_converged(i, error) ? std::max(norm, 1e-300) : 0;
    if (locked_[i] == 0) working_.push_back(i);
  }
  return static_cast<EigenIndex>(working_.size());
}

EigenIndex Lobpcg::append_directions(EigenIndex column) {
  if (directions_.cols() == 0) return 0;
  for (const EigenIndex pair : working_) {
    basis_.col(column) = directions_.col(pair);
    images_.col(column++) = direction_images_.col(pair);
  }
  return static_cast<EigenIndex>(working_.size());
}

/// The lowest Ritz vectors in the span of the first `columns` become X, and their parts outside of
/// the last X become P.
void Lobpcg::improve(EigenIndex columns) {
  const auto basis = basis_.leftCols(columns), images = images_.leftCols(columns);
  const Ritz ritz(symmetric_product(basis, basis), symmetric_product(basis, images));
  const bool first = values_.size() == 0;
  const EigenIndex old = first ? 0 : pairs_;
  pairs_ = std::min(pairs_, ritz.values.size());
  values_ = ritz.values.head(pairs_);
  const MatrixXd best = ritz.vectors.leftCols(pairs_);
  directions_ = basis.rightCols(columns - old) * best.bottomRows(columns - old);
  direction_images_ = images.rightCols(columns - old) * best.bottomRows(columns - old);
  const MatrixXd kept = basis.leftCols(old) * best.topRows(old);
  const MatrixXd kept_images = images.leftCols(old) * best.topRows(old);
  basis_.leftCols(pairs_) = directions_ + kept;
  images_.leftCols(pairs_) = direction_images_ + kept_images;
  if (!first) return;
  directions_.resize(basis_.rows(), 0);
  residuals_ = VectorXd::Constant(pairs_, std::numeric_limits<double>::infinity());
  locked_ = VectorXd::Zero(pairs_);
}

double Lobpcg::worst_residual() const {
  const EigenIndex count = std::min(options_.count, pairs_);
  return count > 0 ? residuals_.head(count).maxCoeff() : 0;
}

EigenIndex Lobpcg::converged_pairs() const {
  EigenIndex count = 0;
  while (count < std::min(options_.count, pairs_) && locked_[count] > 0) ++count;
  return count;
}

EigenPairs Lobpcg::solve() {
  multiply(0, pairs_);
  improve(pairs_);
  EigenPairs result;
  for (;; ++result.iterations) {
    if (pairs_ > 0) problem_.adapt(values_[0]);
    const EigenIndex working = precondition_residuals();
    const EigenIndex converged = converged_pairs();
    if (on_iteration && pairs_ > 0)
      on_iteration({result.iterations, converged, values_[0], worst_residual()});
    result.converged = converged == options_.count;
    const bool can_converge = pairs_ >= options_.count;
    if (result.converged || !can_converge || result.iterations == options_.max_iterations) break;
    orthogonalise(pairs_, working);
    multiply(pairs_, working);
    improve(pairs_ + working + append_directions(pairs_ + working));
  }
  const EigenIndex count = std::min(options_.count, pairs_);
  result.values = values_.head(count);
  result.vectors = basis_.leftCols(count);
  result.residuals = residuals_.head(count);
  return result;
}

}  // namespace suture
