// SPDX-License-Identifier: MIT
//
// suture/detail/law.hpp - what a law of continuum.hpp declares, its stress, and its
// moduli at rest. Authors need not read it.
#ifndef SUTURE_DETAIL_LAW_HPP
#define SUTURE_DETAIL_LAW_HPP

#include "suture/detail/state.hpp"
#include "suture/lame.hpp"
#include "suture/mean_gradient.hpp"
#include "suture/reverse.hpp"
#include "suture/saint_venant_kirchhoff.hpp"

namespace suture {

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

// A law is called with (F, p), or with (F, p, at).
#define SUTURE_DETAIL_LAW(function, name)                                                          \
  template <class M, class = void>                                                                 \
  inline constexpr bool name##_alone = false;                                                      \
  template <class M>                                                                               \
  inline constexpr bool                                                                            \
      name##_alone<M, std::void_t<decltype(M::function(std::declval<const mat3<native>&>(),        \
                                                       std::declval<const material_of<M>&>()))>> = \
          true;                                                                                    \
  template <class M, class = void>                                                                 \
  inline constexpr bool name = name##_alone<M>;                                                    \
  template <class M>                                                                               \
  inline constexpr bool                                                                            \
      name<M, std::void_t<decltype(M::function(std::declval<const mat3<native>&>(),                \
                                               std::declval<const material_of<M>&>(),              \
                                               std::declval<instant_of<M, native>&>()))>> = true;
SUTURE_DETAIL_LAW(stress, declares_stress)
SUTURE_DETAIL_LAW(energy, declares_energy_density)
SUTURE_DETAIL_LAW(evolve, has_evolve)
#undef SUTURE_DETAIL_LAW

/// Whether the law declares its Lame constants instead of stress() and energy().
template <class M, class = void>
inline constexpr bool is_saint_venant_kirchhoff = false;
template <class M>
inline constexpr bool is_saint_venant_kirchhoff<
    M, std::void_t<decltype(M::saint_venant_kirchhoff(std::declval<const material_of<M>&>()))>> =
    true;
template <class M>
inline constexpr bool has_stress_alone = declares_stress_alone<M> || is_saint_venant_kirchhoff<M>;
template <class M>
inline constexpr bool has_stress = declares_stress<M> || is_saint_venant_kirchhoff<M>;
template <class M>
inline constexpr bool has_energy_density_alone =
    declares_energy_density_alone<M> || is_saint_venant_kirchhoff<M>;
template <class M>
inline constexpr bool has_energy_density =
    declares_energy_density<M> || is_saint_venant_kirchhoff<M>;

template <class M, class = void>
inline constexpr bool has_release = false;
template <class M>
inline constexpr bool
    has_release<M, std::void_t<decltype(M::release(
                       std::declval<const mat3<native>&>(), std::declval<const material_of<M>&>(),
                       std::declval<const field_point<native>&>()))>> = true;

template <class M, class = void>
inline constexpr bool has_field_energy = false;
template <class M>
inline constexpr bool has_field_energy<
    M, std::void_t<decltype(M::field_energy(std::declval<const material_of<M>&>(),
                                            std::declval<const field_point<native>&>()))>> = true;

template <class M, class = void>
inline constexpr bool has_field_dissipation = false;
template <class M>
inline constexpr bool has_field_dissipation<
    M, std::void_t<decltype(M::dissipation(std::declval<const material_of<M>&>(),
                                           std::declval<const field_point<native>&>()))>> = true;

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

/// Whether a parameter of the law is a direction.
template <class M>
constexpr bool has_directions() {
  if constexpr (has_parameters<M>)
    for (const parameter& p : M::parameters)
      if (p.type == SUTURE_DIRECTION) return true;
  return false;
}
/// Whether mean-gradient elements evaluate the law in the samples of bending_samples.hpp: if its
/// response changes with states, fields or time, or depends on a direction.
template <class M>
constexpr bool needs_samples() {
  if constexpr (has_samples_bending<M>)
    return M::samples_bending;
  else
    return has_state<M> || has_vertex_fields<M> || has_directions<M>() ||
           (!has_energy_density_alone<M> && !has_stress_alone<M>);
}
template <class M>
inline constexpr bool is_sampled = !has_release<M> && needs_samples<M>();

/// The element of scenes that name none.
template <class M>
constexpr element_type default_element_of() {
  if constexpr (has_default_element<M>)
    return M::default_element;
  else
    return element_type::mean_gradient;
}

/// A law that changes its field has the trilinear element unless a scene says otherwise.
template <class M>
constexpr parameter element_parameter() {
  return choice("element",
                "trilinear: the law at each Gauss point; mean-gradient: once per element, at "
                "the mean deformation gradient, does not lock",
                element_names)
      .or_else(has_release<M> ? 0 : int(default_element_of<M>()));
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

/// Whether forces are linear in displacements by design.
template <class M>
constexpr bool is_linear() {
  return (M::flags & SUTURE_LINEAR) != 0;
}

/// Whether the law is finite at det F = 0, where the inverse of F is not.
template <class M>
constexpr bool survives_inversion() {
  if constexpr (has_survives_inversion<M>)
    return M::survives_inversion;
  else
    return is_saint_venant_kirchhoff<M>;
}
template <class M>
constexpr hourglass_form hourglass_form_of() {
  if (is_linear<M>()) return hourglass_form::linear;
  return survives_inversion<M>() ? hourglass_form::stretched : hourglass_form::both;
}

/// W of the law as a function of F. A struct, as a lambda around a function would be one more
/// copy that the compiler works through.
template <class M, class Material, class At>
struct law_energy {
  const Material& p;
  const At& at;
  template <class T>
  SUTURE_INLINE T operator()(const mat3<T>& F) const {
    if constexpr (is_saint_venant_kirchhoff<M>)
      return saint_venant_kirchhoff_energy(F, M::saint_venant_kirchhoff(p));
    else if constexpr (has_energy_density_alone<M>)
      return M::energy(F, p);
    else
      return M::energy(F, p, at);
  }
};

/// The same as a function of its own, for what is not computed in every step.
template <class M, class T, class Material, class At>
[[gnu::noinline]] T called_energy(const mat3<T>& F, const Material& p, const At& at) {
  return law_energy<M, Material, At>{p, at}(F);
}

/// dW/dF.
template <class M, class T, class Material, class At>
SUTURE_INLINE mat3<T> stress_of_energy(const mat3<T>& F, const Material& p, const At& at) {
  const law_energy<M, Material, At> W{p, at};
  if constexpr (is_pack<real_of<T>>)
    return gradient(F, W);
  else  // not worth a tape: a single number, for the moduli at rest
    return gradient_by_duals(F, W);
}

/// Whether a law is evaluated in functions of its own.
template <class M>
inline constexpr bool is_called = !has_stress<M> || has_state<M>;

/// P of the law: from its Lame constants, from stress(), or else dW/dF.
template <class M, class T, class Material, class At>
SUTURE_INLINE mat3<T> law_stress(const mat3<T>& F, const Material& p,
                                 [[maybe_unused]] const At& at) {
  if constexpr (is_saint_venant_kirchhoff<M>)
    return saint_venant_kirchhoff_stress(F, M::saint_venant_kirchhoff(p));
  else if constexpr (has_stress_alone<M>)
    return M::stress(F, p);
  else if constexpr (has_stress<M>)
    return M::stress(F, p, at);
  else
    return stress_of_energy<M>(F, p, at);
}

/// The state at the end of the step. A function of its own, as gradient() is.
template <class M, class T, class Material, class At>
[[gnu::noinline]] void evolve_state(const mat3<T>& F, const Material& p, At& at) {
  M::evolve(F, p, at);
}
template <class M, int Points, class Cell, class T>
SUTURE_INLINE instant_of<M, T> instant_at(const Cell& c, const mat3<T>& F, int point) {
  auto at = accepted_instant<M, Points>(c, point);
  if constexpr (has_state<M>) evolve_state<M>(F, material<M>(c), at);
  return at;
}

/// Reads J^-1 of a parallelepiped; returns the largest entry off the diagonal, 0 for a box.
template <class Cell, class Column, class R>
SUTURE_INLINE R read_inverse(const Cell& c, Column jacobian, mat3<R>& inverse_j) {
  R skew(0.0);
  for (int i = 0; i < 9; ++i) {
    inverse_j(i / 3, i % 3) = c.column(jacobian, i);
    if (i % 4) skew = max(skew, abs(inverse_j(i / 3, i % 3)));
  }
  return skew;
}
/// Whether boxes, and parts of them, have a path of their own. Elsewhere it would take the compiler
/// longer than it saves a run.
template <class Cell>
inline constexpr bool has_box_path = Cell::sets_forces;
template <class Cell>
inline constexpr bool has_part_of_box_path = Cell::sets_forces && !is_dual<typename Cell::scalar>;
template <class Cell>
SUTURE_INLINE part_moments<typename Cell::real> read_part(const Cell& c) {
  const auto moment = [&](int i) SUTURE_DETAIL_INLINED { return c.column(element_part, i); };
  return {moment(0), {moment(1), moment(2), moment(3)}, {moment(4), moment(5), moment(6)}};
}
template <class Cell>
SUTURE_INLINE general_part<typename Cell::real> read_general_part(const Cell& c) {
  general_part<typename Cell::real> part;
  part.fraction = c.column(element_general_part, 0);
  for (int i = 0; i < 12; ++i) part.more[i / 3][i % 3] = c.column(element_general_part, i + 1);
  return part;
}

/// P at Gauss point `point` of an element with `Points`; keeps the state.
template <class M, int Points, class Cell, class T>
SUTURE_INLINE mat3<T> stress_at(const Cell& c, const mat3<T>& F, int point) {
  const auto at = instant_at<M, Points>(c, F, point);
  keep_state<M, Points>(c, point, at);
  return law_stress<M>(F, material<M>(c), at);
}

/// The derivative of stress_at() for dF; `c` is a cell of duals.
template <class M, int Points, class Cell, class T>
SUTURE_INLINE mat3<T> stress_tangent_at(const Cell& c, const mat3<T>& F, const mat3<T>& dF,
                                        int point) {
  if constexpr (is_saint_venant_kirchhoff<M>) {
    const auto constants = M::saint_venant_kirchhoff(material<M>(c));
    return saint_venant_kirchhoff_tangent(F, dF, T(constants.lambda), T(constants.mu));
  } else {
    mat3<dual<T>> G;
    for (int i = 0; i < 9; ++i) G(i / 3, i % 3) = {F(i / 3, i % 3), dF(i / 3, i % 3)};
    const mat3<dual<T>> P = stress_at<M, Points>(c, G, point);
    mat3<T> dP;
    for (int i = 0; i < 9; ++i) dP(i / 3, i % 3) = P(i / 3, i % 3).derivative;
    return dP;
  }
}

template <class M>
constexpr bool check_law() {
  static_assert(!names_energy<M> || has_energy_density<M>,
                "energy() of this law is never called: declare it as `template <class T, class P> "
                "static T energy(const suture::mat3<T>& F, const P& p)`, or with a third "
                "parameter `const At& at`");
  static_assert(!names_stress<M> || has_stress<M>,
                "stress() of this law is never called: declare it as `template <class T, class P> "
                "static suture::mat3<T> stress(const suture::mat3<T>& F, const P& p)`, or with a "
                "third parameter `const At& at`");
  static_assert(!names_release<M> || has_release<M>,
                "release() of this law is never called: declare it as `template <class F, class P, "
                "class At> static auto release(const F&, const P& p, const At& at)`, which returns "
                "suture::released");
  static_assert(!names_field_energy<M> || (has_field_energy<M> && has_energy_density<M>),
                "field_energy() of this law is never called: declare it as `template <class P, "
                "class At> static auto field_energy(const P& p, const At& at)` beside energy()");
  static_assert(!names_dissipation<M> ||
                    (has_field_dissipation<M> && has_energy_density<M> && !has_field_energy<M>),
                "dissipation() of this law is never called: declare it as `template <class P, "
                "class At> static auto dissipation(const P& p, const At& at)` beside energy() and "
                "release(), without field_energy()");
  static_assert(!names_saint_venant_kirchhoff<M> || is_saint_venant_kirchhoff<M>,
                "saint_venant_kirchhoff() of this law is never called: declare it as `template "
                "<class P> static suture::lame saint_venant_kirchhoff(const P& p)`");
  static_assert(!is_saint_venant_kirchhoff<M> || (!names_stress<M> && !names_energy<M>),
                "saint_venant_kirchhoff() states the whole law, so stress() and energy() beside it "
                "would never be called: leave them out, or leave saint_venant_kirchhoff() out");
  static_assert(!names_isotropic<M>,
                "isotropic() is called saint_venant_kirchhoff() since 0.2, and replaces stress() "
                "and energy(): rename it and leave those out");
  static_assert((!names_points<M> || has_points<M>)&&(!names_stores<M> || has_stores<M>),
                "points() or stores() of this law is never called: declare them as `static int "
                "points(const suture::values&)`, `static bool stores(const suture::values&)`");
  static_assert(
      has_state<M> == has_states<M> && has_state<M> == names_evolve<M> &&
          has_state<M> == has_evolve<M>,
      "a law with a state has three members: `template <class T> struct State`, an "
      "aggregate of numbers T; `static constexpr suture::attribute states[]`, which names "
      "its parts; and `template <class T, class P, class At> static void evolve(const "
      "suture::mat3<T>& F, const P& p, At& at)`");
  static_assert(
      !has_state<M> || sizeof(state_of<M, double>) / sizeof(double) == state_components<M>(),
      "`states` of this law must have as many components in all as State<T> has numbers");
  static_assert((!has_state<M> && !has_vertex_fields<M>) || !has_points<M>,
                "a law with a state or fields has 2 Gauss points per axis: leave out points()");
  static_assert(!has_vertex_fields<M> || !is_saint_venant_kirchhoff<M>,
                "saint_venant_kirchhoff() of a law does not read fields: leave it out, or "
                "vertex_fields");
  static_assert(
      !declares_parameter<M>("element"),
      "every continuum model has the parameter \"element\" already, which chooses between "
      "trilinear and mean-gradient hexahedra: give this parameter another name");
  return true;
}

/// Lame's constants of the isotropic tensor nearest to the tangent of the law at F0 (Voigt's
/// averages, which are exact for an isotropic law). R: a number, or a pack of elements.
template <class M, class R, class Material>
lame_of<R> lame_at(const mat3<double>& F0, const Material& p) {
  using T = dual<R>;
  R bulk(0.0), shear(0.0);  // C_kkll, and C_klkl of the symmetric part
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) {
      mat3<T> F;
      for (int i = 0; i < 9; ++i) F(i / 3, i % 3) = T(R(F0(i / 3, i % 3)));
      F(k, l).derivative = R(1.0);
      auto at = first_instant<M, T>();
      if constexpr (has_state<M>) M::evolve(F, p, at);
      const mat3<T> P = law_stress<M>(F, p, at);
      if (k == l) bulk += trace(P).derivative;
      shear += 0.5 * (P(k, l) + P(l, k)).derivative;
    }
  return {(2.0 * bulk - shear) * (1.0 / 15), (3.0 * shear - bulk) * (1.0 / 30)};
}

/// Strains as small as possible, of which each comes with its negative: stretches by 1e-7 at
/// constant volume along three directions, with a fifth of that in all directions.
constexpr int rest_samples = 6;
inline mat3<double> near_rest(int sample) {
  constexpr double step = 1e-7;
  constexpr double along[3][3] = {// no axis of symmetry of a usual law lies along them
                                  {0.36, 0.48, 0.80},
                                  {-0.80, 0.60, 0.0},
                                  {-0.48, -0.64, 0.60}};
  const double(&d)[3] = along[sample / 2];
  const double size = sample % 2 == 0 ? step : -step;
  mat3<double> F;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      F(i, j) = (i == j ? 1 + size * (0.2 - 1.0 / 3) : 0.0) + size * d[i] * d[j];
  return F;
}

template <class R>
struct lame_near_rest {
  lame_of<R> mean;
  R spread;  ///< the largest difference of mu and of lambda + 2/3 mu from it, over the larger one
};
/// At F = I. Laws with a switch, such as fibres that carry tension only, have more than one tangent
/// there, and bending stretches one half of a body and compresses the other. At F = I itself,
/// rounding would choose a tangent; so it would along a path on which the switch has no sign.
template <class M, class R, class Material>
lame_near_rest<R> lame_at_rest(const Material& p) {
  if constexpr (is_saint_venant_kirchhoff<M>) {
    const auto constants = M::saint_venant_kirchhoff(p);
    return {{R(constants.lambda), R(constants.mu)}, R(0.0)};
  } else {
    lame_of<R> at[rest_samples], mean{R(0.0), R(0.0)};
    for (int i = 0; i < rest_samples; ++i) {
      at[i] = lame_at<M, R>(near_rest(i), p);
      mean.lambda += at[i].lambda * (1.0 / rest_samples);
      mean.mu += at[i].mu * (1.0 / rest_samples);
    }
    R change(0.0);
    for (const lame_of<R>& a : at) {
      const R shear = a.mu - mean.mu, lambda = a.lambda - mean.lambda;
      change = max(change, max(abs(shear), abs(lambda + (2.0 / 3) * shear)));
    }
    const R bulk = abs(mean.lambda + (2.0 / 3) * mean.mu);
    return {mean, change / max(max(bulk, abs(mean.mu)), R(1e-300))};
  }
}

inline rest_moduli moduli_of(const lame& c) {
  const double nu = c.lambda / (2 * (c.lambda + c.mu)), young = 2 * c.mu * (1 + nu);
  const double plane = young / (1 - nu * nu);
  return {nu, c.mu, plane, young / 9, plane / 3, plane * nu / 3, c.mu / 3};
}

/// False for NaN, too, and for what is left of 0 by rounding.
template <class R>
using mask_of = decltype(std::declval<R>() < std::declval<R>());
template <class R>
mask_of<R> is_stable(const lame_of<R>& c) {
  const R rounding = 1e-12 * (abs(c.lambda) + abs(c.mu));
  return (rounding < R(1e300)) & (c.mu > rounding) & (3.0 * c.lambda + 2.0 * c.mu > rounding);
}
/// Whether Poisson's ratio is above 0.45: trilinear elements are then far too stiff in bending.
template <class R>
mask_of<R> locks(const lame_of<R>& c) {
  return is_stable(c) & (c.lambda > 0.9 * (c.lambda + c.mu));
}

}  // namespace detail
}  // namespace suture

#endif
