// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/gmres.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

/// Vectors between restarts.
constexpr unsigned cycle_length = 40;

void add(double factor, std::span<const double> from, std::span<double> to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

}  // namespace

LinearSolve Gmres::solve(const TangentMatrix& a, const Preconditioner& preconditioner,
                         std::span<const double> b, std::span<double> x, double tolerance,
                         const IterationLimit& limit) {
  r_.assign(b.begin(), b.end());
  z_.resize(b.size());
  std::ranges::fill(x, 0.0);
  const double scale = norm(b), target = tolerance * scale;
  LinearSolve result;
  for (;;) {
    const double residual = norm(r_);
    if (!std::isfinite(residual)) throw NumericalError("the tangent is not finite");
    result.residual = scale > 0 ? residual / scale : 0;
    if (!(residual > target)) return result;
    if (result.iterations > 0 && limit.ends(result.iterations)) {
      result.outcome = LinearSolve::Outcome::too_many;
      return result;
    }
    const unsigned left = limit.iterations - result.iterations;
    result.iterations +=
        cycle(a, preconditioner, x, target, {std::min(left, cycle_length), limit.is_over});
    a.apply_whole(x.data(), r_.data());
    for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = b[i] - r_[i];
  }
}

/// Arnoldi's process on A B^-1 from the residual r, and the best correction of x in its space:
///   A B^-1 V = (V, v) H,   x += B^-1 V y   with   | |r| e_1 - H y | minimal
unsigned Gmres::cycle(const TangentMatrix& a, const Preconditioner& preconditioner,
                      std::span<double> x, double target, const IterationLimit& limit) {
  const double start = norm(r_);
  basis_.assign(1, r_);
  for (double& value : basis_[0]) value /= start;
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(limit.iterations + 1, limit.iterations);
  Eigen::VectorXd y;
  unsigned count = 0;
  double residual = start;
  while (residual > target && !limit.ends(count)) {
    std::vector<double> next(x.size());
    preconditioner.apply(basis_[count].data(), z_.data());
    a.apply_whole(z_.data(), next.data());
    for (unsigned i = 0; i <= count; ++i) {
      h(i, count) = dot(next, basis_[i]);
      add(-h(i, count), basis_[i], next);
    }
    const double length = norm(next);
    if (!std::isfinite(length)) throw NumericalError("the tangent is not finite");
    h(count + 1, count) = length;
    ++count;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count + 1);
    right[0] = start;
    const auto square = h.topLeftCorner(count + 1, count);
    y = square.householderQr().solve(right);
    residual = (square * y - right).norm();
    if (!(length > 0)) break;
    for (double& value : next) value /= length;
    basis_.push_back(std::move(next));
  }
  std::vector<double> sum(x.size());
  for (unsigned i = 0; i < count; ++i) add(y[i], basis_[i], sum);
  preconditioner.apply(sum.data(), z_.data());
  add(1, z_, x);
  basis_.clear();
  return count;
}

}  // namespace suture
