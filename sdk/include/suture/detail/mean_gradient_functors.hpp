// SPDX-License-Identifier: MIT
//
// suture/detail/mean_gradient_functors.hpp - the mean-gradient hexahedra of
// continuum.hpp. Authors need not read it.
#ifndef SUTURE_DETAIL_MEAN_GRADIENT_FUNCTORS_HPP
#define SUTURE_DETAIL_MEAN_GRADIENT_FUNCTORS_HPP

#include "suture/detail/law_functor.hpp"
#include "suture/detail/rest_stiffness.hpp"
#include "suture/mean_gradient_parts.hpp"

namespace suture::detail {

/// Derives the moduli of the hourglass energy, if the scene chooses this element.
template <class M, class Material>
void prepare_element(const setup& p, const Material& material, rest_moduli& moduli) {
  if (is_trilinear<M>(p)) return;
  const auto near_rest = lame_at_rest<M, double>(material);
  const lame& constants = near_rest.mean;
  if (!is_stable(constants))
    return p.refuse(
        "no-stiffness-at-rest",
        "the law has no positive stiffness at F = I (lambda = " + std::to_string(constants.lambda) +
            " Pa, mu = " + std::to_string(constants.mu) +
            " Pa), by which mean-gradient elements resist hourglassing: check the parameters, or "
            "set \"element\": \"trilinear\"");
  if constexpr (has_points<M>)
    if (M::points(p) != 2)
      p.warn("points-not-used",
             "mean-gradient elements evaluate the law at one point: the number of Gauss points "
             "has no effect");
  if (!is_sampled<M> && near_rest.spread > 0.01)
    p.warn("not-smooth-at-rest",
           "the law has more than one tangent at F = I: its moduli differ by up to " +
               std::to_string(std::lround(100 * near_rest.spread)) +
               " % with the direction of a small strain. Mean-gradient elements resist "
               "hourglassing with the mean, also where one of them holds: refine the mesh over "
               "the height of what bends, or set \"element\": \"trilinear\"");
  moduli = moduli_of(constants);
}

/// What parallelepipeds and general hexahedra have in common. `Shape` provides
/// with_rest(cell, work), which calls work(rest shape).
template <class M, class Shape>
struct mean_gradient_functor : law_functor<M, Shape, mean_points<M>> {
  static constexpr const char* doc = "Nodal forces of the stress at the mean gradient";
  static constexpr bool added_element_constants = varies<M>;
  static constexpr hourglass_form form = hourglass_form_of<M>();
  static constexpr double share = hourglass_share<form>;

  static bool enabled(const values& p, std::uint32_t&) { return !is_trilinear<M>(p); }

  template <class Cell>
  static SUTURE_INLINE void force(const Cell& c) {
    Shape::with_rest(c, [&](const auto& rest) SUTURE_DETAIL_INLINED { force_on(c, rest); });
  }

  template <bool with_energy = true, class Cell>
  [[gnu::noinline]] static deformed_element<typename Cell::scalar, mean_points<M>> deformed(
      const Cell& c) {
    deformed_element<typename Cell::scalar, mean_points<M>> e;
    Shape::with_rest(c, [&](const auto& rest) {
      using T = typename Cell::scalar;
      vec3<T> x[8];
      mean_gradient_functor::positions(c, x);
      const typename std::decay_t<decltype(rest)>::core& core = rest;
      if constexpr (is_sampled<M>) {
        const auto now = bent<form>(x, rest);
        for_bending_samples<form>(now, bending_of(c, core), [&](const mat3<T>& F, int) {
          e.add(F, rest.volume * (1.0 / bending_samples));
        });
        if constexpr (with_energy && has_energy_density<M>)
          e.hourglass_energy = twist_energy<form>(now, core);
      } else {
        const auto now = separated_modes(x, rest);
        e.add(rest.F(now), rest.volume);
        if constexpr (with_energy && has_energy_density<M>)
          e.hourglass_energy = hourglass_energy<form>(now, core);
      }
    });
    return e;
  }

 private:
  /// One function per rest shape: inlined into one, they would spill registers.
  template <class Cell, class Rest>
  static __attribute__((noinline)) void force_on(const Cell& c, const Rest& rest) {
    using T = typename Cell::scalar;
    vec3<T> x[8], f[8];
    mean_gradient_functor::positions(c, x);
    if constexpr (is_sampled<M>) {
      const typename Rest::core& core = rest;
      sampled_force<form>(
          x, rest, bending_of(c, core),
          [&](const mat3<T>& F, int sample) { return sampled_stress(c, F, sample); }, f);
    } else {
      mean_gradient_force<form>(
          x, rest, [&](const mat3<T>& F) SUTURE_DETAIL_INLINED { return stress_at<M, 1>(c, F, 0); },
          f);
    }
    for (int n = 0; n < 8; ++n) c.force(n, f[n]);
  }
  /// One function for all samples and rest shapes.
  template <class Cell, class T>
  [[gnu::noinline]] static mat3<T> sampled_stress(const Cell& c, const mat3<T>& F, int sample) {
    return stress_at<M, bending_samples>(c, F, sample);
  }
  template <class Cell, class Core>
  static SUTURE_INLINE auto bending_of(const Cell& c, const Core& core) {
    using R = typename Cell::real;
    const auto edges = [&] {
      mat3<R> inverse_edges{};
      if constexpr (Core::is_box)
        for (int i = 0; i < 3; ++i) inverse_edges(i, i) = core.inverse[i];
      else
        inverse_edges = core.inverse;
      return inverse(inverse_edges);
    };
    if constexpr (stores_stiffness<M>) {
      anisotropic_out_of_plane<R> out;
      for (int i = 0; i < 21; ++i)
        out.C[i] = c.column(rest_stiffness_columns<M>(), i / rest_stiffness_share,
                            i % rest_stiffness_share);
      return skew_bending<R>(edges(), out);
    } else {
      const R nu(c.added_constants().poisson), ratio = nu * reciprocal(1.0 - nu);
      if constexpr (Core::is_box)
        return box_bending<R>{core.inverse, ratio};
      else
        return skew_bending<R>(edges(), isotropic_out_of_plane<R>{ratio});
    }
  }
};

template <class M>
struct mean_gradient_parallelepipeds : mean_gradient_functor<M, mean_gradient_parallelepipeds<M>> {
  static constexpr const char* name = "parallelepipeds, mean gradient";
  static constexpr std::uint32_t shape = SUTURE_PARALLELEPIPED, alternative = 2;
  static constexpr column<0> jacobian{};
  static constexpr auto cell_columns = joined(mean_columns<M>, columns(jacobian));

  template <class Cell, class Work>
  static SUTURE_INLINE void with_rest(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    const auto& m = c.added_constants();
    mat3<R> inverse_j;  // of edges, a quarter of the edge sums
    const bool is_box = all(read_inverse(c, jacobian, inverse_j) == 0.0);
    const mat3<R> sums = inverse_j * 0.25;
    constexpr double share = mean_gradient_parallelepipeds::share;
    if constexpr (has_box_path<Cell>)
      if (is_box) return work(box_rest<R>::of({sums(0, 0), sums(1, 1), sums(2, 2)}, m, share));
    work(parallelepiped_rest<R>(inverse(sums), sums, 1.0 / det(inverse_j), m, share));
  }
};

/// Those of which only a part is material.
template <class M>
struct mean_gradient_parts : mean_gradient_functor<M, mean_gradient_parts<M>> {
  static constexpr const char* name = "parts of parallelepipeds, mean gradient";
  static constexpr std::uint32_t shape = SUTURE_PARALLELEPIPED;
  static constexpr column<0> jacobian{};
  static constexpr auto cell_columns = joined(mean_columns<M>, columns(jacobian, element_part));

  template <class Cell, class Work>
  static SUTURE_INLINE void with_rest(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    const auto& m = c.added_constants();
    mat3<R> inverse_j;
    const bool is_box = all(read_inverse(c, jacobian, inverse_j) == 0.0);
    const mat3<R> sums = inverse_j * 0.25;
    const part_moments<R> part = read_part(c);
    const R share = part.fraction * R(mean_gradient_parts::share);
    if constexpr (has_part_of_box_path<Cell>)
      if (is_box) {
        part_rest<box_rest<R>, R> rest{
            box_rest<R>::of({sums(0, 0), sums(1, 1), sums(2, 2)}, m, share), part.first,
            part.second};
        rest.volume = rest.volume * part.fraction;
        return work(rest);
      }
    const R volume = part.fraction / det(inverse_j);
    constexpr double whole = mean_gradient_parts::share;
    work(part_rest<parallelepiped_rest<R>, R>{
        parallelepiped_rest<R>(inverse(sums), sums, volume, m, whole), part.first, part.second});
  }
};
template <class M>
struct functor_on_parts<mean_gradient_parallelepipeds<M>> {
  using type = mean_gradient_parts<M>;
};

template <class M>
struct mean_gradient_hexahedra : mean_gradient_functor<M, mean_gradient_hexahedra<M>> {
  static constexpr const char* name = "general hexahedra, mean gradient";
  static constexpr std::uint32_t shape = SUTURE_GENERAL, alternative = 1;
  static constexpr std::uint32_t reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
  static constexpr auto cell_columns = mean_columns<M>;

  template <class Cell, class Work>
  static SUTURE_INLINE void with_rest(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    vec3<R> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    work(hexahedron_rest<R>::of(X, c.added_constants(), mean_gradient_hexahedra::share));
  }
};

/// Those of which only a part is material.
template <class M>
struct mean_gradient_hexahedron_parts
    : mean_gradient_functor<M, mean_gradient_hexahedron_parts<M>> {
  static constexpr const char* name = "parts of general hexahedra, mean gradient";
  static constexpr std::uint32_t shape = SUTURE_GENERAL;
  static constexpr std::uint32_t reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
  static constexpr auto cell_columns = joined(mean_columns<M>, columns(element_general_part));

  template <class Cell, class Work>
  static SUTURE_INLINE void with_rest(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    vec3<R> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    const general_part<R> part = read_general_part(c);
    const R share = part.fraction * R(mean_gradient_hexahedron_parts::share);
    work(hexahedron_part_rest<R>(hexahedron_rest<R>::of(X, c.added_constants(), share), part));
  }
};
template <class M>
struct functor_on_parts<mean_gradient_hexahedra<M>> {
  using type = mean_gradient_hexahedron_parts<M>;
};

// The law contributes to the force on every node.
template <class M>
inline constexpr int nodes_to_check<mean_gradient_parallelepipeds<M>> = 1;
template <class M>
inline constexpr int nodes_to_check<mean_gradient_parts<M>> = 1;
template <class M>
inline constexpr int nodes_to_check<mean_gradient_hexahedra<M>> = 1;
template <class M>
inline constexpr int nodes_to_check<mean_gradient_hexahedron_parts<M>> = 1;

}  // namespace suture::detail

#endif
