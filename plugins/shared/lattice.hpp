// SPDX-License-Identifier: MIT
//
// The springs of a box between all 28 pairs of its nodes: 12 edges, 12 face diagonals, 4 inner
// diagonals, and a term of its volume. Springs are of one kind if the same axes separate their
// nodes: m = i ^ j has a bit per axis.
#ifndef SUTURE_PLUGINS_LATTICE_HPP
#define SUTURE_PLUGINS_LATTICE_HPP

#include "suture/hexahedron.hpp"
#include "suture/lame.hpp"
#include "suture/mass.hpp"

namespace lattice {

template <class Cell>
auto rest_edges(const Cell& c) {
  suture::vec3<typename Cell::real> X[8];
  for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
  return mean_edges(X);
}

/// Sums of the squared lengths of the edges along the axes of m.
template <class R>
void squares_by_axes(const suture::mat3<R>& edges, R (&square)[8]) {
  for (int m = 0; m < 8; ++m) {
    square[m] = R(0.0);
    for (int a = 0; a < 3; ++a)
      if (m >> a & 1) square[m] += dot(edges.column[a], edges.column[a]);
  }
}

/// Rest lengths of the springs, by axes; the first is the volume.
struct Lengths {
  static constexpr int components = 8;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    const auto edges = rest_edges(c);
    typename Cell::real square[8];
    squares_by_axes(edges, square);
    out.set(0, 0, det(edges));
    for (int m = 1; m < 8; ++m) out.set(0, m, sqrt(square[m]));
  }
};

/// Spring constants k[m], N/m, of one element with the squared lengths s[m] and the volume V, with
/// which a lattice of boxes is isotropic, with the shear modulus G and Poisson's ratio 1/4. With
/// the edges a, b of the axes, d^2 = s[7] and what belongs to one element (edges belong to 4 of
/// them, face diagonals to 2):
///   k_d  = 4/7 min_ab G d^2 V / (4 a^2 b^2)
///   k_ab = (G - 4 k_d a^2 b^2 / (d^2 V)) (a^2 + b^2) V / (4 a^2 b^2)
///   k_a  = V / (4 a^2) (3 G - 4 k_d a^4 / (d^2 V) - sum_b 4 k_ab a^4 / ((a^2 + b^2) V))
/// For cubes of edge l: k_d = 3 G l / 7, k_ab = k_d / 2, k_a = 11 G l / 28.
template <class R>
void box_springs(const R (&s)[8], const R& V, const R& G, R (&k)[8]) {
  const auto product = [&](int m) { return s[m & -m] * s[m & (m - 1)]; };    // a^2 b^2
  const R inner = G / (7.0 * max(max(product(3), product(5)), product(6)));  // k_d / (d^2 V)
  k[7] = inner * s[7] * V;
  for (const int m : {3, 5, 6})
    k[m] = (G - 4.0 * inner * product(m)) * s[m] * V / (4.0 * product(m));
  for (const int a : {1, 2, 4}) {
    R left = 3.0 * G - 4.0 * inner * s[a] * s[a];
    for (const int b : {1, 2, 4})
      if (a != b) left -= 4.0 * k[a | b] * s[a] * s[a] / (s[a | b] * V);
    k[a] = V * left / (4.0 * s[a]);
  }
}

/// Spring constants, by axes; the first is kappa V = (lambda - mu) V, J. M::moduli(c) gives
/// Lame's constants.
template <class M>
struct Stiffness {
  static constexpr int components = 8;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    using R = typename Cell::real;
    const auto edges = rest_edges(c);
    const auto moduli = M::moduli(c);
    R square[8], k[8];
    squares_by_axes(edges, square);
    box_springs(square, det(edges), R(moduli.mu), k);
    k[0] = (moduli.lambda - moduli.mu) * det(edges);
    for (int m = 0; m < 8; ++m) out.set(0, m, k[m]);
  }
};

/// Sets the forces of the springs and of the volume term, and returns their energy:
///   U = sum k/2 (l - L)^2 + kappa V/2 (J - 1)^2,  J = A_x . (A_y x A_z) / V, A_a the mean edges
///   f_n = -dU/dx_n; of the volume: -kappa (J - 1) / 4 sum_a (+-1) A_b x A_c
template <class Cell, class Stiffness, class Length, class T>
T pull(const Cell& c, Stiffness stiffness, Length length, suture::vec3<T> (&f)[8]) {
  suture::vec3<T> x[8];
  for (int n = 0; n < 8; ++n) x[n] = c.position(n);
  const auto edges = mean_edges(x);
  const auto faces = cofactor(edges);
  const auto energy_scale = c.column(stiffness, 0);
  const auto inverse_volume = 1.0 / c.column(length, 0);
  const T swelling = dot(edges.column[0], faces.column[0]) * inverse_volume - 1.0;
  const T pressure = swelling * (energy_scale * inverse_volume * 0.25);
  T twice = energy_scale * (swelling * swelling);
  for (int n = 0; n < 8; ++n) {
    f[n] = {T(0.0), T(0.0), T(0.0)};
    for (int a = 0; a < 3; ++a) f[n] += faces.column[a] * (n >> a & 1 ? -pressure : pressure);
  }
  for (int i = 0; i < 8; ++i)
    for (int j = i + 1; j < 8; ++j) {
      const auto d = x[j] - x[i];
      const auto k = c.column(stiffness, i ^ j);
      const T square = dot(d, d), inverse = rsqrt(square);
      const T stretch = square * inverse - c.column(length, i ^ j);
      const auto spring = d * (k * stretch * inverse);
      f[i] += spring;
      f[j] -= spring;
      twice += k * (stretch * stretch);
    }
  return 0.5 * twice;
}

/// Base of models with these springs: the first attributes of M, and what rejects other shapes.
/// M::moduli(c) gives Lame's constants, M::rho is the place of the density.
template <class M>
struct on_boxes : suture::model, suture::on_volumes {
  static constexpr bool allows_parts = true;
  static constexpr suture::column<1> stiffness{};
  static constexpr suture::column<2> length{};
  static constexpr suture::attribute stiffness_attribute() {
    return suture::volume_attribute("stiffness", "N/m", "Springs, by axes; first kappa V, J", 8)
        .from_volumes(suture::contribution<M, Stiffness<M>>);
  }
  static constexpr suture::attribute length_attribute() {
    return suture::volume_attribute("length", "m", "Rest lengths, by axes; first V, m^3", 8)
        .from_volumes(suture::contribution<M, Lengths>);
  }

  template <class P>
  static auto density(const P& p) {
    return p[M::rho];
  }

  template <class Cell>
  static void inspect(const Cell& c) {
    using R = typename Cell::real;
    const auto edges = rest_edges(c);
    R square[8], k[8];
    squares_by_axes(edges, square);
    c.report(SUTURE_ERROR, deviation(c, edges) > 1e-6 * square[7], "not-a-box",
             "these springs are made for boxes at rest: use a mesh of boxes, or a model for any "
             "hexahedra, such as tm-faure");
    box_springs(square, det(edges), R(1.0), k);
    c.report(SUTURE_WARNING, min(min(k[1], k[2]), k[4]) < 0.0, "negative-stiffness",
             "springs along an edge have a negative stiffness, which may be unstable: use boxes "
             "whose edges differ less in length");
  }

 private:
  /// A squared length, zero for a box.
  template <class Cell, class Edges>
  static auto deviation(const Cell& c, const Edges& edges) {
    typename Cell::real largest(0.0);
    for (int n = 0; n < 8; ++n) {
      auto off = c.rest(n) - c.rest(0);
      for (int a = 0; a < 3; ++a)
        if (n >> a & 1) off -= edges.column[a];
      largest = max(largest, dot(off, off));
    }
    for (int a = 0; a < 3; ++a)
      largest = max(largest, abs(dot(edges.column[a], edges.column[(a + 1) % 3])));
    return largest;
  }
};

}  // namespace lattice

#endif
