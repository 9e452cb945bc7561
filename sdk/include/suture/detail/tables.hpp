// SPDX-License-Identifier: MIT
//
// suture/detail/tables.hpp - the tables of plugin.h, built from an author's structs. Authors need
// not read it.
#ifndef SUTURE_DETAIL_TABLES_HPP
#define SUTURE_DETAIL_TABLES_HPP

#include <array>
#include <cstring>
#include <iterator>

#include "suture/detail/functions.hpp"
#include "suture/detail/functor_checks.hpp"
#include "suture/note.h"

namespace suture::detail {

template <class M, class C>
struct contribution_table {
  static constexpr suture_contribution row{sizeof(suture_contribution), SUTURE_HEXAHEDRON,
                                           &contribute<M, C>};
};

/// What each element stores of what is derived from its parameters: Constants or, if `Added`, those
/// of the layer above.
template <class M, bool Added>
struct element_constants_table {
  using stored = std::conditional_t<Added, typename M::added_constants, constants_of<M>>;
  static constexpr int components = int(sizeof(stored) / sizeof(double));
  static_assert(components >= 1 && components <= 9 && components * sizeof(double) == sizeof(stored),
                "Constants of a model with parameters that may differ from element to element must "
                "be an aggregate of 1 to 9 numbers");
  static constexpr suture_contribution row{sizeof(suture_contribution), SUTURE_HEXAHEDRON,
                                           &element_constants<M, Added>};
};

/// The functor that computes the same as F on elements of which only a part is material.
template <class F>
struct functor_on_parts {
  using type = void;
};
template <class F>
inline constexpr bool has_functor_on_parts = !std::is_void_v<typename functor_on_parts<F>::type>;
template <class F>
inline constexpr bool offers_parts = F::allows_parts || has_functor_on_parts<F>;
template <class M, class F>
struct parts_table;

/// The extension `id` of functor F, or NULL.
template <class M, class F>
const void* extension(const char* id) noexcept {
  using Cell = cell<native, M, F>;
  const auto is = [id](const char* name) { return std::strcmp(id, name) == 0; };
  if (is(SUTURE_TANGENT_1)) {
    static constexpr suture_tangent_1 table{sizeof(suture_tangent_1), 0, &tangent<M, F>};
    return &table;
  }
  if constexpr (F::single_tangent) {
    using Single = typename functor_in_single<F>::type;
    constexpr std::uint32_t columns =
        Single::vertex_columns.places.size() != 0
            ? UINT32_MAX
            : std::uint32_t(leading_columns<M, Single> + Single::cell_columns.places.size());
    static constexpr suture_tangent_single_1 table{sizeof(suture_tangent_single_1),
                                                   SUTURE_SINGLE_LANES, Single::reads, columns,
                                                   &single_tangent<M, Single>};
    if (is(SUTURE_TANGENT_SINGLE_1)) return &table;
  }
  if constexpr (has_energy<F, Cell>) {
    static constexpr suture_energy_1 table{sizeof(suture_energy_1), 0, &energy<M, F>};
    if (is(SUTURE_ENERGY_1)) return &table;
  }
  if constexpr (has_rate_of<F> && has_dissipation<F, Cell>) {
    static constexpr suture_dissipation_1 table{sizeof(suture_dissipation_1), 0,
                                                &dissipation<M, F>};
    if (is(SUTURE_DISSIPATION_1)) return &table;
  }
  if constexpr (!has_rate_of<F>) {
    static constexpr suture_stable_dt_1 table{sizeof(suture_stable_dt_1), 0, &bounds<M, F>};
    if (is(SUTURE_STABLE_DT_1)) return &table;
  }
  if constexpr (has_inspect<F, cell<native, M, F, purpose::inspection>>) {
    static constexpr suture_inspect_1 table{sizeof(suture_inspect_1), 0, &inspect<M, F>};
    if (is(SUTURE_INSPECT_1)) return &table;
  }
  if constexpr (offers_parts<F>)
    if (is(F::shape == SUTURE_GENERAL ? SUTURE_PARTS_2 : SUTURE_PARTS_1))
      return &parts_table<M, F>::row;
  if constexpr (has_fields<F>) {
    static constexpr suture_output_1 table{sizeof(suture_output_1),
                                           std::uint32_t(std::size(F::fields)),
                                           std::data(F::fields), &output<M, F>};
    if (is(SUTURE_OUTPUT_1)) return &table;
  }
  return nullptr;
}

template <class M, class = void>
struct functors_of_model {
  using type = list<M>;  // the model is its only functor
};
template <class M>
struct functors_of_model<M, std::void_t<typename M::functors>> {
  using type = typename M::functors;
};

/// The columns of a functor: those of the layer, then those that it declares.
template <class M, class F>
constexpr auto make_functor_columns() {
  constexpr auto& declared = F::cell_columns.places;
  std::array<std::uint32_t, leading_columns<M, F> + declared.size()> all{};
  std::size_t at = 0;
  constexpr std::size_t first = attribute_count<M>(), count = element_parameter_count<M>();
  if (reads_element_parameters<M, F>)
    for (; at < count; ++at) all[at] = std::uint32_t(first + at);
  if (reads_element_constants<M, F>) all[at++] = std::uint32_t(first + count);
  if (reads_added_constants<M, F>) all[at++] = std::uint32_t(first_added_attribute<M> - 1);
  for (const std::uint32_t place : declared) all[at++] = place;
  return all;
}
template <class M, class F>
inline constexpr auto functor_columns = make_functor_columns<M, F>();

/// The functions of F on elements of which only a part is material, if these are those of the whole
/// element times the fraction, which comes first in the last column.
template <class M, class F>
struct scaled_by_part {
  static constexpr auto make_columns() {
    std::array<std::uint32_t, functor_columns<M, F>.size() + 1> all{};
    std::size_t at = 0;
    for (const std::uint32_t place : functor_columns<M, F>) all[at++] = place;
    all[at] = F::shape == SUTURE_GENERAL ? element_general_part.place : element_part.place;
    return all;
  }
  static constexpr auto columns = make_columns();

  static suture_status force(const suture_context* context, const suture_batch* batch) noexcept {
    return times_fraction(batch, detail::force<M, F>(context, batch), batch->force, 3 * F::nodes);
  }
  static suture_status tangent(const suture_context* context, const suture_batch* batch,
                               const double* dx, const double* dv, double* df) noexcept {
    return times_fraction(batch, detail::tangent<M, F>(context, batch, dx, dv, df), df,
                          3 * F::nodes);
  }
  static suture_status energy(const suture_context* context, const suture_batch* batch,
                              double* out) noexcept {
    return times_fraction(batch, detail::energy<M, F>(context, batch, out), out, 1);
  }
  static suture_status bounds(const suture_context* context, const suture_batch* batch,
                              double* stiffness, double* damping) noexcept {
    const suture_status status = detail::bounds<M, F>(context, batch, stiffness, damping);
    times_fraction(batch, status, stiffness, 6 * F::nodes);
    return times_fraction(batch, status, damping, 6 * F::nodes);
  }

  static const void* extension(const char* id) noexcept {
    const auto is = [id](const char* name) { return std::strcmp(id, name) == 0; };
    static constexpr suture_tangent_1 of_tangent{sizeof(suture_tangent_1), 0, &tangent};
    if (is(SUTURE_TANGENT_1)) return &of_tangent;
    if constexpr (!has_rate_of<F>) {
      static constexpr suture_stable_dt_1 of_bounds{sizeof(suture_stable_dt_1), 0, &bounds};
      if (is(SUTURE_STABLE_DT_1)) return &of_bounds;
    }
    if constexpr (has_energy<F, cell<native, M, F>>) {
      static constexpr suture_energy_1 of_energy{sizeof(suture_energy_1), 0, &energy};
      if (is(SUTURE_ENERGY_1)) return &of_energy;
    }
    return is(SUTURE_OUTPUT_1) ? detail::extension<M, F>(id) : nullptr;
  }

 private:
  static suture_status times_fraction(const suture_batch* batch, suture_status status,
                                      double* values, int rows) noexcept {
    const double* const fraction = batch->cell_columns[columns.size() - 1];
    for (int i = 0; i < rows && status == SUTURE_OK; ++i)
      for (std::uint32_t lane = 0; lane < SUTURE_LANES; ++lane)
        values[std::uint32_t(i) * SUTURE_LANES + lane] *= fraction[lane];
    return status;
  }
};

template <class M, class F>
constexpr suture_functor functor_of() {
  check_functor<M, F>();
  suture_functor f{};
  f.size = sizeof(suture_functor);
  f.dimension = F::dimension;
  f.cell_type = F::cell_type;
  f.shape = F::shape;
  f.faces = F::faces;
  f.lanes = SUTURE_LANES;
  f.scalar = 0;
  f.reads = F::reads;
  f.alternative = F::alternative;
  f.cell_column_count = std::uint32_t(functor_columns<M, F>.size());
  f.vertex_column_count = std::uint32_t(F::vertex_columns.places.size());
  f.cell_columns = functor_columns<M, F>.data();
  f.vertex_columns = F::vertex_columns.places.data();
  if constexpr (has_name<F>)
    f.name = F::name;
  else
    f.name = F::id;
  f.doc = F::doc;
  f.force = &force<M, F>;
  f.extension = &extension<M, F>;
  if constexpr (has_enabled<F>) f.enabled = &enabled<M, F>;
  if constexpr (has_rate_of<F>) f.field = 1 + F::rate_of.place;
  return f;
}

/// F times the fraction of the element that is material.
template <class M, class F>
constexpr suture_functor scaled_functor_of() {
  suture_functor f = functor_of<M, F>();
  f.cell_columns = scaled_by_part<M, F>::columns.data();
  f.cell_column_count = std::uint32_t(scaled_by_part<M, F>::columns.size());
  f.force = &scaled_by_part<M, F>::force;
  f.extension = &scaled_by_part<M, F>::extension;
  return f;
}
template <class M, class F>
struct parts_table {
  static constexpr suture_functor make() {
    if constexpr (has_functor_on_parts<F>)
      return functor_of<M, typename functor_on_parts<F>::type>();
    else if constexpr (F::dimension == 3)
      return scaled_functor_of<M, F>();
    else
      return {};
  }
  static constexpr suture_functor functor = make();
  static constexpr suture_parts_1 row{sizeof(suture_parts_1), 0,
                                      F::dimension == 3 ? &functor : nullptr};
};

template <class M, class... F>
constexpr std::array<suture_functor, sizeof...(F)> functor_rows(list<F...>) {
  return {functor_of<M, F>()...};
}
template <class M>
struct functor_table {
  static constexpr auto rows = functor_rows<M>(typename functors_of_model<M>::type());
};

/// The author's parameters and those that the layer adds.
template <class M>
constexpr auto parameter_rows() {
  constexpr std::size_t declared = parameter_count<M>();
  constexpr auto added = M::added_parameters();
  std::array<suture_parameter, declared + added.size()> rows{};
  if constexpr (has_parameters<M>)
    for (std::size_t i = 0; i < declared; ++i) rows[i] = M::parameters[i];
  for (std::size_t i = 0; i < added.size(); ++i) rows[declared + i] = added[i];
  return rows;
}
template <class M>
struct parameter_table {
  static constexpr auto rows = parameter_rows<M>();
};
constexpr attribute attribute_of(const parameter& p) {
  return volume_attribute(p.name, p.unit, p.doc, p.type == SUTURE_DIRECTION ? 3 : 1)
      .starts_at(p.default_value)
      .flag(SUTURE_PARAMETER);
}
template <class M, bool Added>
constexpr attribute derived_attribute(const char* name) {
  using table = element_constants_table<M, Added>;
  attribute a =
      volume_attribute(name, "1", "Derived from the parameters of the element", table::components)
          .flag(SUTURE_FROM_PARAMETERS | SUTURE_INTERNAL);
  a.policy = SUTURE_FROM_VOLUMES;
  a.contribution_count = 1;
  a.contributions = &table::row;
  return a;
}
/// The author's attributes and those that the layer adds.
template <class M>
constexpr auto attribute_rows() {
  constexpr std::size_t declared = attribute_count<M>();
  constexpr auto added = M::added_attributes();
  std::array<suture_attribute, first_added_attribute<M> + added.size()> rows{};
  if constexpr (has_attributes<M>)
    for (std::size_t i = 0; i < declared; ++i) rows[i] = M::attributes[i];
  std::size_t at = declared;
  for (std::size_t i = 0; i < parameter_count<M>(); ++i)
    if constexpr (varies<M>)
      if (is_per_element<M>(i)) rows[at++] = attribute_of(M::parameters[i]);
  if constexpr (has_element_constants<M>) rows[at++] = derived_attribute<M, false>("constants");
  if constexpr (varies<M> && adds_constants<M>)
    rows[at++] = derived_attribute<M, true>("added_constants");
  for (const attribute& a : added) rows[at++] = a;
  return rows;
}
template <class M>
struct attribute_table {
  static constexpr auto rows = attribute_rows<M>();
};

template <class M>
constexpr suture_model model_of() {
  static_assert(has_id<M> && has_doc<M> && has_formula<M> && has_citation<M>,
                "a model needs `static constexpr const char*` id, doc, formula and citation");
  static_assert(!names_prepare<M> || has_prepare<M>,
                "prepare() of this model is never called: declare it as a single function, not a "
                "template: `static void prepare(const suture::setup&, Constants&)`");
  using functors = functor_table<M>;
  suture_model m{};
  m.size = sizeof(suture_model);
  m.flags = M::flags;
  m.id = M::id;
  m.doc = M::doc;
  m.formula = M::formula;
  m.citation = M::citation;
  m.functor_count = std::uint32_t(std::size(functors::rows));
  m.functors = functors::rows.data();
  m.parameter_count = std::uint32_t(parameter_table<M>::rows.size());
  m.parameters = parameter_table<M>::rows.data();
  if constexpr (attribute_table<M>::rows.size() != 0) {
    m.attribute_count = std::uint32_t(attribute_table<M>::rows.size());
    m.attributes = attribute_table<M>::rows.data();
  }
  static_assert(
      !varies<M> || std::is_same_v<constants_of<M>, no_constants> || has_element_constants<M>,
      "parameters of this model may differ from element to element, so its Constants do, "
      "too: declare `template <class R> struct Constants`, an aggregate of numbers R");
  constexpr bool prepares_instance =
      varies<M> ? has_prepare<M> && !has_element_constants<M> : has_prepare<M> || adds_constants<M>;
  if constexpr (prepares_instance) {
    m.prepare = &prepare<M>;
    m.instance_bytes = sizeof(prepared<M>);
    static_assert(
        std::is_trivially_destructible_v<prepared<M>>,
        "Constants must be trivially destructible: the host releases them without calling a "
        "destructor");
    static_assert(alignof(prepared<M>) <= SUTURE_ALIGNMENT,
                  "Constants must not require a larger alignment than SUTURE_ALIGNMENT");
  }
  return m;
}

template <class... M>
struct model_table {
  static constexpr suture_model rows[] = {model_of<M>()...};
};

template <class... M>
constexpr suture_plugin plugin_of(const char* id, const char* version, const char* license,
                                  const char* description) {
  suture_plugin p{};
  p.size = sizeof(suture_plugin);
  p.magic = SUTURE_MAGIC;
  p.abi_major = SUTURE_ABI_MAJOR;
  p.abi_minor = SUTURE_ABI_MINOR;
  p.lanes = SUTURE_LANES;
  p.model_count = sizeof...(M);
  p.id = id;
  p.version = version;
  p.license = license;
  p.description = description;
  p.models = model_table<M...>::rows;
  return p;
}

template <class... M>
constexpr suture_note note_of(const char* plugin_id) {
  return make_note(plugin_id, M::id...);
}

}  // namespace suture::detail

#endif
