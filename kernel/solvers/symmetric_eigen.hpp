// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace suture {

/// Eigenpairs of a small dense symmetric matrix. Eigen's solver takes 8 s to compile: it is
/// compiled here only.
struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< column k belongs to value k
};

/// A x = lambda x; O(n^3). Only the lower triangle of `a` is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// The same without the vectors.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

/// A x = lambda B x with B positive definite; x^T B x = 1.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace suture
