// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/distortion.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>

#include "kernel/attributes/mean_gradient.hpp"
#include "kernel/topology/rest_shape.hpp"

namespace suture {
namespace {

HexahedronNodes current(Body& body, Index element) {
  const double* positions = body.attributes().position().rows();
  HexahedronNodes x;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double* row = positions + std::size_t{4} * body.complex().vertices_of(element)[n];
    x[n] = {row[0], row[1], row[2]};
  }
  return x;
}

double smallest_stretch(const HexahedronNodes& x, const HexahedronNodes& rest,
                        const PartMoments* part) {
  const auto e = green_lagrange(mean_gradient(x, reciprocals(mean_edges(rest, part)), part));
  Eigen::Matrix3d strain;
  strain << e[0], e[3], e[5], e[3], e[1], e[4], e[5], e[4], e[2];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(strain, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, 1 + 2 * solver.eigenvalues()[0]));
}

/// The mean one for a part that is material: the corners of its element need not be.
double smallest_jacobian(const HexahedronNodes& x, const HexahedronNodes& rest,
                         const PartMoments* part) {
  if (part != nullptr)
    return determinant(mean_edges(x, part)) / determinant(mean_edges(rest, part));
  const auto now = corner_jacobians(x), before = corner_jacobians(rest);
  double smallest = 1;
  for (std::size_t i = 0; i < now.size(); ++i)
    if (before[i] > 0) smallest = std::min(smallest, now[i] / before[i]);
  return smallest;
}

}  // namespace

Distortion measure_distortion(Body& body) {
  const RestPlaces places = body.attributes().rest_places(body.complex());
  Distortion worst;
  for (Index e = 0; e < body.complex().element_count(); ++e) {
    if (!body.complex().exists(3, e)) continue;
    const HexahedronNodes x = current(body, e), rest = places.of(e);
    const PartMoments* const part = places.parts().of(e);
    if (const double stretch = smallest_stretch(x, rest, part); stretch < worst.stretch) {
      worst.stretch = stretch;
      worst.compressed = e;
    }
    if (const double jacobian = smallest_jacobian(x, rest, part); jacobian < worst.jacobian) {
      worst.jacobian = jacobian;
      worst.distorted = e;
    }
  }
  return worst;
}

std::string describe(const Distortion& distortion, const Body& body) {
  std::ostringstream text;
  text.precision(3);
  text << "the smallest principal stretch is " << distortion.stretch;
  if (distortion.compressed != none)
    text << " (element " << body.user_element(distortion.compressed) << ')';
  text << " and the smallest corner Jacobian " << distortion.jacobian << " of that at rest";
  if (distortion.distorted != none)
    text << " (element " << body.user_element(distortion.distorted) << ')';
  return text.str();
}

}  // namespace suture
