// SPDX-License-Identifier: MIT
//
// suture/bending_samples.hpp - the mean-gradient hexahedron of mean_gradient.hpp for laws whose
// response changes: it evaluates the law where bending strains the material.
//
// A hexahedron bends by the hourglasses h_a = xi_b xi_i and h_b = xi_i xi_a: strains that vary
// with xi_i, where a and b follow i. At the centres of the two faces normal to axis i, they are
// those of the gradient H_i = g_a (x) r_b + g_b (x) r_a, r the rows of E^-1. With p_k = F^-1 g_k,
// the strains along the rest edges in the plane of E_a and E_b are
//   E_b . p_a,   E_a . p_b,   E_a . p_a + E_b . p_b (twice the shear);
// the shears with axis i, which no bent body has, are left out. The strain S_i consists of the
// strains in the plane and of those out of it by which the law at rest has no stress on the plane.
// The six samples are
//   F+- = F (I +- S_i + S_i^2 / 2)
// whose volume is det F exp(+- tr S_i), but for terms of the third order; their energy is
//   V / 6 sum of W(F+-)
// (Irons' rule: exact for strains that vary with one axis each). The twist h_4, which no sample
// sees, has the energy that it has in mean_gradient.hpp.
//
// For elastic laws at rest, the tangent is that of mean_gradient.hpp. The samples change places
// under rotations and mirrors by right angles. The force is the derivative of the energy at
// constant states and fields of the samples.
#ifndef SUTURE_BENDING_SAMPLES_HPP
#define SUTURE_BENDING_SAMPLES_HPP

#include "suture/mean_gradient.hpp"

namespace suture {

/// Sample 2 i + s lies at xi_i = 2 s - 1.
inline constexpr int bending_samples = 6;

/// The bending strains of a box along the axes whose law is isotropic at rest.
template <class R>
struct box_bending {
  vec3<R> inverse;  ///< of the edge sums
  R ratio;          ///< nu / (1 - nu): S_ii is that of plane stress

  /// S_i of p.
  template <class T>
  SUTURE_INLINE sym3<T> strain(int i, const vec3<T>& p_a, const vec3<T>& p_b) const {
    const int a = (i + 1) % 3, b = (i + 2) % 3;
    sym3<T> S{};
    S(a, a) = p_b[a] * inverse[a];
    S(b, b) = p_a[b] * inverse[b];
    S(a, b) = 0.5 * (p_a[a] * inverse[b] + p_b[b] * inverse[a]);
    S(i, i) = -ratio * (S(a, a) + S(b, b));
    return S;
  }
  /// The transpose: adds dE/dp of the symmetric matrix D = dE/dS_i.
  template <class T>
  SUTURE_INLINE void pull(int i, const sym3<T>& D, vec3<T>& p_a, vec3<T>& p_b) const {
    const int a = (i + 1) % 3, b = (i + 2) % 3;
    const T of_axis = ratio * D(i, i);
    p_b[a] += (D(a, a) - of_axis) * inverse[a];
    p_a[b] += (D(b, b) - of_axis) * inverse[b];
    p_a[a] += D(a, b) * inverse[b];
    p_b[b] += D(a, b) * inverse[a];
  }
};

/// Those of any parallelepiped: S_i by the three strains along the edges a and b. With the normal n
/// of their plane and the vectors r of the plane with r_a . E_a = 1, r_a . E_b = 0, the strain
/// along E_a alone is r_a (x) r_a. `out(n, B)` gives the w of a strain B in the plane, by which
/// B + sym(n (x) w) has no stress on n.
template <class R>
struct skew_bending {
  mat3<R> edges;
  sym3<R> by[3][3];

  template <class Out>
  SUTURE_INLINE skew_bending(const mat3<R>& edge_sums, Out&& out) : edges(edge_sums) {
    for (int i = 0; i < 3; ++i) {
      const vec3<R>&a = edges.column[(i + 1) % 3], &b = edges.column[(i + 2) % 3];
      const vec3<R> normal = cross(a, b), n = normal * rsqrt(dot(normal, normal));
      const R inverse = rsqrt(dot(normal, normal));
      const vec3<R> r_a = cross(b, n) * inverse, r_b = cross(n, a) * inverse;
      const auto set = [&](int k, const vec3<R>& u, const vec3<R>& v) {
        const sym3<R> B = symmetric_product(u, v);
        by[i][k] = B + symmetric_product(n, out(n, B));
      };
      set(0, r_a, r_a);
      set(1, r_b, r_b);
      set(2, r_a, r_b);
    }
  }
  static SUTURE_INLINE sym3<R> symmetric_product(const vec3<R>& u, const vec3<R>& v) {
    return {u[0] * v[0],
            u[1] * v[1],
            u[2] * v[2],
            0.5 * (u[0] * v[1] + u[1] * v[0]),
            0.5 * (u[1] * v[2] + u[2] * v[1]),
            0.5 * (u[0] * v[2] + u[2] * v[0])};
  }

  template <class T>
  SUTURE_INLINE sym3<T> strain(int i, const vec3<T>& p_a, const vec3<T>& p_b) const {
    const vec3<R>&a = edges.column[(i + 1) % 3], &b = edges.column[(i + 2) % 3];
    return by[i][0] * dot(a, p_b) + by[i][1] * dot(b, p_a) + by[i][2] * (dot(a, p_a) + dot(b, p_b));
  }
  template <class T>
  SUTURE_INLINE void pull(int i, const sym3<T>& D, vec3<T>& p_a, vec3<T>& p_b) const {
    const vec3<R>&a = edges.column[(i + 1) % 3], &b = edges.column[(i + 2) % 3];
    const T aa = dot(D, by[i][0]), bb = dot(D, by[i][1]), ab = dot(D, by[i][2]);
    for (int k = 0; k < 3; ++k) {
      p_a[k] += bb * b[k] + ab * a[k];
      p_b[k] += aa * a[k] + ab * b[k];
    }
  }
};

/// w of skew_bending for an isotropic law: - ratio tr(B) n.
template <class R>
struct isotropic_out_of_plane {
  R ratio;
  SUTURE_INLINE vec3<R> operator()(const vec3<R>& n, const sym3<R>& B) const {
    return n * (-ratio * trace(B));
  }
};
/// For any law, from its stiffness at rest: C_IJ gives the stress I by the strain J (XX YY ZZ XY YZ
/// XZ, shears doubled), J >= I. A w = - (C B) n, A u = C sym(n (x) u) n.
template <class R>
struct anisotropic_out_of_plane {
  R C[21];

  SUTURE_INLINE vec3<R> operator()(const vec3<R>& n, const sym3<R>& B) const {
    vec3<R> unit[3] = {
        {R(1.0), R(0.0), R(0.0)}, {R(0.0), R(1.0), R(0.0)}, {R(0.0), R(0.0), R(1.0)}};
    mat3<R> A;
    for (int k = 0; k < 3; ++k)
      A.column[k] = stress(skew_bending<R>::symmetric_product(n, unit[k])) * n;
    return inverse(symmetric(A)) * (stress(B) * n) * R(-1.0);
  }
  SUTURE_INLINE sym3<R> stress(const sym3<R>& strain) const {
    sym3<R> s;
    for (int i = 0; i < 6; ++i) {
      s.c[i] = R(0.0);
      for (int j = 0; j < 6; ++j) s.c[i] += C[place(i, j)] * ((j < 3 ? 1.0 : 2.0) * strain.c[j]);
    }
    return s;
  }
  static constexpr int place(int i, int j) {
    return i <= j ? i * 6 - i * (i - 1) / 2 + j - i : place(j, i);
  }
};

namespace detail {

/// F^-T. For laws that survive inversion, finite at det F = 0, where the bending strains lose their
/// meaning: J (or what replaces it) is never below a tenth, and J within 1 % from J = 0.5 on.
template <hourglass_form Form, class T>
SUTURE_INLINE mat3<T> transposed_inverse(const mat3<T>& F) {
  const mat3<T> cof = cofactor(F);
  const T J = dot(F.column[0], cof.column[0]);
  if constexpr (Form == hourglass_form::both) return cof * reciprocal(J);
  return cof * reciprocal(0.5 * (J + sqrt(J * J + 0.01)));
}

/// Adds to the pulls, from dE/dp, those of p_k = F^-1 g_k. With B = F^-T: dp = B'(dg - dF p).
/// With C = cof F and j(J) in place of J, p = C'g / j, and both are differentiated.
template <hourglass_form Form, class T, class E>
SUTURE_INLINE void add_pull_of_p(const E& e, const vec3<T> (&pull_p)[4], const T& inverse_volume,
                                 nodal_modes<T>& pull, mat3<T>& P) {
  mat3<T> of_F{};
  for (int k = 0; k < 4; ++k) {
    const vec3<T> y = e.back * pull_p[k];
    pull.hourglass[k] = k < 3 ? y : pull.hourglass[k] + y;
    if constexpr (Form == hourglass_form::both)
      for (int i = 0; i < 3; ++i) of_F.column[i] += y * (-e.p[k][i]);
  }
  if constexpr (Form == hourglass_form::stretched) {
    const mat3<T> C = cofactor(e.F);
    const vec3<T>(&F)[3] = e.F.column, (&g)[4] = e.now.hourglass;
    const T J = dot(F[0], C.column[0]), root = sqrt(J * J + 0.01), inverse = 2.0 / (J + root);
    mat3<T> of_C{};
    T of_j(0.0);
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 3; ++i) of_C.column[i] += g[k] * (pull_p[k][i] * inverse);
      of_j -= dot(pull_p[k], e.p[k]) * inverse;
    }
    of_F = C * (of_j * 0.5 * (1.0 + J / root));
    for (int i = 0; i < 3; ++i) {
      const int a = (i + 1) % 3, b = (i + 2) % 3;  // C_i = F_a x F_b
      of_F.column[a] += cross(F[b], of_C.column[i]);
      of_F.column[b] += cross(of_C.column[i], F[a]);
    }
  }
  P += of_F * inverse_volume;
}

/// What an element and its samples share.
template <class T>
struct bent_element {
  nodal_modes<T> now;
  mat3<T> F, back;  ///< F^-T
  vec3<T> p[4];
};

template <hourglass_form Form, class T, class Rest>
SUTURE_INLINE bent_element<T> bent(const vec3<T> (&x)[8], const Rest& rest) {
  bent_element<T> e;
  e.now = separated_modes(x, rest);
  e.F = rest.F(e.now);
  if constexpr (Form == hourglass_form::linear) {
    for (int k = 0; k < 4; ++k) e.p[k] = e.now.hourglass[k];
  } else {
    e.back = transposed_inverse<Form>(e.F);
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) e.p[k][i] = dot(e.back.column[i], e.now.hourglass[k]);
  }
  return e;
}

/// I +- S + S^2 / 2
template <class T>
struct stretches {
  sym3<T> less, more;
  SUTURE_INLINE explicit stretches(const sym3<T>& S) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) {
        const T even = 0.5 * (S(i, 0) * S(0, j) + S(i, 1) * S(1, j) + S(i, 2) * S(2, j)) +
                       (i == j ? 1.0 : 0.0);
        more(i, j) = even + S(i, j);
        less(i, j) = even - S(i, j);
      }
  }
};

/// Calls visit(F, number) for the samples.
template <hourglass_form Form, class T, class Bending, class Visit>
SUTURE_INLINE void for_bending_samples(const bent_element<T>& e, const Bending& bending,
                                       Visit&& visit) {
  SUTURE_DETAIL_ROLLED
  for (int i = 0; i < 3; ++i) {
    const sym3<T> S = bending.strain(i, e.p[(i + 1) % 3], e.p[(i + 2) % 3]);
    if constexpr (Form == hourglass_form::linear) {
      visit(e.F - full(S), 2 * i);
      visit(e.F + full(S), 2 * i + 1);
    } else {
      const stretches<T> U(S);
      visit(e.F * U.less, 2 * i);
      visit(e.F * U.more, 2 * i + 1);
    }
  }
}

/// The strains of the twist: A_I . g_4, and E_I . F^-1 g_4.
template <class T>
SUTURE_INLINE vec3<T> stretched_twist(const nodal_modes<T>& now) {
  const vec3<T>&g = now.hourglass[3], (&A)[3] = now.edge.column;
  return {dot(A[0], g), dot(A[1], g), dot(A[2], g)};
}
template <class T, class Core>
SUTURE_INLINE vec3<T> pulled_back_twist(const bent_element<T>& e, const Core& core) {
  return core.lower(core.back(e.p[3]));
}

}  // namespace detail

/// The energy of the twist; `core` has its stiffness times hourglass_share<Form>.
template <hourglass_form Form, class T, class Core>
SUTURE_INLINE T twist_energy(const detail::bent_element<T>& e, const Core& core) {
  T twice(0.0);
  const auto add = [&](const vec3<T>& strain) {
    for (int i = 0; i < 3; ++i) twice += core.stiffness.twist(i) * (strain[i] * strain[i]);
  };
  if constexpr (Form != hourglass_form::linear) add(detail::stretched_twist(e.now));
  if constexpr (Form != hourglass_form::stretched) add(detail::pulled_back_twist(e, core));
  return 0.5 * twice;
}

/// Nodal forces of a law(F, number of the sample) that gives P, and of the twist.
template <hourglass_form Form, class T, class Rest, class Bending, class Law>
SUTURE_INLINE void sampled_force(const vec3<T> (&x)[8], const Rest& rest, const Bending& bending,
                                 Law&& law, vec3<T> (&f)[8]) {
  constexpr bool is_linear = Form == hourglass_form::linear;
  const detail::bent_element<T> e = detail::bent<Form>(x, rest);
  const mat3<T> Ft = transpose(e.F);
  mat3<T> sum{};  // dE/dF at constant p, and dE/dp, of six times the energy per volume
  vec3<T> pull_p[4]{};
  SUTURE_DETAIL_ROLLED
  for (int i = 0; i < 3; ++i) {
    const int a = (i + 1) % 3, b = (i + 2) % 3;
    const sym3<T> S = bending.strain(i, e.p[a], e.p[b]);
    sym3<T> D;
    if constexpr (is_linear) {
      const mat3<T> less = law(e.F - full(S), 2 * i), more = law(e.F + full(S), 2 * i + 1);
      sum += less + more;
      D = symmetric(more - less);
    } else {
      const detail::stretches<T> U(S);
      const mat3<T> less = law(e.F * U.less, 2 * i), more = law(e.F * U.more, 2 * i + 1);
      sum += less * U.less + more * U.more;
      // dU = +-dS + (S dS + dS S) / 2
      const mat3<T> even = full(symmetric(Ft * (more + less)));
      D = symmetric(Ft * (more - less) + even * S);
    }
    bending.pull(i, D, pull_p[a], pull_p[b]);
  }
  const typename Rest::core& core = rest;
  nodal_modes<T> pull;
  pull.edge = {};
  pull.hourglass[3] = {};
  const T weight = rest.volume * T(1.0 / 6);
  for (int k = 0; k < 3; ++k) pull_p[k] = pull_p[k] * weight;
  const auto stress_of = [&](const vec3<T>& strain) SUTURE_DETAIL_INLINED {
    return vec3<T>{strain[0] * core.stiffness.twist(0), strain[1] * core.stiffness.twist(1),
                   strain[2] * core.stiffness.twist(2)};
  };
  if constexpr (!is_linear) {
    const vec3<T> s = stress_of(detail::stretched_twist(e.now));
    pull.hourglass[3] = e.now.edge * s;
    for (int i = 0; i < 3; ++i) pull.edge.column[i] = e.now.hourglass[3] * s[i];
  }
  if constexpr (Form != hourglass_form::stretched)
    pull_p[3] = core.forth(core.lower(stress_of(detail::pulled_back_twist(e, core))));
  mat3<T> P = sum * T(1.0 / 6);
  if constexpr (is_linear) {
    for (int k = 0; k < 4; ++k) pull.hourglass[k] = pull_p[k];
  } else {
    detail::add_pull_of_p<Form>(e, pull_p, T(reciprocal(rest.volume)), pull, P);
  }
  rest.add_flux(P, pull);
  rest.unite(pull);
  scatter(pull, f);
}

}  // namespace suture

#endif
