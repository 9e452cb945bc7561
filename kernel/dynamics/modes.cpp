// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/coarse_space.hpp"

namespace suture {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using EigenIndex = Eigen::Index;

constexpr EigenIndex block = 3;
constexpr unsigned power_steps = 12;
constexpr unsigned least_iterations = 4;
constexpr double wanted = 0.05;  // estimated error of the eigenvalue over the eigenvalue
/// Quotient of the whole checkerboard over lambda_max below which a model is taken not to
/// resist it: 0.13 and more for tensor-mass, 0.02 for a clamped lattice of springs.
constexpr double soft_checkerboard = 0.06;

/// Numbers in [-0.5, 0.5), the same on every machine.
class Random {
 public:
  double operator()() { return (engine_() - 2147483648.0) / 4294967296.0; }

 private:
  std::mt19937 engine_;
};

/// y -> M^-1/2 K M^-1/2 y on the free components.
class Operator {
 public:
  Operator(Body& body, double time)
      : body_(body), time_(time), scale_(3 * std::size_t{body.attributes().vertex_count()}) {
    Attributes& attributes = body.attributes();
    for (std::size_t i = 0; i < scale_.size(); ++i) {
      const auto v = static_cast<Index>(i / 3);
      const double mass = attributes.mass().get(v, 0);
      const bool held = static_cast<int>(attributes.fixed().get(v, 0)) >> i % 3 & 1;
      scale_[i] = mass > 0 && !held ? 1 / std::sqrt(mass) : 0;
    }
    direction_.resize(scale_.size());
  }

  EigenIndex size() const { return static_cast<EigenIndex>(scale_.size()); }
  const std::vector<double>& scale() const { return scale_; }
  unsigned products() const { return products_; }

  VectorXd operator()(const Eigen::Ref<const VectorXd>& y) {
    ++products_;
    for (std::size_t i = 0; i < scale_.size(); ++i)
      direction_[i] = scale_[i] * y[static_cast<EigenIndex>(i)];
    VectorXd image = VectorXd::Zero(size());
    body_.add_tangent(direction_.data(), 1, 0, time_, image.data());
    for (std::size_t i = 0; i < scale_.size(); ++i) image[static_cast<EigenIndex>(i)] *= -scale_[i];
    return image;
  }

  MatrixXd images(const MatrixXd& vectors) {
    MatrixXd result(vectors.rows(), vectors.cols());
    for (EigenIndex i = 0; i < vectors.cols(); ++i) result.col(i) = (*this)(vectors.col(i));
    return result;
  }

  VectorXd random(Random& random) const {
    VectorXd y(size());
    for (std::size_t i = 0; i < scale_.size(); ++i)
      y[static_cast<EigenIndex>(i)] = scale_[i] > 0 ? random() : 0;
    return y.normalized();
  }

  /// By power steps: at most a fifth too small.
  double largest(Random& numbers) {
    VectorXd y = random(numbers);
    double value = 0;
    for (unsigned step = 0; step < power_steps; ++step) {
      y = (*this)(y);
      value = y.norm();
      if (!(value > 0)) return 0;
      y /= value;
    }
    return value;
  }

 private:
  Body& body_;
  double time_;
  std::vector<double> scale_, direction_;
  unsigned products_ = 0;
};

/// The Ritz values of a subspace with the Gram matrix `gram` and the projected operator
/// `ritz`, ascending, and its vectors; what is dependent within 1e-10 is left out.
struct Ritz {
  VectorXd values;
  MatrixXd vectors;  ///< columns of coefficients

  Ritz(const MatrixXd& gram, const MatrixXd& ritz) {
    const VectorXd diagonal = gram.diagonal();
    VectorXd unit = VectorXd::Zero(diagonal.size());
    for (EigenIndex i = 0; i < unit.size(); ++i)
      if (diagonal[i] > 0) unit[i] = 1 / std::sqrt(diagonal[i]);
    const MatrixXd scaled = unit.asDiagonal() * gram * unit.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> basis(scaled);
    EigenIndex first = 0;
    while (first < unit.size() && !(basis.eigenvalues()[first] > 1e-10)) ++first;
    const EigenIndex kept = unit.size() - first;
    if (kept == 0) return;
    const MatrixXd orthonormal =
        unit.asDiagonal() * basis.eigenvectors().rightCols(kept) *
        basis.eigenvalues().tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
    const MatrixXd projected = orthonormal.transpose() * ritz * orthonormal;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver((projected + projected.transpose()) / 2);
    values = solver.eigenvalues();
    vectors = orthonormal * solver.eigenvectors();
  }
};

/// The coarse space with its Ritz pairs: start vectors, and the smooth part of the
/// preconditioner.
class Coarse {
 public:
  Coarse(Operator& a, const CellComplex& complex, Attributes& attributes, Index nodes,
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
  double softest_checkerboard(Operator& a, const CoarseSpace& more) {
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

  void start(MatrixXd vectors, Operator& a) {
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
    const EigenIndex count = std::min<EigenIndex>(block, ritz.values.size());
    const MatrixXd best = ritz.vectors.leftCols(count);
    values = ritz.values.head(count);
    last = more * best.bottomRows(more.cols());
    last_image = more_images * best.bottomRows(more.cols());
    x = all * best;
    image = all_images * best;
  }
};

/// The lowest modes of the coarse space, with a little of everything, and the last motion.
MatrixXd start_vectors(const Operator& a, const Coarse& coarse, Random& numbers,
                       std::span<const double> last_motion) {
  MatrixXd start(a.size(), block + 1);
  for (EigenIndex i = 0; i < start.cols(); ++i) {
    start.col(i) = 1e-3 * a.random(numbers);
    if (i < std::min<EigenIndex>(block, coarse.size())) start.col(i) += coarse.mode(i);
  }
  for (EigenIndex i = 0; !last_motion.empty() && i < a.size(); ++i) {
    const double scale = a.scale()[static_cast<std::size_t>(i)];
    start(i, block) = scale > 0 ? last_motion[static_cast<std::size_t>(i)] / scale : 0;
  }
  if (start.col(block).norm() > 0) start.col(block).normalize();
  return start;
}

/// T r for each column.
MatrixXd precondition(const Coarse& coarse, const MatrixXd& residual, double largest) {
  MatrixXd direction = residual / largest;
  for (EigenIndex i = 0; coarse.size() > 0 && i < residual.cols(); ++i)
    direction.col(i) += coarse.solve(residual.col(i));
  return direction;
}

double noise_of(const CellComplex& complex, Attributes& attributes, double largest) {
  double far = 0;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (int c = 0; c < 3; ++c) far = std::max(far, std::abs(attributes.position().get(v, c)));
  double smallest = std::numeric_limits<double>::infinity();
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Hexahedron& nodes = complex.vertices_of(e);
    for (const std::size_t n : {1u, 2u, 4u}) {
      Vec3 edge;
      for (int c = 0; c < 3; ++c)
        edge[static_cast<std::size_t>(c)] =
            attributes.rest().get(nodes[n], c) - attributes.rest().get(nodes[0], c);
      smallest = std::min(smallest, std::sqrt(dot(edge, edge)));
    }
  }
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double strain = smallest > 0 && std::isfinite(smallest) ? far / smallest : 0;
  return largest * (1e-12 + 8 * epsilon * strain);
}

void set_shape(LowestMode& mode, const Operator& a, const VectorXd& y) {
  mode.shape.resize(a.scale().size() / 3);
  double longest = 0;
  for (std::size_t v = 0; v < mode.shape.size(); ++v) {
    Vec3& u = mode.shape[v];
    for (std::size_t c = 0; c < 3; ++c)
      u[c] = a.scale()[3 * v + c] * y[static_cast<EigenIndex>(3 * v + c)];
    longest = std::max(longest, std::sqrt(dot(u, u)));
  }
  for (Vec3& u : mode.shape)
    for (double& component : u) component /= longest;
}

}  // namespace

LowestMode find_lowest_mode(Body& body, double time, unsigned products,
                            std::span<const double> last_motion) {
  const CellComplex& complex = body.complex();
  Attributes& attributes = body.attributes();
  Operator a(body, time);
  Random numbers;
  LowestMode mode;
  const double largest = a.largest(numbers);
  mode.noise = noise_of(complex, attributes, largest);
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
    if ((good && iteration >= least_iterations) || a.products() + block > products) break;
    for (EigenIndex i = 0; i < direction.cols(); ++i)
      if (const double length = direction.col(i).norm(); length > 0) direction.col(i) /= length;
    descent.improve(direction, a.images(direction));
  }
  const VectorXd y = descent.x.col(0).normalized();
  mode.eigenvalue = y.dot(a(y));
  mode.products = a.products();
  set_shape(mode, a, y);
  return mode;
}

}  // namespace suture
