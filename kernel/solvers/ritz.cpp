// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/ritz.hpp"

#include "kernel/solvers/symmetric_eigen.hpp"

namespace suture {

using Eigen::MatrixXd, Eigen::VectorXd;

Ritz::Ritz(const MatrixXd& gram, const MatrixXd& projected) {
  constexpr double dependent = 1e-10;
  const VectorXd diagonal = gram.diagonal();
  VectorXd unit = VectorXd::Zero(diagonal.size());
  for (Eigen::Index i = 0; i < unit.size(); ++i)
    if (diagonal[i] > 0) unit[i] = 1 / std::sqrt(diagonal[i]);
  const MatrixXd scaled = unit.asDiagonal() * gram * unit.asDiagonal();
  const SymmetricEigen basis = symmetric_eigen(scaled);
  Eigen::Index first = 0;
  while (first < unit.size() && !(basis.values[first] > dependent)) ++first;
  const Eigen::Index kept = unit.size() - first;
  if (kept == 0) return;
  const MatrixXd orthonormal = unit.asDiagonal() * basis.vectors.rightCols(kept) *
                               basis.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const MatrixXd small = orthonormal.transpose() * projected * orthonormal;
  const SymmetricEigen reduced = symmetric_eigen((small + small.transpose()) / 2);
  values = reduced.values;
  vectors = orthonormal * reduced.vectors;
}

}  // namespace suture
