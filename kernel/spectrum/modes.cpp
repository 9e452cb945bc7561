// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/spectrum/modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/vec3.hpp"
#include "kernel/solvers/ritz.hpp"
#include "kernel/spectrum/coarse_space.hpp"
#include "kernel/spectrum/scaled_tangent.hpp"

namespace suture {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using EigenIndex = Eigen::Index;

constexpr EigenIndex block_size = 3;
constexpr unsigned least_iterations = 4;
constexpr double wanted = 0.05;  // estimated error of the eigenvalue over the eigenvalue
/// Quotient of the whole checkerboard over lambda_max below which a model is taken not to
/// resist it: 0.13 and more for tensor-mass, 0.02 for a clamped lattice of springs.
constexpr double soft_checkerboard = 0.06;

/// The coarse space with its Ritz pairs: start vectors, and the smooth part of the
/// preconditioner.
class Coarse {
 public:
  Coarse(ScaledTangent& a, const CellComplex& complex, Attributes& attributes, Index nodes,
         double largest)
      : space_(complex, attributes, a.scale(), nodes) {
    CoarseSpace more = space_;
    more.add_checkerboards(complex, attributes, std::max<Index>(nodes / 3, 8));
    if (softest_checkerboard(a, more) < soft_checkerboard * largest) space_ = std::move(more);
    MatrixXd gram(space_.size(), space_.size()), ritz(space_.size(), space_.size());
    for (EigenIndex j = 0; j < space_.size(); ++j) {
      const VectorXd y = motion(VectorXd::Unit(space_.size(), j));
      gram.col(j) = space_.restrict(y.data());
      ritz.col(j) = space_.restrict(a(y).data());
    }
    const Ritz pairs(gram, (ritz + ritz.transpose()) / 2);
    values_ = pairs.values;
    vectors_ = pairs.vectors;
    if (values_.size() == 0) return;
    const double floor = 1e-6 * values_.cwiseAbs().maxCoeff();
    inverse_ = values_.cwiseAbs().cwiseMax(floor).cwiseInverse();
  }

  EigenIndex size() const { return values_.size(); }
  VectorXd mode(EigenIndex i) const { return motion(vectors_.col(i)); }
  /// sum q (q.r) / |t|
  VectorXd solve(const VectorXd& r) const {
    const VectorXd amounts = vectors_.transpose() * space_.restrict(r.data());
    return motion(vectors_ * (inverse_.asDiagonal() * amounts));
  }

 private:
  VectorXd motion(const VectorXd& c) const {
    VectorXd y = VectorXd::Zero(rows_);
    space_.prolong(c, y.data());
    return y;
  }

  /// All functions of the checkerboards' grid add up to the whole checkerboard.
  double softest_checkerboard(ScaledTangent& a, const CoarseSpace& more) {
    rows_ = a.size();
    double softest = std::numeric_limits<double>::infinity();
    for (EigenIndex c = 0; c < 3; ++c) {
      VectorXd all = VectorXd::Zero(more.size());
      for (EigenIndex j = space_.size() + c; j < more.size(); j += 3) all[j] = 1;
      VectorXd y = VectorXd::Zero(a.size());
      more.prolong(all, y.data());
      if (y.squaredNorm() > 0) softest = std::min(softest, y.dot(a(y)) / y.squaredNorm());
    }
    return softest;
  }

  CoarseSpace space_;
  EigenIndex rows_ = 0;
  VectorXd values_, inverse_;
  MatrixXd vectors_;
};

MatrixXd beside(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

/// The lowest `count` Ritz vectors of [x, directions]; the part from the directions becomes
/// the next last direction.
struct Descent {
  MatrixXd x, image, last, last_image;
  VectorXd values;

  void start(MatrixXd vectors, ScaledTangent& a) {
    x.resize(vectors.rows(), 0);
    image = x;
    last = image;
    last_image = image;
    improve(vectors, a.images(vectors));
    last.resize(vectors.rows(), 0);
    last_image = last;
  }

  void improve(const MatrixXd& directions, const MatrixXd& images) {
    const MatrixXd more = beside(directions, last), more_images = beside(images, last_image);
    const MatrixXd all = beside(x, more), all_images = beside(image, more_images);
    const Ritz ritz(all.transpose() * all, all.transpose() * all_images);
    if (ritz.values.size() == 0) return;  // nothing is free
    const EigenIndex count = std::min<EigenIndex>(block_size, ritz.values.size());
    const MatrixXd best = ritz.vectors.leftCols(count);
    values = ritz.values.head(count);
    last = more * best.bottomRows(more.cols());
    last_image = more_images * best.bottomRows(more.cols());
    x = all * best;
    image = all_images * best;
  }
};

/// The lowest modes of the coarse space, with a little of everything, and the last motion.
MatrixXd start_vectors(const ScaledTangent& a, const Coarse& coarse, Random& numbers,
                       std::span<const double> last_motion) {
  MatrixXd start(a.size(), block_size + 1);
  for (EigenIndex i = 0; i < start.cols(); ++i) {
    start.col(i) = 1e-3 * a.random(numbers);
    if (i < std::min<EigenIndex>(block_size, coarse.size())) start.col(i) += coarse.mode(i);
  }
  for (EigenIndex i = 0; !last_motion.empty() && i < a.size(); ++i) {
    const double scale = a.scale()[static_cast<std::size_t>(i)];
    start(i, block_size) = scale > 0 ? last_motion[static_cast<std::size_t>(i)] / scale : 0;
  }
  if (start.col(block_size).norm() > 0) start.col(block_size).normalize();
  return start;
}

/// T r for each column.
MatrixXd precondition(const Coarse& coarse, const MatrixXd& residual, double largest) {
  MatrixXd direction = residual / largest;
  for (EigenIndex i = 0; coarse.size() > 0 && i < residual.cols(); ++i)
    direction.col(i) += coarse.solve(residual.col(i));
  return direction;
}

/// Scaled so that the longest displacement has length 1.
std::vector<Vec3> unit_shape(const ScaledTangent& a, const VectorXd& y) {
  std::vector<Vec3> shape = a.shape(y);
  double longest = 0;
  for (const Vec3& u : shape) longest = std::max(longest, std::sqrt(dot(u, u)));
  for (Vec3& u : shape)
    for (double& component : u) component /= longest;
  return shape;
}

}  // namespace

LowestMode find_lowest_mode(Body& body, double time, unsigned products,
                            std::span<const double> last_motion) {
  const CellComplex& complex = body.complex();
  Attributes& attributes = body.attributes();
  ScaledTangent a(body, time);
  Random numbers;
  LowestMode mode;
  const double largest = a.largest(numbers);
  mode.noise = a.noise(largest);
  const Coarse coarse(a, complex, attributes, std::clamp<Index>(products / 6, 8, 100), largest);

  Descent descent;
  descent.start(start_vectors(a, coarse, numbers, last_motion), a);
  for (unsigned iteration = 0;; ++iteration) {
    if (descent.x.cols() == 0) return mode;  // nothing is free
    const MatrixXd residual = descent.image - descent.x * descent.values.asDiagonal();
    MatrixXd direction = precondition(coarse, residual, largest);
    mode.eigenvalue = descent.values[0];
    mode.error = residual.col(0).dot(direction.col(0));
    const bool good = mode.error <= std::max(wanted * std::abs(mode.eigenvalue), mode.noise);
    if ((good && iteration >= least_iterations) || a.products() + block_size > products) break;
    for (EigenIndex i = 0; i < direction.cols(); ++i)
      if (const double length = direction.col(i).norm(); length > 0) direction.col(i) /= length;
    descent.improve(direction, a.images(direction));
  }
  const VectorXd y = descent.x.col(0).normalized();
  mode.eigenvalue = y.dot(a(y));
  mode.products = a.products();
  mode.shape = unit_shape(a, y);
  return mode;
}

}  // namespace suture
