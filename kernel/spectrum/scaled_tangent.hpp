// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// Numbers in [-0.5, 0.5), the same on every machine.
class Random {
 public:
  double operator()() { return (engine_() - 2147483648.0) / 4294967296.0; }

 private:
  std::mt19937 engine_;
};

/// The operator y -> M^-1/2 K M^-1/2 y on the free components of a body about its present state,
/// where K = -df/dx is the symmetric part of the tangent of all terms. Its
/// eigenvalues are those of K u = w^2 M u, with y = sqrt(m) u. Vectors have 3 numbers per vertex, 0
/// for other components. Needs body.models().has_tangent().
class ScaledTangent {
 public:
  ScaledTangent(Body& body, double time);

  Eigen::Index size() const { return static_cast<Eigen::Index>(scale_.size()); }
  /// 1 / sqrt(m) per component, 0 if it is not free.
  const std::vector<double>& scale() const { return scale_; }
  Eigen::Index unknowns() const;  ///< free components
  unsigned products() const { return products_; }

  void multiply(const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::Ref<Eigen::VectorXd> image);
  Eigen::VectorXd operator()(const Eigen::Ref<const Eigen::VectorXd>& y);
  Eigen::MatrixXd images(const Eigen::MatrixXd& vectors);

  /// A random unit vector.
  Eigen::VectorXd random(Random& random) const;
  /// The largest eigenvalue by 12 power steps: at most a fifth too small.
  double largest(Random& numbers);
  /// The effect of rounding on an eigenvalue that is 0: products are exact to eps `largest`, and
  /// positions rounded by eps |x| change strains by eps |x| / h, so that it is
  /// largest (1e-12 + 8 eps |x| / h).
  double noise(double largest) const;
  /// Displacements of a vector, per vertex.
  std::vector<Vec3> shape(const Eigen::Ref<const Eigen::VectorXd>& y) const;

 private:
  Body& body_;
  double time_;
  std::vector<double> scale_, direction_;
  unsigned products_ = 0;
};

}  // namespace suture
