// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/model_check/sample_parts.hpp"

#include <cmath>
#include <utility>

#include "kernel/parts/moments.hpp"

namespace suture {
namespace {

using Tetrahedron = std::array<Vec3, 4>;

// A tetrahedron in a corner has at most a sixth of the cube.
constexpr std::array<double, 8> fractions{1, 1 - 1e-9, 0.95, 0.84, 0.16, 1e-3, 1e-6, 1e-9};

bool is_rest(Index element) { return fractions[element] > 0.5; }

double tetrahedron_fraction(Index element) {
  return is_rest(element) ? 1 - fractions[element] : fractions[element];
}

double sign(Index corner, std::size_t axis) { return corner >> axis & 1 ? 1 : -1; }

/// With three legs of different lengths, at the corner of the element's number.
Tetrahedron tetrahedron(Index element) {
  constexpr Vec3 shape{1, 0.98, 1.02};
  const double volume = 8 * tetrahedron_fraction(element);
  const double leg = std::cbrt(6 * volume / (shape[0] * shape[1] * shape[2]));
  Tetrahedron t;
  for (Vec3& x : t) x = {sign(element, 0), sign(element, 1), sign(element, 2)};
  for (std::size_t a = 0; a < 3; ++a) t[a + 1][a] -= sign(element, a) * leg * shape[a];
  return t;
}

PartMoments moments(Index element) {
  Tetrahedron t = tetrahedron(element);
  const bool is_taken = is_rest(element);
  if ((six_volumes(t) < 0) != is_taken) std::swap(t[0], t[1]);
  MomentSum sum = is_taken ? MomentSum::of_whole_cube() : MomentSum{};
  sum.add(t);
  PartMoments part = sum.moments();
  part.fraction = fractions[element];  // without the rounding of the tetrahedron
  return part;
}

/// dN/dx of N = (1 +- x)(1 +- y)(1 +- z) / 8.
Vec3 gradient(int node, const Vec3& x) {
  Vec3 result;
  for (std::size_t a = 0; a < 3; ++a) {
    result[a] = 0.125;
    for (std::size_t b = 0; b < 3; ++b) {
      const double s = sign(static_cast<Index>(node), b);
      result[a] *= a == b ? s : 1 + s * x[b];
    }
  }
  return result;
}

/// Four points, exact for degree 2.
Vec3 mean_gradient(int node, const Tetrahedron& t) {
  const double near = (5 - std::sqrt(5.0)) / 20, far = 1 - 3 * near;
  Vec3 mean{};
  for (std::size_t q = 0; q < 4; ++q) {
    Vec3 x{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t a = 0; a < 3; ++a) x[a] += (i == q ? far : near) * t[i][a];
    const Vec3 g = gradient(node, x);
    for (std::size_t a = 0; a < 3; ++a) mean[a] += g[a] / 4;
  }
  return mean;
}

}  // namespace

Parts sample_parts() {
  Parts parts;
  for (Index e = 0; e < fractions.size(); ++e) {
    parts.elements.push_back(e);
    parts.moments.push_back(moments(e));
  }
  return parts;
}

Vec3 integral_of_gradient(Index element, int node) {
  Vec3 result = mean_gradient(node, tetrahedron(element));
  for (std::size_t a = 0; a < 3; ++a) {
    result[a] *= 8 * tetrahedron_fraction(element);
    if (is_rest(element)) result[a] = sign(static_cast<Index>(node), a) - result[a];
  }
  return result;
}

}  // namespace suture
