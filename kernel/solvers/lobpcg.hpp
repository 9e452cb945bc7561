// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace suture {

/// A symmetric operator A whose lowest eigenvalues are wanted.
class EigenProblem {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  using Result = Eigen::Ref<Eigen::VectorXd>;

  virtual ~EigenProblem() = default;
  /// y = A x.
  virtual void multiply(const Vector& x, Result y) = 0;
  /// z = T r, with T approximately the inverse of A; symmetric and positive definite.
  virtual void precondition(const Vector& r, Result z) = 0;
  /// The lowest Ritz value so far, before residuals are preconditioned. It may be negative, which
  /// T may have to take into account.
  virtual void adapt(double /*lowest*/) {}
};

struct EigenOptions {
  Eigen::Index count = 1;   ///< pairs that must converge
  double tolerance = 1e-4;  ///< of EigenPairs::residuals
  double zero = 0;          ///< eigenvalues with magnitudes up to this are zero within rounding
  unsigned max_iterations = 300;
};

struct EigenPairs {
  Eigen::VectorXd values;     ///< ascending
  Eigen::MatrixXd vectors;    ///< orthonormal
  Eigen::VectorXd residuals;  ///< sqrt(r.T r / max(|value|, zero)), r = A x - value x
  unsigned iterations = 0;
  bool converged = false;
};

/// The lowest eigenpairs by LOBPCG (Knyazev, SIAM J. Sci. Comput. 23 (2001) 517): Rayleigh-Ritz in
/// the span of the last approximations X, their preconditioned residuals W and the last directions
/// P. Pairs that have converged stay in X, but get no more W and P (soft locking).
///
/// With T close to the inverse of A, r.T r is the error of an eigenvalue, except for a factor
/// v / (v - value), where v is the lowest eigenvalue whose vector is not in X: a residual of 1e-4
/// means an eigenvalue to about 1e-8. Pairs that are zero converge when that error is below `zero`.
///
/// `start`: approximations, one column per pair and some more as guards; at most as many as there
/// are unknowns. Columns that depend on others are left out; if fewer than `count` remain, the
/// result is not converged. Memory: 10 times `start`. Deterministic.
class Lobpcg {
 public:
  Lobpcg(EigenProblem& problem, const EigenOptions& options, const Eigen::MatrixXd& start);

  EigenPairs solve();

  struct Iteration {
    unsigned number;
    Eigen::Index converged;  ///< pairs
    double lowest;           ///< Ritz value
    double residual;         ///< the largest of the first `count`
  };
  std::function<void(const Iteration&)> on_iteration;

 private:
  Eigen::Index precondition_residuals();
  bool needs_work(Eigen::Index pair, double residual_norm) const;
  bool is_converged(Eigen::Index pair, double error) const;
  void multiply(Eigen::Index first, Eigen::Index count);
  void orthogonalise(Eigen::Index first, Eigen::Index count);
  Eigen::Index append_directions(Eigen::Index column);
  void improve(Eigen::Index columns);
  double worst_residual() const;
  Eigen::Index converged_pairs() const;

  EigenProblem& problem_;
  const EigenOptions options_;
  Eigen::Index pairs_;
  Eigen::MatrixXd basis_, images_;                 ///< [X W P] and A times it
  Eigen::MatrixXd directions_, direction_images_;  ///< P of all pairs
  Eigen::VectorXd values_, residuals_;
  Eigen::VectorXd locked_;             ///< |r| when the pair converged; 0: it has not
  std::vector<Eigen::Index> working_;  ///< pairs that have a column in W
};

}  // namespace suture
