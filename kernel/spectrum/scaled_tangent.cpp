// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/spectrum/scaled_tangent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using EigenIndex = Eigen::Index;

/// The largest coordinate over the shortest edge at rest.
double positions_over_edges(const CellComplex& complex, Attributes& attributes) {
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
  return smallest > 0 && std::isfinite(smallest) ? far / smallest : 0;
}

}  // namespace

ScaledTangent::ScaledTangent(Body& body, double time)
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

EigenIndex ScaledTangent::unknowns() const {
  return std::ranges::count_if(scale_, [](double scale) { return scale > 0; });
}

void ScaledTangent::multiply(const Eigen::Ref<const VectorXd>& y, Eigen::Ref<VectorXd> image) {
  ++products_;
  for (std::size_t i = 0; i < scale_.size(); ++i)
    direction_[i] = scale_[i] * y[static_cast<EigenIndex>(i)];
  image.setZero();
  body_.add_tangent(direction_.data(), 1, 0, time_, image.data());
  for (std::size_t i = 0; i < scale_.size(); ++i) image[static_cast<EigenIndex>(i)] *= -scale_[i];
}

VectorXd ScaledTangent::operator()(const Eigen::Ref<const VectorXd>& y) {
  VectorXd image(size());
  multiply(y, image);
  return image;
}

MatrixXd ScaledTangent::images(const MatrixXd& vectors) {
  MatrixXd result(vectors.rows(), vectors.cols());
  for (EigenIndex i = 0; i < vectors.cols(); ++i) multiply(vectors.col(i), result.col(i));
  return result;
}

VectorXd ScaledTangent::random(Random& random) const {
  VectorXd y(size());
  for (std::size_t i = 0; i < scale_.size(); ++i)
    y[static_cast<EigenIndex>(i)] = scale_[i] > 0 ? random() : 0;
  return y.normalized();
}

double ScaledTangent::largest(Random& numbers) {
  constexpr unsigned power_steps = 12;
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

double ScaledTangent::noise(double largest) const {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  return largest *
         (1e-12 + 8 * epsilon * positions_over_edges(body_.complex(), body_.attributes()));
}

std::vector<Vec3> ScaledTangent::shape(const Eigen::Ref<const VectorXd>& y) const {
  std::vector<Vec3> displacements(scale_.size() / 3);
  for (std::size_t i = 0; i < scale_.size(); ++i)
    displacements[i / 3][i % 3] = scale_[i] * y[static_cast<EigenIndex>(i)];
  return displacements;
}

}  // namespace suture
