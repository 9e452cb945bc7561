// SPDX-License-Identifier: MIT
//
// suture/detail/declared.hpp - what a model and its functors declare, for the checks
// of cell.hpp and functor_checks.hpp. Authors need not read it.
#ifndef SUTURE_DETAIL_DECLARED_HPP
#define SUTURE_DETAIL_DECLARED_HPP

#include <array>
#include <iterator>
#include <string_view>
#include <type_traits>

#include "suture/columns.hpp"
#include "suture/plugin.h"
#include "suture/simd.hpp"

#if defined(__has_attribute)
#if __has_attribute(error)
#define SUTURE_COMPILE_ERROR(text) __attribute__((error(text)))
#endif
#endif
#ifndef SUTURE_COMPILE_ERROR
#define SUTURE_COMPILE_ERROR(text)
#endif

namespace suture::detail {

#define SUTURE_DETAIL_HAS(member)             \
  template <class F, class = void>            \
  inline constexpr bool has_##member = false; \
  template <class F>                          \
  inline constexpr bool has_##member<F, std::void_t<decltype(F::member)>> = true;
SUTURE_DETAIL_HAS(id)
SUTURE_DETAIL_HAS(doc)
SUTURE_DETAIL_HAS(formula)
SUTURE_DETAIL_HAS(citation)
SUTURE_DETAIL_HAS(nodes)
SUTURE_DETAIL_HAS(fields)
SUTURE_DETAIL_HAS(enabled)
SUTURE_DETAIL_HAS(prepare)
SUTURE_DETAIL_HAS(parameters)
SUTURE_DETAIL_HAS(attributes)
SUTURE_DETAIL_HAS(name)
SUTURE_DETAIL_HAS(default_element)
SUTURE_DETAIL_HAS(survives_inversion)
SUTURE_DETAIL_HAS(samples_bending)
SUTURE_DETAIL_HAS(states)
SUTURE_DETAIL_HAS(vertex_fields)
#undef SUTURE_DETAIL_HAS

/// Whether the functor changes a field, and has rate() instead of force().
template <class F, class = void>
inline constexpr bool has_rate_of = false;
template <class F>
inline constexpr bool has_rate_of<F, std::enable_if_t<(F::rate_of.place >= 0)>> = true;
template <class F, std::uint32_t Place, class = void>
inline constexpr bool is_rate_of = false;
template <class F, std::uint32_t Place>
inline constexpr bool is_rate_of<F, Place, std::enable_if_t<F::rate_of.place == Place>> = true;

// An optional function is detected by a call with the expected arguments. A function that has its
// name but cannot be called in this way would be ignored without a message; therefore
// names_energy<F> is true if F has any member called energy. Looking up the name in a struct that
// inherits one from each of two bases is ambiguous, whatever its signature.
struct optional_functions {
  int energy, bounds, output, inspect, enabled, prepare, stress, isotropic, saint_venant_kirchhoff,
      points, stores, evolve, release, field_energy, dissipation;
};
struct nothing {};
template <class F>  // a final struct cannot be derived from and is not examined
struct with_optional_functions : std::conditional_t<std::is_final_v<F>, nothing, F>,
                                 optional_functions {};

#define SUTURE_DETAIL_NAMES(member)                                                            \
  template <class F, class = void>                                                             \
  inline constexpr bool is_value_##member = false;                                             \
  template <class F> /* such as an enumerator, the place of a parameter */                     \
  inline constexpr bool                                                                        \
      is_value_##member<F, std::enable_if_t<!std::is_function_v<decltype(F::member)>>> = true; \
  template <class F, class = void>                                                             \
  inline constexpr bool names_##member = !is_value_##member<F>;                                \
  template <class F>                                                                           \
  inline constexpr bool                                                                        \
      names_##member<F, std::void_t<decltype(&with_optional_functions<F>::member)>> = false;
SUTURE_DETAIL_NAMES(energy)
SUTURE_DETAIL_NAMES(bounds)
SUTURE_DETAIL_NAMES(output)
SUTURE_DETAIL_NAMES(inspect)
SUTURE_DETAIL_NAMES(enabled)
SUTURE_DETAIL_NAMES(prepare)
SUTURE_DETAIL_NAMES(stress)
SUTURE_DETAIL_NAMES(isotropic)
SUTURE_DETAIL_NAMES(saint_venant_kirchhoff)
SUTURE_DETAIL_NAMES(points)
SUTURE_DETAIL_NAMES(stores)
SUTURE_DETAIL_NAMES(evolve)
SUTURE_DETAIL_NAMES(release)
SUTURE_DETAIL_NAMES(field_energy)
SUTURE_DETAIL_NAMES(dissipation)
#undef SUTURE_DETAIL_NAMES

template <class M>
constexpr std::size_t parameter_count() {
  if constexpr (has_parameters<M>)
    return std::size(M::parameters);
  else
    return 0;
}
/// Whether the model declares a parameter of this name.
template <class M>
constexpr bool declares_parameter([[maybe_unused]] std::string_view name) {
  if constexpr (has_parameters<M>)
    for (const auto& p : M::parameters)
      if (name == p.name) return true;
  return false;
}
// Parameters that may differ from element to element.
template <class M>
constexpr bool is_per_element([[maybe_unused]] std::size_t i) {
  if constexpr (has_parameters<M>)
    return i < parameter_count<M>() && (M::parameters[i].flags & SUTURE_PER_ELEMENT) != 0;
  else
    return false;
}
template <class M>
constexpr std::size_t element_parameter_count() {
  std::size_t count = 0;
  for (std::size_t i = 0; i < parameter_count<M>(); ++i) count += is_per_element<M>(i) ? 1 : 0;
  return count;
}
template <class M>
inline constexpr bool varies = element_parameter_count<M>() != 0;

/// Parameter -> its place among those that may differ, or -1.
template <class M>
constexpr auto make_element_places() {
  std::array<int, parameter_count<M>() + 1> places{};
  int next = 0;
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = is_per_element<M>(i) ? next++ : -1;
  return places;
}
template <class M>
inline constexpr auto element_places = make_element_places<M>();

template <class M, class = void>
inline constexpr bool has_constants_template = false;
template <class M>
inline constexpr bool
    has_constants_template<M, std::void_t<typename M::template Constants<double>>> = true;
/// What prepare() derives from parameters that differ is itself stored per element.
template <class M>
inline constexpr bool has_element_constants = varies<M>&& has_constants_template<M>;

/// Whether functor F reads the parameters of each element; otherwise, what prepare() derives.
template <class M, class F>
inline constexpr bool reads_element_parameters = varies<M>&& F::element_parameters &&
                                                 (F::contributes || !has_element_constants<M>);
template <class M, class F>
inline constexpr bool reads_element_constants =
    has_element_constants<M>&& F::element_parameters && !F::contributes;
template <class M, class F>
inline constexpr bool reads_added_constants = varies<M>&& F::added_element_constants;

/// The columns that the layer puts before those that functor F declares.
template <class M, class F>
inline constexpr int leading_columns =
    (reads_element_parameters<M, F> ? int(element_parameter_count<M>()) : 0) +
    (reads_element_constants<M, F> ? 1 : 0) + (reads_added_constants<M, F> ? 1 : 0);

SUTURE_COMPILE_ERROR(
    "suture: this parameter may differ from element to element: on volumes, declare `static "
    "constexpr bool element_parameters = true` in the functor (a model with Constants: read what "
    "prepare() derives from it); on other cells, read a column that elements contribute to")
void parameter_differs_between_elements();

template <class M>
constexpr std::size_t attribute_count() {
  if constexpr (has_attributes<M>)
    return std::size(M::attributes);
  else
    return 0;
}

// The attributes of the layer follow those of the author: parameters of each element, what
// prepare() derives from them, what the layer above derives, and what it adds.
template <class M>
inline constexpr bool adds_constants = !std::is_empty_v<typename M::added_constants>;
template <class M>
inline constexpr std::size_t derived_attribute_count = element_parameter_count<M>() +
                                                       (has_element_constants<M> ? 1 : 0) +
                                                       (varies<M> && adds_constants<M> ? 1 : 0);
template <class M>
inline constexpr std::size_t first_added_attribute =
    attribute_count<M>() + derived_attribute_count<M>;

/// The attribute at a place of the list, by the author or added. Otherwise, which includes the
/// kernel's mass, one of size 0 with one component and no flags.
template <class M>
constexpr suture_attribute attribute_at([[maybe_unused]] std::uint32_t place) {
  if constexpr (has_attributes<M>)
    if (place < attribute_count<M>()) return M::attributes[place];
  if constexpr (M::added_attributes().size() != 0)
    if (place >= first_added_attribute<M> &&
        place - first_added_attribute<M> < M::added_attributes().size())
      return M::added_attributes()[place - first_added_attribute<M>];
  suture_attribute mass{};
  mass.components = 1;
  return mass;
}
template <class M>
constexpr bool has_attribute(std::uint32_t place) {
  return attribute_at<M>(place).size != 0;
}
template <class M, std::uint32_t Place>
constexpr int components_of() {
  if (Place == element_part.place) return int(SUTURE_PART_COMPONENTS);
  if (Place == element_general_part.place) return int(SUTURE_GENERAL_PART_COMPONENTS);
  return int(attribute_at<M>(Place).components);
}
template <class M, std::uint32_t Place>
constexpr bool has_trial() {
  return (attribute_at<M>(Place).flags & SUTURE_TRIAL) != 0;
}

// Columns are attributes of one dimension, at places that exist in the list; shares of the mass are
// not columns.
template <class M, std::size_t N>
constexpr bool are_places_of(const std::array<std::uint32_t, N>& places) {
  for (const std::uint32_t place : places)
    if (place != vertex_mass.place && place != element_part.place &&
        place != element_general_part.place && !has_attribute<M>(place))
      return false;
  return true;
}
template <class M, std::size_t N>
constexpr bool have_dimension(const std::array<std::uint32_t, N>& places, std::uint32_t dimension) {
  for (const std::uint32_t place : places)
    if (has_attribute<M>(place) && attribute_at<M>(place).dimension != dimension) return false;
  return true;
}
template <class M, std::size_t N>
constexpr bool share_mass(const std::array<std::uint32_t, N>& places) {
  for (const std::uint32_t place : places)
    if ((attribute_at<M>(place).flags & SUTURE_SHARED_MASS) != 0) return true;
  return false;
}

/// The place of the rate of the field among the columns of a functor; UINT32_MAX: none.
template <class M, std::size_t N>
constexpr std::uint32_t field_rate_place(const std::array<std::uint32_t, N>& places) {
  for (const std::uint32_t place : places)
    if ((attribute_at<M>(place).flags & SUTURE_FIELD_RATE) != 0) return place;
  return UINT32_MAX;
}

// Indices of nodes, components and parameters are run-time values, so that loops can count
// them. Those that the optimiser knows are checked here; the functions are never defined
// and never called.
SUTURE_COMPILE_ERROR("suture: node index out of range for the functor's cells")
void node_out_of_range();
SUTURE_COMPILE_ERROR("suture: component index out of range for the attribute")
void component_out_of_range();
SUTURE_COMPILE_ERROR("suture: parameter index out of range for the model's list of parameters")
void parameter_out_of_range();

#define SUTURE_DETAIL_CHECK_INDEX(what, index, count)                        \
  if (__builtin_constant_p(index) && ((index) < 0 || (index) >= int(count))) \
  ::suture::detail::what##_out_of_range()

}  // namespace suture::detail

#endif
