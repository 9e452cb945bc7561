// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace suture {

/// The Ritz pairs of a symmetric operator A in the span of the columns of S.
struct Ritz {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< coefficients of the columns of S; S v are orthonormal

  /// `gram`: S^T S, `projected`: S^T A S. Directions that depend on the others to within 1e-10 are
  /// left out, so there may be fewer pairs than columns.
  Ritz(const Eigen::MatrixXd& gram, const Eigen::MatrixXd& projected);
};

}  // namespace suture
