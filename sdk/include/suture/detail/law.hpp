// SPDX-License-Identifier: MIT
//
// suture/detail/law.hpp - what a law of continuum.hpp declares, its stress, and its
// moduli at rest. Authors need not read it.
#ifndef SUTURE_DETAIL_LAW_HPP
#define SUTURE_DETAIL_LAW_HPP

#include "suture/hexahedron_tangent.hpp"
#include "suture/mean_gradient.hpp"
#include "suture/model.hpp"

namespace suture {

/// Lame's constants, Pa.
template <class R>
struct lame_of {
  R lambda, mu;
};
using lame = lame_of<double>;

/// The elements of continuum.hpp, and their names in a scene.
enum class element_type { trilinear, mean_gradient };
inline constexpr const char* element_names[] = {"trilinear", "mean-gradient"};

namespace detail {

/// What a law receives as `p`: the model's constants, or its parameters.
template <class M>
using material_of = std::conditional_t<
    !std::is_same_v<constants_of<M>, no_constants>, constants_of<M>,
    std::conditional_t<varies<M>, element_values<native, M, int(SUTURE_LANES)>, values>>;
template <class M, class Cell>
SUTURE_INLINE decltype(auto) material(const Cell& c) {
  if constexpr (std::is_same_v<constants_of<M>, no_constants>)
    return c.parameters();
  else
    return c.constants();
}

template <class M, class = void>
inline constexpr bool has_stress = false;
template <class M>
inline constexpr bool
    has_stress<M, std::void_t<decltype(M::stress(std::declval<const mat3<native>&>(),
                                                 std::declval<const material_of<M>&>()))>> = true;
template <class M, class = void>
inline constexpr bool has_energy_density = false;
template <class M>
inline constexpr bool
    has_energy_density<M, std::void_t<decltype(M::energy(std::declval<const mat3<native>&>(),
                                                         std::declval<const material_of<M>&>()))>> =
        true;
template <class M, class = void>
inline constexpr bool has_points = false;
template <class M>
inline constexpr bool has_points<M, std::void_t<decltype(&M::points)>> = true;

template <class M, class = void>
inline constexpr bool has_stores = false;
template <class M>
inline constexpr bool has_stores<M, std::void_t<decltype(&M::stores)>> = true;

/// Whether columns hold the geometry of general hexahedra.
template <class M>
bool stores_geometry(const values& p) {
  if constexpr (has_points<M>)
    if (M::points(p) != 2) return false;
  if constexpr (has_stores<M>) return M::stores(p);
  return true;
}

template <class M, class = void>
inline constexpr bool is_isotropic = false;
template <class M>
inline constexpr bool
    is_isotropic<M, std::void_t<decltype(M::isotropic(std::declval<const material_of<M>&>()))>> =
        true;

/// The element of scenes that name none.
template <class M>
constexpr element_type default_element_of() {
  if constexpr (has_default_element<M>)
    return M::default_element;
  else
    return element_type::mean_gradient;
}

/// The parameter "element" follows those that the model declares.
template <class M>
element_type element_of(const values& p) {
  return p[int(parameter_count<M>())] == 0 ? element_type::trilinear : element_type::mean_gradient;
}

template <class M>
bool is_trilinear(const values& p) {
  return element_of<M>(p) == element_type::trilinear;
}

/// Whether the hourglass energy has the half of F^-1, which is singular at det F = 0.
template <class M>
constexpr bool has_both_halves() {
  if constexpr (has_survives_inversion<M>)
    return !M::survives_inversion;
  else
    return !is_isotropic<M>;
}

/// P of the law: from stress(), or else dW/dF_ij, one component after another.
template <class M, class T, class Material>
SUTURE_INLINE mat3<T> law_stress(const mat3<T>& F, const Material& p) {
  if constexpr (has_stress<M>) {
    return M::stress(F, p);
  } else {
    mat3<T> P;
    mat3<dual<T>> G;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) G(i, j) = F(i, j);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        G(i, j).derivative = 1.0;
        P(i, j) = M::energy(G, p).derivative;
        G(i, j).derivative = 0.0;
      }
    return P;
  }
}

/// dP of the law for dF: in closed form where the law is known, or by dual numbers.
template <class M, class T, class Material>
SUTURE_INLINE mat3<T> law_tangent(const mat3<T>& F, const mat3<T>& dF, const Material& p) {
  if constexpr (is_isotropic<M>) {
    const auto constants = M::isotropic(p);
    return isotropic_tangent(F, dF, T(constants.lambda), T(constants.mu));
  } else {
    mat3<dual<T>> G;
    for (int i = 0; i < 9; ++i) G(i / 3, i % 3) = {F(i / 3, i % 3), dF(i / 3, i % 3)};
    const mat3<dual<T>> P = law_stress<M>(G, p);
    mat3<T> dP;
    for (int i = 0; i < 9; ++i) dP(i / 3, i % 3) = P(i / 3, i % 3).derivative;
    return dP;
  }
}

template <class M>
constexpr bool check_law() {
  static_assert(!names_energy<M> || has_energy_density<M>,
                "energy() of this law is never called: declare it as `template <class T, class P> "
                "static T energy(const suture::mat3<T>& F, const P& p)`");
  static_assert(!names_stress<M> || has_stress<M>,
                "stress() of this law is never called: declare it as `template <class T, class P> "
                "static suture::mat3<T> stress(const suture::mat3<T>& F, const P& p)`");
  static_assert(!names_isotropic<M> || is_isotropic<M>,
                "isotropic() of this law is never called: declare it as `template <class P> static "
                "suture::lame isotropic(const P& p)`");
  static_assert((!names_points<M> || has_points<M>)&&(!names_stores<M> || has_stores<M>),
                "points() or stores() of this law is never called: declare them as `static int "
                "points(const suture::values&)`, `static bool stores(const suture::values&)`");
  static_assert(
      !declares_parameter<M>("element"),
      "every continuum model has the parameter \"element\" already, which chooses between "
      "trilinear and mean-gradient hexahedra: give this parameter another name");
  return true;
}

/// Lame's constants of the isotropic tensor nearest to the tangent of the law at F = I
/// (Voigt's averages, which are exact for an isotropic law).
template <class M, class Material>
lame lame_at_rest(const Material& p) {
  if constexpr (is_isotropic<M>) {
    return M::isotropic(p);
  } else {
    using T = dual<double>;
    double bulk = 0, shear = 0;  // C_kkll, and C_klkl of the symmetric part
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) {
        mat3<T> F = mat3<T>::identity();
        F(k, l).derivative = 1;
        const mat3<T> P = law_stress<M>(F, p);
        if (k == l) bulk += trace(P).derivative;
        shear += 0.5 * (P(k, l) + P(l, k)).derivative;
      }
    return {(2 * bulk - shear) / 15, (3 * shear - bulk) / 30};
  }
}

inline rest_moduli moduli_of(const lame& c) {
  const double nu = c.lambda / (2 * (c.lambda + c.mu)), young = 2 * c.mu * (1 + nu);
  const double plane = young / (1 - nu * nu);
  return {nu, c.mu, plane, young / 9, plane / 3, plane * nu / 3, c.mu / 3};
}

/// False for NaN, too.
inline bool is_stable(const lame& c) {
  return std::isfinite(c.lambda) && c.mu > 0 && std::isfinite(c.mu) && 3 * c.lambda + 2 * c.mu > 0;
}

/// Output fields of every element.
template <class M>
constexpr auto fields_of_law() {
  constexpr auto stress = field("stress", "Pa", "Cauchy stress, mean of the element", 6);
  constexpr auto mises = field("von_mises", "Pa", "Equivalent stress of von Mises of it");
  constexpr auto energy = field("energy_density", "J/m^3", "Stored energy per rest volume");
  if constexpr (has_energy_density<M>)
    return std::array<suture_field, 3>{stress, mises, energy};
  else
    return std::array<suture_field, 2>{stress, mises};
}

}  // namespace detail
}  // namespace suture

#endif
