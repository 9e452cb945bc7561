// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/hourglass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernel/attributes/mean_gradient.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

/// What is local to a vertex, as at a force on one node or the tip of a cut, falls from pass
/// to pass; a checkerboard stays.
constexpr int passes = 4;

using Gradient = std::array<Vec3, 3>;  ///< rows

Vec3 mean(const HexahedronNodes& x) {
  Vec3 sum{};
  for (const Vec3& p : x)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += p[c] / 8;
  return sum;
}

/// r_n
HexahedronNodes residual(const HexahedronNodes& x, const HexahedronNodes& rest, const Gradient& f) {
  const Vec3 centre = mean(x), rest_centre = mean(rest);
  HexahedronNodes r;
  for (std::size_t n = 0; n < hexahedron::vertices; ++n) {
    const Vec3 arm = minus(rest[n], rest_centre);
    r[n] = minus(x[n], centre);
    for (std::size_t c = 0; c < 3; ++c) r[n][c] -= dot(f[c], arm);
  }
  return r;
}

/// F that maps the mean edges at rest to those of x; not finite for a flat element.
Gradient gradient(const HexahedronNodes& x, const HexahedronNodes& rest) {
  return mean_gradient(x, reciprocals(mean_edges(rest)));
}

/// |(F^T F - 1) / 2|
double strain_of(const Gradient& f) {
  const SymmetricTensor e = green_lagrange(f);
  return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] +
                   2 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]));
}

/// visit(element, nodes of it, rest positions)
template <class Visit>
void for_each_element(const CellComplex& complex, Attributes& attributes, Visit visit) {
  const RestPlaces rest = attributes.rest_places(complex);
  for (Index e = 0; e < complex.element_count(); ++e)
    if (complex.exists(3, e)) visit(e, complex.vertices_of(e), rest.of(e));
}

}  // namespace

double Hourglass::content(Index element) const {
  const double scale = std::max(strain[element], mean_strain);
  return amplitude[element] > noise ? amplitude[element] / scale : 0;
}

namespace {

/// w: the mean over the elements around each vertex of what `residual_of(nodes, rest)` gives
/// for their corners.
template <class ResidualOf>
void average(const CellComplex& complex, Attributes& attributes,
             const std::vector<std::uint32_t>& around, std::vector<Vec3>& w,
             ResidualOf residual_of) {
  std::vector<Vec3> sum(w.size());
  for_each_element(complex, attributes, [&](Index e, const Hexahedron& nodes, const auto& rest) {
    const HexahedronNodes r = residual_of(e, nodes, rest);
    for (std::size_t n = 0; n < hexahedron::vertices; ++n)
      for (std::size_t c = 0; c < 3; ++c) sum[nodes[n]][c] += r[n][c];
  });
  for (std::size_t v = 0; v < w.size(); ++v)
    for (std::size_t c = 0; c < 3; ++c) w[v][c] = around[v] >= 4 ? sum[v][c] / around[v] : 0;
}

HexahedronNodes residual_of(const std::vector<Vec3>& w, const Hexahedron& nodes,
                            const HexahedronNodes& rest) {
  HexahedronNodes x;
  for (std::size_t n = 0; n < hexahedron::vertices; ++n) x[n] = w[nodes[n]];
  return residual(x, rest, gradient(x, rest));
}

}  // namespace

Hourglass measure_hourglass(const CellComplex& complex, Attributes& attributes) {
  Hourglass result;
  result.amplitude.resize(complex.element_count());
  result.strain.resize(complex.element_count());
  std::vector<std::uint32_t> around(attributes.vertex_count());
  for_each_element(complex, attributes, [&](Index, const Hexahedron& nodes, const auto&) {
    for (const Index v : nodes) ++around[v];
  });
  const double* position = attributes.position().rows();
  double squares = 0, far = 0, smallest = std::numeric_limits<double>::infinity();
  std::vector<Vec3> w(attributes.vertex_count());
  average(complex, attributes, around, w,
          [&](Index e, const Hexahedron& nodes, const HexahedronNodes& rest) {
            HexahedronNodes x;
            for (std::size_t n = 0; n < hexahedron::vertices; ++n) {
              const double* row = position + std::size_t{nodes[n]} * 4;
              x[n] = {row[0], row[1], row[2]};
              for (const double component : x[n]) far = std::max(far, std::abs(component));
            }
            const Gradient f = gradient(x, rest);
            result.strain[e] = strain_of(f);
            squares += result.strain[e] * result.strain[e];
            return residual(x, rest, f);
          });
  for (int pass = 2; pass < passes; ++pass)
    average(complex, attributes, around, w,
            [&](Index, const Hexahedron& nodes, const HexahedronNodes& rest) {
              return residual_of(w, nodes, rest);
            });
  for_each_element(complex, attributes, [&](Index e, const Hexahedron& nodes, const auto& rest) {
    double sum = 0;
    for (const Vec3& p : residual_of(w, nodes, rest)) sum += dot(p, p) / hexahedron::vertices;
    const double size = std::cbrt(std::abs(hexahedron_volume(rest)));
    smallest = std::min(smallest, size);
    result.amplitude[e] = 2 * std::sqrt(sum) / size;
  });
  const Index elements = complex.existing(3);
  if (elements > 0) result.mean_strain = std::sqrt(squares / elements);
  result.noise = 100 * std::numeric_limits<double>::epsilon() * far / smallest;
  return result;
}

}  // namespace suture
