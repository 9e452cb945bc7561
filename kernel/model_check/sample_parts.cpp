// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/model_check/sample_parts.hpp"

#include <cmath>
#include <utility>

#include "kernel/parts/division.hpp"
#include "kernel/parts/general_part.hpp"
#include "kernel/parts/moments.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

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

/// The part in tetrahedra, of which one oriented negatively is taken away.
void add_material(Parts& parts, Index element) {
  const auto add = [&](const Tetrahedron& corners) {
    const auto first = static_cast<Index>(parts.points.size());
    for (const Vec3& at : corners) parts.points.push_back({element, at});
    parts.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
  };
  const Material& full = Material::full_element();
  if (is_rest(element))
    for (const auto& [a, b, c, d] : full.tetrahedra)
      add({full.points[a], full.points[b], full.points[c], full.points[d]});
  Tetrahedron t = tetrahedron(element);
  if ((six_volumes(t) < 0) != is_rest(element)) std::swap(t[0], t[1]);
  add(t);
}

/// cof(J) dN/dx of N = (1 +- x)(1 +- y)(1 +- z) / 8: the gradient in the element, times det J.
Vec3 gradient(int node, const Vec3& x, const std::array<Vec3, 8>& rest) {
  const auto slope = [&](Index n, std::size_t a) {
    double product = 0.125;
    for (std::size_t b = 0; b < 3; ++b) product *= a == b ? sign(n, b) : 1 + sign(n, b) * x[b];
    return product;
  };
  std::array<Vec3, 3> J{};  // columns
  for (Index n = 0; n < hexahedron::vertices; ++n)
    for (std::size_t a = 0; a < 3; ++a) J[a] = plus(J[a], scaled(slope(n, a), rest[n]));
  Vec3 sum{};
  for (std::size_t a = 0; a < 3; ++a)
    sum = plus(sum,
               scaled(slope(static_cast<Index>(node), a), cross(J[(a + 1) % 3], J[(a + 2) % 3])));
  return sum;
}

/// Gauss's points in [-1, 1]^3, exact for degree 7 in each coordinate. visit(place, weight)
template <class Visit>
void for_each_point(Visit visit) {
  constexpr std::array<std::pair<double, double>, 4> line{
      {{-0.86113631159405258, 0.34785484513745386},
       {-0.33998104358485626, 0.65214515486254614},
       {0.33998104358485626, 0.65214515486254614},
       {0.86113631159405258, 0.34785484513745386}}};
  for (const auto& [x, a] : line)
    for (const auto& [y, b] : line)
      for (const auto& [z, c] : line) visit(Vec3{x, y, z}, a * b * c);
}

}  // namespace

Parts sample_parts() { return sample_parts({}); }

Parts sample_parts(std::span<const std::array<Vec3, 8>> rest) {
  Parts parts;
  parts.first.push_back(0);
  for (Index e = 0; e < fractions.size(); ++e) {
    parts.elements.push_back(e);
    parts.moments.push_back(moments(e));
    add_material(parts, e);
    parts.first.push_back(static_cast<Index>(parts.tetrahedra.size()));
    if (!rest.empty()) parts.general.push_back(general_part(parts, e, rest[e]));
  }
  return parts;
}

// The cube collapses to the tetrahedron (Duffy 1982): t = t_0 + u (edges_1 + v (edges_2 + w
// edges_3)).
Vec3 integral_of_gradient(Index element, int node, const std::array<Vec3, 8>& rest) {
  const Tetrahedron t = tetrahedron(element);
  const double volume = 8 * tetrahedron_fraction(element);
  Vec3 inside{}, all{};
  for_each_point([&](const Vec3& at, double weight) {
    const double u = (1 + at[0]) / 2, v = (1 + at[1]) / 2, w = (1 + at[2]) / 2;
    const Vec3 x = plus(plus(scaled(1 - u, t[0]), scaled(u * (1 - v), t[1])),
                        plus(scaled(u * v * (1 - w), t[2]), scaled(u * v * w, t[3])));
    inside = plus(inside, scaled(weight * volume * 6 * u * u * v / 8, gradient(node, x, rest)));
    all = plus(all, scaled(weight, gradient(node, at, rest)));
  });
  return is_rest(element) ? minus(all, inside) : inside;
}

}  // namespace suture
