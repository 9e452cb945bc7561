// SPDX-License-Identifier: MIT
//
// Baudet's springs of one element: what a rest shape and a material give.
// Notation and status of every formula: README.md.
#ifndef MSS_BAUDET_BOX_HPP
#define MSS_BAUDET_BOX_HPP

#include <cmath>
#include <cstdint>
#include <cstring>

#include "suture/tensor.hpp"

namespace mss_baudet {

using suture::vec3;

/// What to do with an edge stiffness below zero (thin boxes).
enum NegativeStiffness { clamp, keep, refuse };

/// The isotropic material that the springs stand for, from the parameters.
template <class R>
struct Material {
  R E;        ///< Young's modulus, Pa
  double nu;  ///< Poisson's ratio
  R lambda;   ///< E nu / ((1+nu)(1-2nu)), Pa
  R mu;       ///< E / (2(1+nu)), Pa
  NegativeStiffness negative;

  Material(const R& e, double n, NegativeStiffness policy)
      : E(e),
        nu(n),
        lambda(e * n / ((1 + n) * (1 - 2 * n))),
        mu(e / (2 * (1 + n))),
        negative(policy) {}
};

/// Nodes n and n + step are the ends of an edge along axis a: step = 1, 2, 4.
constexpr int step_of(int axis) { return 1 << axis; }
/// +-1: the side of node n along the axis.
constexpr int side(int node, int axis) { return (node >> axis & 1) != 0 ? 1 : -1; }

/// Mean of the four edge vectors along an axis, sum_n side(n) x_n / 4.
/// `node(n)` gives the position of node n of the element.
template <class Node>
SUTURE_INLINE auto mean_edge(const Node& node, int axis) {
  const int s = step_of(axis), b = step_of((axis + 1) % 3), c = step_of((axis + 2) % 3);
  return ((node(s) - node(0)) + (node(s + b) - node(b)) + (node(s + c) - node(c)) +
          (node(s + b + c) - node(b + c))) *
         0.25;
}

/// Lengths of the box that stands for the element: of its mean edge vectors.
template <class Node>
SUTURE_INLINE auto box_lengths(const Node& node) {
  return decltype(mean_edge(node, 0)){norm(mean_edge(node, 0)), norm(mean_edge(node, 1)),
                                      norm(mean_edge(node, 2))};
}

/// x rounded to 40 significant bits (1e-12): equal for lengths that differ by the
/// rounding of coordinates, but for the few that lie halfway between two results.
inline double to_40_bits(double x) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  constexpr int dropped = 13;
  bits = (bits + (std::uint64_t{1} << (dropped - 1))) >> dropped << dropped;
  std::memcpy(&x, &bits, sizeof bits);
  return x;
}
template <int N>
suture::pack<N> to_40_bits(suture::pack<N> x) {
  return suture::pack<N>::map(x, [](double lane) { return to_40_bits(lane); });
}

/// Volume of the trilinear element: det J is of degree 2 in each coordinate, so
/// two Gauss points per direction are exact. On the unit cube the tangent along
/// an axis is the bilinear mean of its four edge vectors.
template <class Node>
auto volume(const Node& node) {
  const double low = 0.5 - 0.5 / std::sqrt(3.0);
  const auto tangent = [&](int axis, double u, double v) {
    const int s = step_of(axis), b = step_of((axis + 1) % 3), c = step_of((axis + 2) % 3);
    return (node(s) - node(0)) * ((1 - u) * (1 - v)) + (node(s + b) - node(b)) * (u * (1 - v)) +
           (node(s + c) - node(c)) * ((1 - u) * v) + (node(s + b + c) - node(b + c)) * (u * v);
  };
  auto sum = dot(tangent(0, 0, 0), tangent(0, 0, 0)) * 0.0;
  for (int point = 0; point < 8; ++point) {
    const double x = (point & 1) != 0 ? low : 1 - low, y = (point & 2) != 0 ? low : 1 - low,
                 z = (point & 4) != 0 ? low : 1 - low;
    sum += 0.125 * dot(tangent(0, y, z), cross(tangent(1, z, x), tangent(2, x, y)));
  }
  return sum;
}

/// Spring constants of one element: its share of the 12 edges, its 4 inner springs.
template <class T>
struct SpringConstants {
  vec3<T> edge;  ///< of each of the four edges along x, y, z, N/m
  T inner;       ///< of each inner diagonal, N/m
};

/// Box of lengths l = (x, y, z), d^2 = x^2 + y^2 + z^2, V = xyz (Baudet; for boxes
/// one k_d cannot meet three shear moduli, k_d is their geometric mean):
///   k_d  = mu d^2 / (4 V^(1/3))
///   G_ab = 4 k_d a b / (d^2 c)
///   k_a  = b c / (4 a) (E + nu (G_ab + G_ac)) - k_d a^2 / d^2
/// For a cube: k_d = 3 E l / (8 (1+nu)), k_a = E l (1+4nu) / (8 (1+nu)).
template <class T>
SpringConstants<T> springs_of_box(const Material<T>& m, const vec3<T>& l) {
  const T d2 = dot(l, l), volume = l[0] * l[1] * l[2];
  SpringConstants<T> k;
  k.inner = m.mu * d2 / (4.0 * cbrt(volume));
  const T shear = 4.0 * k.inner * volume / d2;  // G_ab = shear / c^2
  for (int a = 0; a < 3; ++a) {
    const T b = l[(a + 1) % 3], c = l[(a + 2) % 3];
    const T axial = m.E + m.nu * shear * (1.0 / (b * b) + 1.0 / (c * c));
    k.edge[a] = b * c / (4.0 * l[a]) * axial - k.inner * l[a] * l[a] / d2;
  }
  return k;
}

/// springs_of_box() with the scene's choice about negative constants applied.
template <class T>
SpringConstants<T> used_springs_of_box(const Material<T>& m, const vec3<T>& l) {
  using suture::max;
  auto k = springs_of_box(m, l);
  if (m.negative == clamp)
    for (int a = 0; a < 3; ++a) k.edge[a] = max(k.edge[a], T(0.0));
  return k;
}

/// Stiffness of the lattice of such boxes in small strain, normal components:
///   C_aa = 4 (k_a a + k_d a^3 / d^2) / (b c),   C_ab = 4 k_d a b / (d^2 c)
/// and what Hooke's law has more than it, D = C_iso - C. Energy of the correction
/// (e_a: strain of the mean edge vector A_a, delta_a = |A_a| - a):
///   U = V/2 sum_ab D_ab e_a e_b = 2 sum_ab B_ab delta_a delta_b,
///   B_ab = V D_ab / (4 a b)                                      (N/m)
/// For a cube D_aa = (4nu-1) lambda and D_ab = lambda - mu.
template <class T>
suture::sym3<T> correction_of_box(const Material<T>& m, const vec3<T>& l) {
  const auto k = used_springs_of_box(m, l);
  const T d2 = dot(l, l), volume = l[0] * l[1] * l[2];
  suture::sym3<T> B;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const T c_aa = 4.0 * (k.edge[a] * l[a] + k.inner * l[a] * l[a] * l[a] / d2) / (l[b] * l[c]);
    const T c_ab = 4.0 * k.inner * l[a] * l[b] / (d2 * l[c]);
    B(a, a) = volume * (m.lambda + 2 * m.mu - c_aa) / (4.0 * l[a] * l[a]);
    B(a, b) = volume * (m.lambda - c_ab) / (4.0 * l[a] * l[b]);
  }
  return B;
}

/// What an uncorrected lattice of cubes shows instead of E and nu:
///   E_lat = 2 E (1+4nu) / (3+4nu),   nu_lat = 1 / (3+4nu)
inline double lattice_young(double E, double nu) { return 2 * E * (1 + 4 * nu) / (3 + 4 * nu); }
inline double lattice_nu(double nu) { return 1 / (3 + 4 * nu); }

}  // namespace mss_baudet

#endif
