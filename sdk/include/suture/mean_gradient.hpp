// SPDX-License-Identifier: MIT
//
// suture/mean_gradient.hpp - the hexahedron that evaluates its law once, at the mean
// deformation gradient, and resists hourglassing by an energy of its own.
//
// Local coordinates xi in [-1,1]^3. A nodal field has eight modes: with the signs h of a
// mode at the nodes, 1, xi_I (edges), and h_1..h_4 = eta zeta, zeta xi, xi eta, xi eta zeta
// (hourglasses). Here a mode is the sum of h_n x_n, so 8 times its coefficient; the factor
// cancels wherever rest and current sums meet.
//
// With the edge sums E at rest and A now, A E^-1 is the gradient at the centre. What it
// does not explain is, in mode k,
//   g_k = x_k - A gamma_k,   gamma_k = E^-1 X_k.
// The mean gradient is F = sum_n x_n (x) B_n, B_n = mean of grad N_n. The energy is
//   V W(F) + Es(e)/2 + Es(e')/2,    e_kI = A_I . g_k,    e'_k = E'E A^-1 g_k
// so e holds the components along the rest edges of the gradient's transpose times g_k,
// and e' those of its inverse times g_k. For laws that survive inversion, where the inverse
// is singular on the way, it is V W(F) + Es(e). Either is invariant under rotations, and
// its second part vanishes for every constant gradient (patch test). For laws that are linear in
// displacements it is V W(F) + Es(E_I . g_k), with the edges at rest: its force is linear, too.
//
// Es is the energy at rest of the element with 21 enhanced strain modes (nine linear, six
// bilinear on the normal strains, six on the shear strains), for which a parallelepiped
// has a closed form: the strain coefficients that enhanced modes release relax, which
// leaves plane stress in the plane normal to axis I for those of xi_I, and uniaxial stress
// for those of eta zeta. A general hexahedron takes the form of the parallelepiped of its
// mean edges: on distorted meshes its error is that of the enhanced element, or less
// (docs/decisions/029).
#ifndef SUTURE_MEAN_GRADIENT_HPP
#define SUTURE_MEAN_GRADIENT_HPP

#include "suture/tensor.hpp"

namespace suture {

// ------------------------------------------------------------------ modes --

/// The modes of a nodal field except its mean, or what is conjugate to them.
template <class T>
struct nodal_modes {
  mat3<T> edge;          ///< column I: sums with the signs of xi_I, 4 mean edges
  vec3<T> hourglass[4];  ///< eta zeta, zeta xi, xi eta, xi eta zeta
};

/// Sums and differences along one axis after the other: 23 operations per component.
template <class T>
SUTURE_INLINE nodal_modes<T> modes_of(const vec3<T> (&x)[8]) {
  nodal_modes<T> m;
  for (int c = 0; c < 3; ++c) {
    T s[4], d[4], ss[2], sd[2], ds[2], dd[2];  // sum or difference along x, y
    for (int j = 0; j < 4; ++j) {
      s[j] = x[2 * j + 1][c] + x[2 * j][c];
      d[j] = x[2 * j + 1][c] - x[2 * j][c];
    }
    for (int k = 0; k < 2; ++k) {
      ss[k] = s[2 * k + 1] + s[2 * k];
      sd[k] = s[2 * k + 1] - s[2 * k];
      ds[k] = d[2 * k + 1] + d[2 * k];
      dd[k] = d[2 * k + 1] - d[2 * k];
    }
    m.edge(c, 0) = ds[1] + ds[0];
    m.edge(c, 1) = sd[1] + sd[0];
    m.edge(c, 2) = ss[1] - ss[0];
    m.hourglass[0][c] = sd[1] - sd[0];
    m.hourglass[1][c] = ds[1] - ds[0];
    m.hourglass[2][c] = dd[1] + dd[0];
    m.hourglass[3][c] = dd[1] - dd[0];
  }
  return m;
}

/// Nodal forces f_n = -dE/dx_n from the derivatives of E by the modes: the transpose.
template <class T>
SUTURE_INLINE void scatter(const nodal_modes<T>& m, vec3<T> (&f)[8]) {
  for (int c = 0; c < 3; ++c) {
    const T ss[2] = {-m.edge(c, 2), m.edge(c, 2)};
    const T sd[2] = {m.edge(c, 1) - m.hourglass[0][c], m.edge(c, 1) + m.hourglass[0][c]};
    const T ds[2] = {m.edge(c, 0) - m.hourglass[1][c], m.edge(c, 0) + m.hourglass[1][c]};
    const T dd[2] = {m.hourglass[2][c] - m.hourglass[3][c], m.hourglass[2][c] + m.hourglass[3][c]};
    for (int j = 0; j < 4; ++j) {
      const int k = j >> 1;
      const T s = j & 1 ? ss[k] + sd[k] : ss[k] - sd[k], d = j & 1 ? ds[k] + dd[k] : ds[k] - dd[k];
      f[2 * j][c] = d - s;
      f[2 * j + 1][c] = -d - s;
    }
  }
}

// -------------------------------------------------------------- stiffness --

/// Isotropic moduli of a law at rest, with the fractions that the hourglass stiffness consists of.
template <class R>
struct rest_moduli_of {
  R poisson;
  R shear, plane;                           ///< mu and E / (1 - nu^2), Pa
  R young_ninth;                            ///< E / 9
  R plane_third, cross_third, shear_third;  ///< plane / 3, plane nu / 3, mu / 3
};
using rest_moduli = rest_moduli_of<double>;

/// Es(e) = e.K e / 2. Axis I gives the plane of the axes a and b that follow it the
/// strains e_ba, e_ab and e_aa + e_bb, which vary with xi_I, and the strain e_4I, which
/// varies with xi_a xi_b.
template <class R, bool Orthogonal>
class hourglass_stiffness {
 public:
  /// For a box: `h` holds 1 / (edge sum)^2.
  template <class Moduli>
  SUTURE_INLINE hourglass_stiffness(const vec3<R>& h, const Moduli& m, const R& volume) {
    static_assert(Orthogonal);
    for (int i = 0; i < 3; ++i) {
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      const R weight = volume * m.plane_third;
      plane_[i].aa = weight * h[a] * h[a];
      plane_[i].bb = weight * h[b] * h[b];
      const R both = h[a] * h[b] * volume;
      plane_[i].ab = both * m.cross_third;
      plane_[i].cc = both * m.shear_third;
      twist_[i] = volume * m.young_ninth * h[i] * h[i];
    }
  }
  /// For a parallelepiped: `g` holds the products of its edge sums.
  template <class Moduli>
  SUTURE_INLINE hourglass_stiffness(const sym3<R>& g, const Moduli& m, const R& volume) {
    static_assert(!Orthogonal);
    for (int i = 0; i < 3; ++i) {
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      const R aa = g(a, a), bb = g(b, b), ab = g(a, b);
      plane_[i] = plane_stress(aa, bb, ab, m, volume * (1.0 / 3));
      // Stress s on ii, t on ab, such that the strain of ab is 0: t = -s skew / shear.
      const R skew = (1 + m.poisson) * (g(i, a) * g(i, b)) - m.poisson * (ab * g(i, i));
      const R shear = (1 + m.poisson) * (aa * bb) + (1 - m.poisson) * (ab * ab);
      twist_[i] = volume * m.young_ninth * shear *
                  reciprocal(g(i, i) * g(i, i) * shear - 2.0 * (skew * skew));
    }
  }

  /// That of the strain e_4I.
  SUTURE_INLINE const R& twist(int i) const { return twist_[i]; }

  /// s = K e.
  template <class T>
  SUTURE_INLINE void stress(const vec3<T> (&e)[4], vec3<T> (&s)[4]) const {
    T shear[3];
    for (int i = 0; i < 3; ++i) {
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      const plane& k = plane_[i];
      const T& on_a = e[b][a];
      const T& on_b = e[a][b];
      const T on_ab = e[a][a] + e[b][b];
      s[b][a] = k.aa * on_a + k.ab * on_b;
      s[a][b] = k.ab * on_a + k.bb * on_b;
      shear[i] = k.cc * on_ab;
      if constexpr (!Orthogonal) {
        s[b][a] += k.ac * on_ab;
        s[a][b] += k.bc * on_ab;
        shear[i] += k.ac * on_a + k.bc * on_b;
      }
      s[3][i] = twist_[i] * e[3][i];
    }
    for (int k = 0; k < 3; ++k) s[k][k] = shear[(k + 1) % 3] + shear[(k + 2) % 3];
  }

 private:
  struct plane {
    R aa, bb, ab, cc, ac, bc;  // strains 11, 22 and twice 12; boxes have no ac, bc
  };
  /// Plane stress in the plane of two edges with the products aa, bb, ab.
  template <class Moduli>
  static SUTURE_INLINE plane plane_stress(const R& aa, const R& bb, const R& ab, const Moduli& m,
                                          const R& weight) {
    const R inverse = reciprocal(aa * bb - ab * ab);
    const R h11 = bb * inverse, h22 = aa * inverse, h12 = -ab * inverse;
    const R normal = weight * m.plane, cross = weight * (m.plane * m.poisson),
            shear = weight * m.shear;
    return {normal * h11 * h11,
            normal * h22 * h22,
            cross * h11 * h22 + 2.0 * shear * h12 * h12,
            cross * h12 * h12 + shear * (h11 * h22 + h12 * h12),
            normal * h11 * h12,
            normal * h22 * h12};
  }

  plane plane_[3];
  R twist_[3];
};

// ------------------------------------------------------------- rest shape --
// A rest shape provides its volume, the stiffness, and
//   separate(modes)        replaces the hourglasses of a current shape by g
//   unite(pull)            the transpose, for derivatives of the energy
//   F(modes)               the mean gradient
//   add_flux(P, pull)      adds the derivatives of V W by the modes
//   lower(v)               E'E v
//   back(v), forth(v)      E^-1 v, E^-T v
// and core, the part of it that the hourglass energy reads.

/// A box along the axes.
template <class R>
struct box_rest {
  using core = box_rest;
  static constexpr bool is_box = true;
  vec3<R> inverse;  ///< of the edge sums
  vec3<R> metric;   ///< their squares
  R volume;
  hourglass_stiffness<R, true> stiffness;

  template <class Moduli, class Share>
  SUTURE_INLINE static box_rest of(const vec3<R>& inverse, const Moduli& m, const Share& share) {
    const vec3<R> sum{reciprocal(inverse[0]), reciprocal(inverse[1]), reciprocal(inverse[2])};
    const R volume = sum[0] * sum[1] * sum[2] * (1.0 / 64);
    return {inverse, squares(sum), volume, {squares(inverse), m, volume * share}};
  }

  template <class T>
  SUTURE_INLINE void separate(nodal_modes<T>&) const {}
  template <class T>
  SUTURE_INLINE void unite(nodal_modes<T>&) const {}
  template <class T>
  SUTURE_INLINE mat3<T> F(const nodal_modes<T>& now) const {
    const vec3<T>(&A)[3] = now.edge.column;
    return {{A[0] * inverse[0], A[1] * inverse[1], A[2] * inverse[2]}};
  }
  template <class T>
  SUTURE_INLINE void add_flux(const mat3<T>& P, nodal_modes<T>& pull) const {
    for (int i = 0; i < 3; ++i) pull.edge.column[i] += P.column[i] * (volume * inverse[i]);
  }
  template <class T>
  SUTURE_INLINE vec3<T> lower(const vec3<T>& v) const {
    return {v[0] * metric[0], v[1] * metric[1], v[2] * metric[2]};
  }
  template <class T>
  SUTURE_INLINE vec3<T> back(const vec3<T>& v) const {
    return {v[0] * inverse[0], v[1] * inverse[1], v[2] * inverse[2]};
  }
  template <class T>
  SUTURE_INLINE vec3<T> forth(const vec3<T>& v) const {
    return back(v);
  }

 private:
  static SUTURE_INLINE vec3<R> squares(const vec3<R>& v) {
    return {v[0] * v[0], v[1] * v[1], v[2] * v[2]};
  }
};

/// Any parallelepiped.
template <class R>
struct parallelepiped_rest {
  using core = parallelepiped_rest;
  static constexpr bool is_box = false;
  mat3<R> inverse;  ///< E^-1
  R volume;
  sym3<R> metric;  ///< E'E
  hourglass_stiffness<R, false> stiffness;

  /// `edges` holds the edge sums E.
  template <class Moduli, class Share>
  SUTURE_INLINE parallelepiped_rest(const mat3<R>& edges, const mat3<R>& inverse_edges, const R& v,
                                    const Moduli& m, const Share& share)
      : inverse(inverse_edges),
        volume(v),
        metric(squares(edges)),
        stiffness(metric, m, v * share) {}

  template <class T>
  SUTURE_INLINE void separate(nodal_modes<T>&) const {}
  template <class T>
  SUTURE_INLINE void unite(nodal_modes<T>&) const {}
  template <class T>
  SUTURE_INLINE mat3<T> F(const nodal_modes<T>& now) const {
    return now.edge * inverse;
  }
  template <class T>
  SUTURE_INLINE mat3<T> flux(const mat3<T>& P) const {
    return P * (transpose(inverse) * volume);
  }
  template <class T>
  SUTURE_INLINE void add_flux(const mat3<T>& P, nodal_modes<T>& pull) const {
    pull.edge += flux(P);
  }
  template <class T>
  SUTURE_INLINE vec3<T> lower(const vec3<T>& v) const {
    const auto row = [&](int i) SUTURE_DETAIL_INLINED {
      return metric(i, 0) * v[0] + metric(i, 1) * v[1] + metric(i, 2) * v[2];
    };
    return {row(0), row(1), row(2)};
  }
  template <class T>
  SUTURE_INLINE vec3<T> back(const vec3<T>& v) const {
    const auto row = [&](int i) SUTURE_DETAIL_INLINED {
      return inverse(i, 0) * v[0] + inverse(i, 1) * v[1] + inverse(i, 2) * v[2];
    };
    return {row(0), row(1), row(2)};
  }
  template <class T>
  SUTURE_INLINE vec3<T> forth(const vec3<T>& v) const {
    const auto row = [&](int i) SUTURE_DETAIL_INLINED {
      return inverse(0, i) * v[0] + inverse(1, i) * v[1] + inverse(2, i) * v[2];
    };
    return {row(0), row(1), row(2)};
  }

 private:
  static SUTURE_INLINE sym3<R> squares(const mat3<R>& m) {
    const auto& e = m.column;
    return {dot(e[0], e[0]), dot(e[1], e[1]), dot(e[2], e[2]),
            dot(e[0], e[1]), dot(e[1], e[2]), dot(e[0], e[2])};
  }
};

/// Any hexahedron. In the frame of its mean edges the mean of grad h_k is
///   beta_1 = (-gamma_2y - gamma_3z, gamma_2x, gamma_3x) / 3v, and cyclically; beta_4 = 0,
///   v = 1 - sum_I e_I . (gamma_I+1 x gamma_I+2) / 3 = V / det J at the centre,
/// and F = (A + sum_k g_k (x) beta_k) E^-1.
template <class R>
struct hexahedron_rest : parallelepiped_rest<R> {
  vec3<R> gamma[4], beta[3];

  template <class Moduli, class Share>
  static SUTURE_INLINE hexahedron_rest of(const vec3<R> (&X)[8], const Moduli& m,
                                          const Share& share) {
    const nodal_modes<R> rest = modes_of(X);
    const mat3<R> cof = cofactor(rest.edge);
    const R d = dot(rest.edge.column[0], cof.column[0]);
    const mat3<R> inverse = transpose(cof) * reciprocal(d);
    vec3<R> gamma[4];
    for (int k = 0; k < 4; ++k) gamma[k] = inverse * rest.hourglass[k];
    return {rest.edge, inverse, d * (1.0 / 64), gamma, m, share};
  }

  template <class T>
  SUTURE_INLINE void separate(nodal_modes<T>& now) const {
    for (int k = 0; k < 4; ++k) now.hourglass[k] -= now.edge * gamma[k];
  }
  template <class T>
  SUTURE_INLINE void unite(nodal_modes<T>& pull) const {
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) pull.edge.column[i] -= pull.hourglass[k] * gamma[k][i];
  }
  template <class T>
  SUTURE_INLINE mat3<T> F(const nodal_modes<T>& now) const {
    mat3<T> A = now.edge;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) A.column[i] += now.hourglass[k] * beta[k][i];
    return A * this->inverse;
  }
  template <class T>
  SUTURE_INLINE void add_flux(const mat3<T>& P, nodal_modes<T>& pull) const {
    const mat3<T> flux = this->flux(P);
    pull.edge += flux;
    for (int k = 0; k < 3; ++k) pull.hourglass[k] += flux * beta[k];
  }

 private:
  template <class Moduli, class Share>
  SUTURE_INLINE hexahedron_rest(const mat3<R>& edges, const mat3<R>& inverse_edges,
                                const R& centre_volume, const vec3<R> (&g)[4], const Moduli& m,
                                const Share& share)
      : parallelepiped_rest<R>(edges, inverse_edges, centre_volume * ratio(g), m, share),
        gamma{g[0], g[1], g[2], g[3]} {
    const R third = (1.0 / 3) * reciprocal(ratio(g));
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      beta[k][k] = -third * (g[a][a] + g[b][b]);
      beta[k][a] = third * g[a][k];
      beta[k][b] = third * g[b][k];
    }
  }
  /// v
  static SUTURE_INLINE R ratio(const vec3<R> (&g)[4]) {
    R sum(0.0);
    for (int i = 0; i < 3; ++i) sum += cross(g[(i + 1) % 3], g[(i + 2) % 3])[i];
    return 1.0 - sum * (1.0 / 3);
  }
};

// ----------------------------------------------------------------- energy --

namespace detail {

/// e_kI = A_I . g_k, the hourglass strains of F.
template <class T>
SUTURE_INLINE void stretched(const nodal_modes<T>& now, vec3<T> (&e)[4]) {
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i) e[k][i] = dot(now.edge.column[i], now.hourglass[k]);
}

/// A^-T, and p_k = A^-1 g_k.
template <class T>
SUTURE_INLINE mat3<T> pulled_back(const nodal_modes<T>& now, vec3<T> (&p)[4]) {
  const mat3<T> cof = cofactor(now.edge);
  const mat3<T> back = cof * reciprocal(dot(now.edge.column[0], cof.column[0]));
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i) p[k][i] = dot(back.column[i], now.hourglass[k]);
  return back;
}

/// The derivatives of Es(e).
template <class T, class Rest>
SUTURE_INLINE nodal_modes<T> pull_of_stretched(const nodal_modes<T>& now, const Rest& rest) {
  vec3<T> e[4], s[4];
  stretched(now, e);
  rest.stiffness.stress(e, s);
  nodal_modes<T> pull;
  for (int k = 0; k < 4; ++k) pull.hourglass[k] = now.edge * s[k];
  for (int i = 0; i < 3; ++i) {
    const vec3<T>(&g)[4] = now.hourglass;
    pull.edge.column[i] = g[0] * s[0][i] + g[1] * s[1][i] + g[2] * s[2][i] + g[3] * s[3][i];
  }
  return pull;
}

/// Adds the derivatives of Es(e').
template <class T, class Rest>
SUTURE_INLINE void add_pull_of_pulled_back(const nodal_modes<T>& now, const Rest& rest,
                                           nodal_modes<T>& pull) {
  vec3<T> p[4], e[4], s[4];
  const mat3<T> back = pulled_back(now, p);
  for (int k = 0; k < 4; ++k) e[k] = rest.lower(p[k]);
  rest.stiffness.stress(e, s);
  for (int k = 0; k < 4; ++k) {
    const vec3<T> y = back * rest.lower(s[k]);
    pull.hourglass[k] += y;
    for (int i = 0; i < 3; ++i) pull.edge.column[i] -= y * p[k][i];
  }
}

/// E_I . g_k, the hourglass strains of a linear law.
template <class T, class Rest>
SUTURE_INLINE void linear(const nodal_modes<T>& now, const Rest& rest, vec3<T> (&e)[4]) {
  for (int k = 0; k < 4; ++k) e[k] = rest.lower(rest.back(now.hourglass[k]));
}
template <class T, class Rest>
SUTURE_INLINE nodal_modes<T> pull_of_linear(const nodal_modes<T>& now, const Rest& rest) {
  vec3<T> e[4], s[4];
  linear(now, rest, e);
  rest.stiffness.stress(e, s);
  nodal_modes<T> pull;
  for (int k = 0; k < 4; ++k) pull.hourglass[k] = rest.forth(rest.lower(s[k]));
  pull.edge = {};
  return pull;
}

template <class T, class Rest>
SUTURE_INLINE T twice_energy(const vec3<T> (&e)[4], const Rest& rest) {
  vec3<T> s[4];
  rest.stiffness.stress(e, s);
  return (dot(e[0], s[0]) + dot(e[1], s[1])) + (dot(e[2], s[2]) + dot(e[3], s[3]));
}

}  // namespace detail

/// What the hourglass energy is made of: Es(e) and Es(e'), Es(e), or Es of the linear strains.
enum class hourglass_form { both, stretched, linear };
/// Share of Es in each part of the hourglass energy.
template <hourglass_form Form>
inline constexpr double hourglass_share = Form == hourglass_form::both ? 0.5 : 1.0;

/// Edges and g of the nodes x.
template <class T, class Rest>
SUTURE_INLINE nodal_modes<T> separated_modes(const vec3<T> (&x)[8], const Rest& rest) {
  nodal_modes<T> now = modes_of(x);
  rest.separate(now);
  return now;
}

/// Hourglass energy. `core` has its stiffness times hourglass_share<Form>. A function of its own,
/// as it is not computed in every step.
template <hourglass_form Form, class T, class Core>
[[gnu::noinline]] T hourglass_energy(const nodal_modes<T>& now, const Core& core) {
  vec3<T> e[4];
  if constexpr (Form == hourglass_form::linear)
    detail::linear(now, core, e);
  else
    detail::stretched(now, e);
  T twice = detail::twice_energy(e, core);
  if constexpr (Form == hourglass_form::both) {
    vec3<T> p[4];
    detail::pulled_back(now, p);
    for (int k = 0; k < 4; ++k) e[k] = core.lower(p[k]);
    twice += detail::twice_energy(e, core);
  }
  return 0.5 * twice;
}

/// The derivatives of that energy.
template <hourglass_form Form, class T, class Core>
SUTURE_INLINE nodal_modes<T> hourglass_pull(const nodal_modes<T>& now, const Core& core) {
  if constexpr (Form == hourglass_form::linear) return detail::pull_of_linear(now, core);
  nodal_modes<T> pull = detail::pull_of_stretched(now, core);
  if constexpr (Form == hourglass_form::both) detail::add_pull_of_pulled_back(now, core, pull);
  return pull;
}
/// The same as a function of its own: tangents on all shapes but boxes call it.
template <hourglass_form Form, class T, class Core>
[[gnu::noinline]] nodal_modes<T> called_hourglass_pull(const nodal_modes<T>& now,
                                                       const Core& core) {
  return hourglass_pull<Form>(now, core);
}

/// Nodal forces of a law that gives P for F, and of the hourglass energy.
template <hourglass_form Form, class T, class Rest, class Law>
SUTURE_INLINE void mean_gradient_force(const vec3<T> (&x)[8], const Rest& rest, Law&& law,
                                       vec3<T> (&f)[8]) {
  const nodal_modes<T> now = separated_modes(x, rest);
  const typename Rest::core& core = rest;
  nodal_modes<T> pull;
  if constexpr (is_dual<T> && !Rest::is_box)
    pull = called_hourglass_pull<Form>(now, core);
  else
    pull = hourglass_pull<Form>(now, core);
  rest.add_flux(law(rest.F(now)), pull);
  rest.unite(pull);
  scatter(pull, f);
}

}  // namespace suture

#endif
