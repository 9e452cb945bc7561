// SPDX-License-Identifier: MIT
//
// suture/continuum.hpp - a complete hyperelastic model from a law in closed form.
//
//   #include "suture/continuum.hpp"
//
//   struct NeoHooke : suture::continuum<NeoHooke> {
//     static constexpr const char *id = "neo-hooke", *doc = "Compressible neo-Hookean solid",
//       *formula = "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2",
//       *citation = "Bonet and Wood, Nonlinear Continuum Mechanics, 2008, eq. 6.27";
//     enum { mu, lambda, rho };
//     static constexpr suture::parameter parameters[] = {
//         suture::number("mu", "Pa", "shear modulus").above(0),
//         suture::number("lambda", "Pa", "first Lame constant").at_least(0),
//         suture::number("rho", "kg/m^3", "density").above(0)};
//     static double density(const suture::values& p) { return p[rho]; }
//     template <class T, class P>
//     static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p) {
//       const T ln_j = log1p(excess_J(F));  // excess: I1 - 3, J - 1
//       return 0.5 * p[mu] * (excess_I1(F) - 2.0 * ln_j) + 0.5 * p[lambda] * ln_j * ln_j;
//     }
//   };
//   SUTURE_PLUGIN("neo-hooke", "1.0", "MIT", "Neo-Hookean solid", NeoHooke)
//
// This gives forces on hexahedra (parallelepipeds on a faster path), mass, energy, exact
// tangent, stable step, and the fields "stress", "von_mises" and "energy_density".
//
// The scene chooses the hexahedron by the parameter "element", which the layer adds to
// those of the model: "mean-gradient" evaluates the law once, at the mean deformation
// gradient, and neither locks nor hourglasses (mean_gradient.hpp); "trilinear" evaluates it
// at each Gauss point.
//
// A law consists of one or both of these static function templates of the model:
//   energy(F, p) -> T        energy density W per rest volume, J/m^3
//   stress(F, p) -> mat3<T>  first Piola-Kirchhoff stress P = dW/dF, Pa
// or, in place of both, if S = lambda tr(E) I + 2 mu E (saint_venant_kirchhoff.hpp):
//   saint_venant_kirchhoff(p) -> lame    the constants; boxes then need a tenth fewer operations
// Without stress(), P is the gradient of energy() in one reverse pass (reverse.hpp), which costs
// what stress() would if energy() is declared SUTURE_INLINE, and up to nine times as much if
// not; without energy(), no energies are offered. `p` is the model's Constants if
// it declares them, else its parameters by index. Of parameters that may differ from
// element to element (per_element(), direction()), a law receives those of its element:
// p[i], p.direction(i), or `template <class R> struct Constants`; density() and
// saint_venant_kirchhoff() are then templates, too.
//
// A law with a memory has a state at each Gauss point:
//   template <class T> struct State        an aggregate of numbers T, such as sym3<T> and T
//   states[]                               suture::state(name, unit, doc, components): its parts
//                                          in their order; each is an output field
//   evolve(F, p, at)                       changes at.state from the beginning of the step to its
//                                          end, where the gradient is F
// evolve() is called before energy(F, p, at) and stress(F, p, at), which find the state of the end
// of the step in at.state; P is dW/dF at constant state. `at` also has the time and dt, s; with
// dt = 0 the state of a law that depends on rates must not change. The layer stores the state, and
// accepts or drops it with the step.
//
// A law reads fields, such as a temperature, at its points:
//   vertex_fields[]              suture::vertex_field(name, unit, doc); energy(F, p, at) and
//                                stress(F, p, at) find the values in at.field[i], and
//                                differentiate at constant fields
// and may change one field, which then is the only one:
//   release(F, p, at) -> released<T>  source and flow of the field by its value at.field, its
//                                gradient and its rate (field_point). F is not differentiated
//   field_energy(p, at) -> T     optional: the field's own energy density, J/m^3, if release()
//                                is - d(energy() + field_energy()) by the field
//   dissipation(p, at) -> T      optional, in place of it: W/m^3, of a field such as a pressure,
//                                whose release() is no such derivative. What is stored is then
//                                energy() without the field, and capacity times field^2 / 2
// Behind the field, `vertex_fields` may declare lumped_capacity(), lumped_relaxation()
// (diffusion.hpp) and rate_of_field().
//
// A model may also have
//   static constexpr suture::element_type default_element
//                                the element of scenes that name none (default:
//                                mean_gradient); element_of(p) is that of the scene
//   static constexpr bool survives_inversion
//                                true if energy and stress are finite at det F = 0 (default:
//                                true with saint_venant_kirchhoff(), otherwise false). The
//                                hourglass energy is then finite there, too
//   static constexpr bool samples_bending
//                                whether mean-gradient elements evaluate the law where bending
//                                strains it, six times per element (default: true for laws with
//                                states, fields, directions or `at`)
//   static int points(values)    Gauss points per axis, 2 (default) or 3
//   static bool stores(values)   false: the geometry of elements other than parallelepipeds
//                                is computed again at each evaluation (default: stored if
//                                there are 2 points; a quarter faster, 640 B per element)
// and the members of any model (model.hpp).
#ifndef SUTURE_CONTINUUM_HPP
#define SUTURE_CONTINUUM_HPP

#include "suture/detail/mean_gradient_functors.hpp"
#include "suture/kinematics.hpp"
#include "suture/mass.hpp"

namespace suture {

namespace detail {

template <class G>
inline constexpr bool is_box = false;
template <class R, int Q>
inline constexpr bool is_box<box_geometry<R, Q>> = true;
template <class R, int Q>
inline constexpr bool is_box<part_geometry<box_geometry<R, Q>, R, Q>> = true;

/// J^-1 of parallelepipeds, row-major: component 3*axis + coordinate. Entries that
/// are due to rounding (below 1e-13 of the largest) are set to zero, so that a box is
/// recognised as one.
struct inverse_jacobian {
  static constexpr int components = 9;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    vec3<typename Cell::real> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    const auto inverse_j = inverse(mean_edges(X));
    auto largest = abs(inverse_j(0, 0));
    for (int i = 1; i < 9; ++i) largest = max(largest, abs(inverse_j(i / 3, i % 3)));
    for (int i = 0; i < 9; ++i) {
      const auto entry = inverse_j(i / 3, i % 3);
      out.set(0, i, select(abs(entry) < 1e-13 * largest, 0.0 * entry, entry));
    }
  }
};

/// J^-1 at a Gauss point. Not a template of the point: eight copies take the compiler a second.
template <class Cell, class Out>
[[gnu::noinline]] void set_point_inverse(const Cell& c, const Out& out, int point) {
  vec3<typename Cell::real> X[8];
  for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
  const auto inverse_j = inverse(gradients<2>(X).at(point & 1, (point >> 1) & 1, point >> 2));
  for (int i = 0; i < 9; ++i) out.set(0, i, inverse_j(i / 3, i % 3));
}
/// The same as a contribution (two points per axis, x fastest); point_measures gives det J at
/// all eight.
template <int Point>
struct point_inverse {
  static constexpr int components = 9;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    set_point_inverse(c, out, Point);
  }
};
struct point_measures {
  static constexpr int components = 8;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    vec3<typename Cell::real> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    const auto g = gradients<2>(X);
    for (int p = 0; p < 8; ++p) out.set(0, p, det(g.at(p & 1, (p >> 1) & 1, p >> 2)));
  }
};

/// What parallelepipeds and general hexahedra have in common. `Shape` provides
/// with_geometry<Q>(cell, work), which calls work(geometry).
template <class M, class Shape>
struct continuum_functor : law_functor<M, Shape, 8> {
  static constexpr const char* doc = "Nodal forces of the stress";
  static constexpr bool single_tangent = true;

  template <class Cell>
  static SUTURE_INLINE void force(const Cell& c) {
    points(c, [&](auto q) SUTURE_DETAIL_INLINED {
      Shape::template with_geometry<q()>(c, [&](const auto& g) SUTURE_DETAIL_INLINED {
        if constexpr (is_dual<typename Cell::scalar>)
          tangent_with<q()>(c, g);
        else
          force_with<q()>(c, g);
      });
    });
  }

  static constexpr int most_points = has_points<M> ? 27 : 8;
  template <bool = true, class Cell>
  [[gnu::noinline]] static deformed_element<typename Cell::scalar, most_points> deformed(
      const Cell& c) {
    deformed_element<typename Cell::scalar, most_points> e;
    points(c, [&](auto q) {
      Shape::template with_geometry<q()>(c, [&](const auto& g) {
        vec3<typename Cell::scalar> x[8];
        continuum_functor::positions(c, x);
        for_deformations<q()>(x, g, [&](const auto& F, const auto& w) { e.add(F, w); });
      });
    });
    return e;
  }

  /// Reports elements that lock.
  template <class Cell>
  static void inspect(const Cell& c) {
    using R = std::conditional_t<varies<M>, typename Cell::real, double>;
    c.report(SUTURE_WARNING, locks(lame_at_rest<M, R>(material<M>(c)).mean), "volumetric-locking",
             "Poisson's ratio at rest is above 0.45: trilinear hexahedra are far too stiff in "
             "bending (a cantilever of 5x5x20 cells with 0.499 sags less than half as much as it "
             "should); set \"element\": \"mean-gradient\", which does not lock");
  }

 private:
  /// Tangents of laws that are called gain nothing from it, and take the compiler seconds.
  template <int Q, bool Tangent>
  static constexpr bool unrolled = Q == 2 && !(is_called<M> && (Tangent || has_state<M>));

  /// Calls work(integral_constant) with the number of Gauss points per axis.
  template <class Cell, class Work>
  static SUTURE_INLINE void points(const Cell& c, Work&& work) {
    if constexpr (has_points<M>)
      if (M::points(c.uniform_parameters()) == 3) return work(std::integral_constant<int, 3>());
    work(std::integral_constant<int, 2>());
  }

  // One function per rule and geometry: inlined into one, they would spill registers.

  template <int Q, class Cell, class Geometry>
  static __attribute__((noinline)) void force_with(const Cell& c, const Geometry& g) {
    using T = typename Cell::scalar;
    vec3<T> x[8], f[8];
    continuum_functor::positions(c, x);
    if constexpr (is_saint_venant_kirchhoff<M> && is_box<Geometry>) {
      const auto constants = M::saint_venant_kirchhoff(material<M>(c));
      saint_venant_kirchhoff_box_force<Q>(x, g, T(constants.lambda), T(constants.mu), f);
    } else {
      internal_force<Q, unrolled<Q, false>>(
          x, g,
          [&](const mat3<T>& F, int point)
              SUTURE_DETAIL_INLINED { return stress_at<M, 8>(c, F, point); },
          f);
    }
    for (int n = 0; n < 8; ++n) c.force(n, f[n]);
  }

  /// Sets the derivatives alone: c.force() takes no more.
  template <int Q, class Cell, class Geometry>
  static __attribute__((noinline)) void tangent_with(const Cell& c, const Geometry& g) {
    using R = typename Cell::real;
    vec3<dual<R>> moving[8], f[8];
    vec3<R> x[8], dx[8], df[8];
    continuum_functor::positions(c, moving);
    for (int i = 0; i < 24; ++i) {
      x[i / 3][i % 3] = moving[i / 3][i % 3].value;
      dx[i / 3][i % 3] = moving[i / 3][i % 3].derivative;
    }
    if constexpr (is_saint_venant_kirchhoff<M> && is_box<Geometry>) {
      const auto constants = M::saint_venant_kirchhoff(material<M>(c));
      saint_venant_kirchhoff_box_tangent<Q>(x, dx, g, R(constants.lambda), R(constants.mu), df);
    } else {
      internal_tangent<Q, unrolled<Q, true>>(
          x, dx, g,
          [&](const mat3<R>& F, const mat3<R>& dF, int point)
              SUTURE_DETAIL_INLINED { return stress_tangent_at<M, 8>(c, F, dF, point); },
          df);
    }
    for (int i = 0; i < 24; ++i) f[i / 3][i % 3].derivative = df[i / 3][i % 3];
    for (int n = 0; n < 8; ++n) c.force(n, f[n]);
  }
};

template <class M>
struct parallelepipeds : continuum_functor<M, parallelepipeds<M>> {
  static constexpr const char* name = "parallelepipeds";
  static constexpr std::uint32_t shape = SUTURE_PARALLELEPIPED, alternative = 2;
  static constexpr column<0> jacobian{};
  static constexpr auto cell_columns = joined(state_columns<M, 8>, columns(jacobian));

  static bool enabled(const values& p, std::uint32_t&) { return is_trilinear<M>(p); }

  template <int Q, class Cell, class Work>
  static SUTURE_INLINE void with_geometry(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    mat3<R> inverse_j;
    const bool is_box = all(read_inverse(c, jacobian, inverse_j) == 0.0);
    if constexpr (has_box_path<Cell>)
      if (is_box) return work(box_geometry<R, Q>(inverse_j));
    work(parallelepiped_geometry<R, Q>(inverse_j));
  }
};

/// Those of which only a part is material.
template <class M>
struct parallelepiped_parts : continuum_functor<M, parallelepiped_parts<M>> {
  static constexpr const char* name = "parts of parallelepipeds";
  static constexpr std::uint32_t shape = SUTURE_PARALLELEPIPED;
  static constexpr column<0> jacobian{};
  static constexpr auto cell_columns = joined(state_columns<M, 8>, columns(jacobian, element_part));

  template <int Q, class Cell, class Work>
  static SUTURE_INLINE void with_geometry(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    mat3<R> inverse_j;
    const bool is_box = all(read_inverse(c, jacobian, inverse_j) == 0.0);
    const part_moments<R> part = read_part(c);
    if constexpr (has_part_of_box_path<Cell>)
      if (is_box) return work(part_geometry<box_geometry<R, Q>, R, Q>(inverse_j, part));
    work(part_geometry<parallelepiped_geometry<R, Q>, R, Q>(inverse_j, part));
  }
};
template <class M>
struct functor_on_parts<parallelepipeds<M>> {
  using type = parallelepiped_parts<M>;
};

template <class M>
struct general_hexahedra : continuum_functor<M, general_hexahedra<M>> {
  static constexpr const char* name = "general hexahedra";
  static constexpr std::uint32_t shape = SUTURE_GENERAL, alternative = 1;
  static constexpr std::uint32_t reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
  static constexpr auto cell_columns = state_columns<M, 8>;

  static bool enabled(const values& p, std::uint32_t&) {
    return is_trilinear<M>(p) && !stores_geometry<M>(p);
  }

  template <int Q, class Cell, class Work>
  static SUTURE_INLINE void with_geometry(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    vec3<R> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    work(general_geometry<R, Q>(X));
  }
};

template <class M, int Point>
constexpr attribute inverse_at(const char* name) {
  return volume_attribute(name, "1/m", "J^-1 of the rest shape at this Gauss point, row-major", 9)
      .from_volumes(contribution<M, point_inverse<Point>>)
      .internal();
}

template <class M>
struct stored_hexahedra : continuum_functor<M, stored_hexahedra<M>> {
  static constexpr const char* name = "general hexahedra, geometry stored";
  static constexpr std::uint32_t shape = SUTURE_GENERAL, alternative = 1;
  static constexpr column_list<2, 3, 4, 5, 6, 7, 8, 9> jacobians{};
  static constexpr column<10> measures{};
  static constexpr auto cell_columns =
      joined(joined(state_columns<M, 8>, jacobians), columns(measures));

  static bool enabled(const values& p, std::uint32_t&) {
    return is_trilinear<M>(p) && stores_geometry<M>(p);
  }

  template <int Q, class Cell, class Work>
  static SUTURE_INLINE void with_geometry(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    if constexpr (Q == 2)  // otherwise the functor is not enabled
      work(make_stored_geometry<R>([&](int point, int i) { return c.column(jacobians, point, i); },
                                   [&](int point) { return c.column(measures, point); }));
  }
};

/// Reading and rounding 80 columns of doubles takes longer than computing the geometry again.
template <class M>
struct functor_in_single<stored_hexahedra<M>> {
  using type = general_hexahedra<M>;
};

/// Those of which only a part is material: their geometry is not stored.
template <class M>
struct hexahedron_parts : continuum_functor<M, hexahedron_parts<M>> {
  static constexpr const char* name = "parts of general hexahedra";
  static constexpr std::uint32_t shape = SUTURE_GENERAL;
  static constexpr std::uint32_t reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
  static constexpr auto cell_columns = joined(state_columns<M, 8>, columns(element_general_part));

  template <int Q, class Cell, class Work>
  static SUTURE_INLINE void with_geometry(const Cell& c, Work&& work) {
    using R = typename Cell::real;
    vec3<R> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    work(general_part_geometry<R, Q>(X, read_general_part(c)));
  }
};
template <class M>
struct functor_on_parts<general_hexahedra<M>> {
  using type = hexahedron_parts<M>;
};
template <class M>
struct functor_on_parts<stored_hexahedra<M>> {
  using type = hexahedron_parts<M>;
};

// Every Gauss point contributes to the force on every node.
template <class M>
inline constexpr int nodes_to_check<parallelepipeds<M>> = 1;
template <class M>
inline constexpr int nodes_to_check<parallelepiped_parts<M>> = 1;
template <class M>
inline constexpr int nodes_to_check<stored_hexahedra<M>> = 1;
template <class M>
inline constexpr int nodes_to_check<general_hexahedra<M>> = 1;
template <class M>
inline constexpr int nodes_to_check<hexahedron_parts<M>> = 1;

}  // namespace detail
}  // namespace suture

#include "suture/detail/release_elements.hpp"

namespace suture {
namespace detail {

/// Only points() and stores() may choose hexahedra whose geometry is not stored. A class of its
/// own: it is needed where M, which derives from continuum<M>, is complete.
template <class M>
constexpr auto choose_functors() {
  using trilinear = list<parallelepipeds<M>, stored_hexahedra<M>>;
  using mean_gradient = list<mean_gradient_parallelepipeds<M>, mean_gradient_hexahedra<M>>;
  if constexpr (has_release<M>)
    return joined(joined(trilinear(), mean_gradient()), release_functors<M>());
  else if constexpr (has_points<M> || has_stores<M>)
    return joined(joined(trilinear(), list<general_hexahedra<M>>()), mean_gradient());
  else
    return joined(trilinear(), mean_gradient());
}
template <class M>
struct functors_of_law : decltype(choose_functors<M>()) {};

}  // namespace detail

/// Base of a model that is one constitutive law on hexahedra.
template <class M>
struct continuum : model {
  static constexpr std::uint32_t flags = SUTURE_CONTINUUM;
  static constexpr attribute attributes[11] = {
      volume_attribute("inverse_jacobian", "1/m", "J^-1 of the rest shape, row-major", 9)
          .from_volumes(contribution<M, detail::inverse_jacobian>)
          .internal(),
      lumped_mass<M>(),
      detail::inverse_at<M, 0>("inverse_jacobian_0"),
      detail::inverse_at<M, 1>("inverse_jacobian_1"),
      detail::inverse_at<M, 2>("inverse_jacobian_2"),
      detail::inverse_at<M, 3>("inverse_jacobian_3"),
      detail::inverse_at<M, 4>("inverse_jacobian_4"),
      detail::inverse_at<M, 5>("inverse_jacobian_5"),
      detail::inverse_at<M, 6>("inverse_jacobian_6"),
      detail::inverse_at<M, 7>("inverse_jacobian_7"),
      volume_attribute("jacobians", "m^3", "det J at the 8 Gauss points, x fastest", 8)
          .from_volumes(contribution<M, detail::point_measures>)
          .internal()};
  using functors = detail::functors_of_law<M>;

  /// The element that the scene chooses; for prepare().
  static element_type element_of(const values& p) { return detail::element_of<M>(p); }

  using added_constants = rest_moduli;
  template <class R>
  using added_constants_of = rest_moduli_of<R>;
  static constexpr std::array<parameter, 1> added_parameters() {
    return {detail::element_parameter<M>()};
  }
  static constexpr auto added_attributes() { return detail::added_attributes_of<M>(); }
  template <class Material>
  static void prepare_added(const setup& p, const Material& material, rest_moduli& moduli) {
    detail::prepare_element<M>(p, material, moduli);
  }
};

}  // namespace suture

#endif
