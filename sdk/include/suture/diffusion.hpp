// SPDX-License-Identifier: MIT
//
// suture/diffusion.hpp - a field that diffuses through trilinear hexahedra, such as a temperature:
// what a functor on volumes with a rate (model.hpp) needs.
//
//   template <class Cell> static void rate(Cell& c) {
//     suture::diffuse(c, c.parameter(conductivity));
//   }
#ifndef SUTURE_DIFFUSION_HPP
#define SUTURE_DIFFUSION_HPP

#include "suture/detail/law.hpp"
#include "suture/hexahedron.hpp"
#include "suture/model.hpp"

namespace suture {

namespace detail {

/// du/dxi_d of a scalar at the points of the rule with two points per axis, as in axis_values.
template <class T>
struct scalar_gradients {
  T along[3][4];

  SUTURE_INLINE explicit scalar_gradients(const T (&u)[8]) {
    for (int d = 0; d < 3; ++d) {
      const auto edge = [&](int m) SUTURE_DETAIL_INLINED {
        const auto& e = suture_hexahedron_edges[4 * d + m];
        return u[e[1]] - u[e[0]];
      };
      T line[2][2];
      to_points<2>(edge(0), edge(1), line[0], 1);
      to_points<2>(edge(2), edge(3), line[1], 1);
      for (int p = 0; p < 2; ++p) to_points<2>(line[0][p], line[1][p], &along[d][p], 2);
    }
  }
  scalar_gradients() = default;
  static SUTURE_INLINE scalar_gradients zero() {
    scalar_gradients s;
    for (T(&axis)[4] : s.along)
      for (T& value : axis) value = T(0.0);
    return s;
  }

  SUTURE_INLINE T& at(int d, int i, int j, int k) {
    const int place[3] = {j + 2 * k, i + 2 * k, i + 2 * j};
    return along[d][place[d]];
  }

  /// The gradient du/dX at a point where `inverse` is J^-1.
  template <class R>
  SUTURE_INLINE vec3<T> in_space(int i, int j, int k, const mat3<R>& inverse) {
    vec3<T> gradient{T(0.0), T(0.0), T(0.0)};
    for (int d = 0; d < 3; ++d)
      for (int e = 0; e < 3; ++e) gradient[e] += at(d, i, j, k) * inverse(d, e);
    return gradient;
  }
  /// The transpose: subtracts a flow in space times w J^-1.
  template <class R>
  SUTURE_INLINE void subtract(int i, int j, int k, const mat3<R>& weighed, const vec3<T>& flow) {
    for (int d = 0; d < 3; ++d)
      for (int e = 0; e < 3; ++e) at(d, i, j, k) -= weighed(d, e) * flow[e];
  }

  /// - sum over points and axes of s_d(point) dN_n/dxi_d.
  SUTURE_INLINE void scatter(T (&r)[8]) const {
    for (T& rate : r) rate = T(0.0);
    for (int d = 0; d < 3; ++d) {
      T line[2][2], edge[4];
      for (int p = 0; p < 2; ++p) to_ends<2>(&along[d][p], 2, line[0][p], line[1][p]);
      to_ends<2>(line[0], 1, edge[0], edge[1]);
      to_ends<2>(line[1], 1, edge[2], edge[3]);
      for (int m = 0; m < 4; ++m) {
        const auto& e = suture_hexahedron_edges[4 * d + m];
        r[e[0]] += edge[m];
        r[e[1]] -= edge[m];
      }
    }
  }
};

/// r_n = - sum over points of grad N_n . k grad u. add(gradient, det J) may change what stands for
/// det J grad u at each of them.
template <class T, class R, class K, class Add>
SUTURE_INLINE void diffuse_at_points(const vec3<R> (&X)[8], const T (&u)[8], const K& k, T (&r)[8],
                                     const Add& add) {
  const axis_values<R, 2> rest = gradients<2>(X);
  scalar_gradients<T> g(u), s = scalar_gradients<T>::zero();
  for_each_point<2>([&](int i, int j, int q) SUTURE_DETAIL_INLINED {
    const mat3<R> J = rest.at(i, j, q), cof = cofactor(J);
    const R measure = dot(J.column[0], cof.column[0]);
    const R weight = common_weight<2> * reciprocal(measure);
    vec3<T> gradient{T(0.0), T(0.0), T(0.0)};
    for (int d = 0; d < 3; ++d)
      for (int c = 0; c < 3; ++c) gradient[c] += g.at(d, i, j, q) * cof(c, d);
    add(gradient, measure);
    for (int d = 0; d < 3; ++d)
      for (int c = 0; c < 3; ++c) s.at(d, i, j, q) += (k * weight) * (gradient[c] * cof(c, d));
  });
  s.scatter(r);
}

}  // namespace detail

/// r_n = - integral of grad N_n . k grad u over the hexahedron at rest X, by 2 x 2 x 2 points. They
/// add up to zero.
template <class T, class R, class K>
SUTURE_INLINE void diffusion_rates(const vec3<R> (&X)[8], const T (&u)[8], const K& k, T (&r)[8]) {
  detail::diffuse_at_points(X, u, k, r, [](vec3<T>&, const R&) {});
}

namespace detail {

/// k cof^T cof / det J at each of the points of a parallelepiped.
template <class R, class K>
struct diffusion_metric {
  R of[3][3];
  SUTURE_INLINE diffusion_metric(const vec3<R> (&X)[8], const K& k) {
    const mat3<R> J = mean_edges(X), cof = cofactor(J);
    const R weight = common_weight<2> * reciprocal(dot(J.column[0], cof.column[0]));
    for (int d = 0; d < 3; ++d)
      for (int e = 0; e < 3; ++e) of[d][e] = (k * weight) * dot(cof.column[d], cof.column[e]);
  }
  template <class T>
  SUTURE_INLINE scalar_gradients<T> flows(scalar_gradients<T>& g) const {
    auto s = scalar_gradients<T>::zero();
    for_each_point<2>([&](int i, int j, int q) SUTURE_DETAIL_INLINED {
      for (int d = 0; d < 3; ++d)
        for (int e = 0; e < 3; ++e) s.at(d, i, j, q) += of[d][e] * g.at(e, i, j, q);
    });
    return s;
  }
};

}  // namespace detail

/// The same in a parallelepiped: J is that of its edges.
template <class T, class R, class K>
SUTURE_INLINE void diffusion_rates_of_parallelepiped(const vec3<R> (&X)[8], const T (&u)[8],
                                                     const K& k, T (&r)[8]) {
  detail::scalar_gradients<T> g(u);
  detail::diffusion_metric<R, K>(X, k).flows(g).scatter(r);
}

/// The same in one of which only a part is material, as part_geometry: the difference between the
/// mean gradient of the part and that of the cube is added at all points. With sums over nodes
/// h_xy = sum s_x s_y u_n and so on, that of du/dxi_x is (first_y h_xy + first_z h_xz +
/// second_yz h_xyz) / 4.
template <class T, class R, class K>
SUTURE_INLINE void diffusion_rates_of_part(const vec3<R> (&X)[8], const T (&u)[8], const K& k,
                                           const part_moments<R>& part, T (&r)[8]) {
  R shift[3][8];  // of du/dxi_d by u_n
  for (int d = 0; d < 3; ++d)
    for (int n = 0; n < 8; ++n) {
      const int a = (d + 1) % 3, b = (d + 2) % 3;
      const auto sign = [n](int axis) { return (n >> axis & 1) != 0 ? 0.25 : -0.25; };
      shift[d][n] = sign(d) * (R(4 * sign(a)) * part.first[a] + R(4 * sign(b)) * part.first[b] +
                               R(16 * sign(a) * sign(b)) * part.second[d]);
    }
  detail::scalar_gradients<T> g(u);
  for (int d = 0; d < 3; ++d) {
    T more(0.0);
    for (int n = 0; n < 8; ++n) more += shift[d][n] * u[n];
    for (T& along : g.along[d]) along += more;
  }
  const auto s = detail::diffusion_metric<R, K>(X, k).flows(g);
  s.scatter(r);
  for (int n = 0; n < 8; ++n) {
    for (int d = 0; d < 3; ++d)
      for (const T& along : s.along[d]) r[n] -= shift[d][n] * along;
    r[n] = part.fraction * r[n];
  }
}

/// The same in a general hexahedron of which only a part is material (general_part_geometry): what
/// is added to the gradient at all points is sum_n u_n D_n,
///   D_n = sum_k (s_kn - sum_a s_an c_ka) E^-T d_k / 8 (parts.h).
template <class T, class R, class K>
SUTURE_INLINE void diffusion_rates_of_part(const vec3<R> (&X)[8], const T (&u)[8], const K& k,
                                           const general_part<R>& part, T (&r)[8]) {
  const nodal_modes<R> sums = modes_of(X);  // 8 times the coefficients
  const mat3<R> inverse_e = inverse(sums.edge);
  vec3<R> D[8];
  for (vec3<R>& of_node : D) of_node = {R(0.0), R(0.0), R(0.0)};
  for (int h = 0; h < 4; ++h) {
    const vec3<R> c = inverse_e * sums.hourglass[h], d = transpose(inverse_e) * part.more[h];
    for (int n = 0; n < 8; ++n) {
      const double x = n & 1 ? 1 : -1, y = n & 2 ? 1 : -1, z = n & 4 ? 1 : -1;
      const double sign[4] = {y * z, z * x, x * y, x * y * z};
      D[n] += d * (R(sign[h]) - (c[0] * x + c[1] * y + c[2] * z));
    }
  }
  vec3<T> more{T(0.0), T(0.0), T(0.0)}, flow = more;
  for (int n = 0; n < 8; ++n)
    for (int c = 0; c < 3; ++c) more[c] += D[n][c] * u[n];
  detail::diffuse_at_points(X, u, k, r,
                            [&](vec3<T>& gradient, const R& measure) SUTURE_DETAIL_INLINED {
                              gradient += more * measure;
                              flow += gradient * (k * common_weight<2>);
                            });
  for (int n = 0; n < 8; ++n) {
    for (int c = 0; c < 3; ++c) r[n] -= D[n][c] * flow[c];
    r[n] = part.fraction * r[n];
  }
}

namespace detail {
/// Sets the rates of a cell: rates(X, u, r) writes r[n] for the rest positions X and the field u.
template <class Cell, class Rates>
SUTURE_INLINE void set_rates(const Cell& c, int component, const Rates& rates) {
  using T = typename Cell::scalar;
  vec3<typename Cell::real> X[8];
  T u[8], r[8];
  for (int n = 0; n < 8; ++n) {
    X[n] = c.rest(n);
    u[n] = c.field(n, component);
  }
  rates(X, u, r);
  for (int n = 0; n < 8; ++n) c.rate(n, component, r[n]);
}
}  // namespace detail

/// Sets the rates of a cell whose field diffuses with conductivity k; of a field with several
/// components, each by a call. The functor reads rest positions; one for parallelepipeds only
/// (`shape`) takes three quarters of the time.
template <class Cell, class K>
SUTURE_INLINE void diffuse(const Cell& c, const K& k, int component = 0) {
  detail::set_rates(c, component, [&](const auto& X, const auto& u, auto& r) SUTURE_DETAIL_INLINED {
    if constexpr (Cell::shape == SUTURE_PARALLELEPIPED)
      diffusion_rates_of_parallelepiped(X, u, k, r);
    else
      diffusion_rates(X, u, k, r);
  });
}

/// The same of a cell of which only a part is material, whose functor reads `element_part`, or
/// `element_general_part` for general hexahedra.
template <class Cell, class K>
SUTURE_INLINE void diffuse_in_part(const Cell& c, const K& k, int component = 0) {
  detail::set_rates(c, component, [&](const auto& X, const auto& u, auto& r) SUTURE_DETAIL_INLINED {
    if constexpr (Cell::shape == SUTURE_PARALLELEPIPED)
      diffusion_rates_of_part(X, u, k, detail::read_part(c), r);
    else
      diffusion_rates_of_part(X, u, k, detail::read_general_part(c), r);
  });
}

namespace detail {
/// An eighth of the volume, times density(parameters).
template <class Cell, class Out, class Density>
void share_equally(const Cell& c, const Out& out, const Density& density) {
  vec3<typename Cell::real> X[8];
  for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
  const auto share = volume(X) * (0.125 * density(c.parameters()));
  for (int n = 0; n < 8; ++n) out.set(n, 0, share);
}
template <class M>
struct capacity_share {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    share_equally(c, out, [](const auto& p) { return M::capacity(p); });
  }
};
template <class M>
struct relaxation_share {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    share_equally(c, out, [](const auto& p) { return M::relaxation(p); });
  }
};
}  // namespace detail

/// The capacity of the field declared last before it: M::capacity(p), per volume, times an eighth
/// of the volume of every incident element.
template <class M>
constexpr attribute lumped_capacity(const char* name, const char* unit, const char* doc) {
  return vertex_attribute(name, unit, doc)
      .from_volumes(contribution<M, detail::capacity_share<M>>)
      .flag(SUTURE_CAPACITY);
}

/// What the deformation takes up per unit of that field, likewise from M::relaxation(p): implicit
/// steps, which solve for motion and field in turns, need it where both depend strongly on each
/// other (SUTURE_RELAXATION).
template <class M>
constexpr attribute lumped_relaxation(const char* name, const char* unit, const char* doc) {
  return vertex_attribute(name, unit, doc)
      .from_volumes(contribution<M, detail::relaxation_share<M>>)
      .internal()
      .flag(SUTURE_RELAXATION);
}

}  // namespace suture

#endif
