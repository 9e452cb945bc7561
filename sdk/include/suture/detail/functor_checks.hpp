// SPDX-License-Identifier: MIT
//
// suture/detail/functor_checks.hpp - the compile-time errors for mistakes in a functor. Authors
// need not read it.
#ifndef SUTURE_DETAIL_FUNCTOR_CHECKS_HPP
#define SUTURE_DETAIL_FUNCTOR_CHECKS_HPP

#include "suture/detail/optional_functions.hpp"

namespace suture::detail {

template <class M, class F>
constexpr void check_columns() {
  static_assert(
      are_places_of<M>(F::cell_columns.places) && are_places_of<M>(F::vertex_columns.places),
      "cell_columns or vertex_columns name a column beyond the end of the model's list of "
      "attributes; column<0> is the first attribute");
  static_assert(
      have_dimension<M>(F::cell_columns.places, F::dimension),
      "cell_columns name an attribute of a dimension other than that of the functor's cells; "
      "list attributes of vertices in vertex_columns");
  static_assert(F::cell_columns.index_of(vertex_mass.place) < 0,
                "list vertex_mass in vertex_columns, not in cell_columns");
  static_assert(
      have_dimension<M>(F::vertex_columns.places, 0),
      "vertex_columns name an attribute that does not belong to vertices; list those of the "
      "functor's own cells in cell_columns");
  static_assert(
      !share_mass<M>(F::cell_columns.places) && !share_mass<M>(F::vertex_columns.places),
      "an attribute with SUTURE_SHARED_MASS is not a column; read suture::vertex_mass instead");
}

/// A function that is present but would never be called is an error.
template <class M, class F>
constexpr void check_optional_functions() {
  using Cell = cell<native, M, F>;
  static_assert(!names_energy<F> || has_energy<F, Cell>,
                "energy() of this functor is never called: declare it as `template <class Cell> "
                "static auto energy(const Cell& cell)`");
  static_assert(!names_bounds<F> || has_bounds<F, Cell>,
                "bounds() of this functor is never called: declare it as `template <class Cell, "
                "class Bounds> static void bounds(const Cell& cell, Bounds& bounds)`");
  static_assert(!names_inspect<F> || has_inspect<F, cell<native, M, F, purpose::inspection>>,
                "inspect() of this functor is never called: declare it as `template <class Cell> "
                "static void inspect(const Cell& cell)`");
  static_assert(!names_enabled<F> || has_enabled<F>,
                "enabled() of this functor is never called: declare it as a single function, not a "
                "template: `static bool enabled(const suture::values& p, std::uint32_t& reads)`");
  static_assert(!names_output<F> || has_fields<F>,
                "output() of this functor is never called: list the fields that it sets in `static "
                "constexpr suture_field fields[]`");
  static_assert(!has_fields<F> || has_output<F, Cell>,
                "a functor with `fields` needs `template <class Cell, class Results> static void "
                "output(const Cell& cell, Results& results)`, which sets their values");
}

template <class M, class F>
constexpr void check_rate() {
  if constexpr (has_rate_of<F>) {
    constexpr std::uint32_t place = F::rate_of.place;
    static_assert((attribute_at<M>(place).flags & SUTURE_FIELD) != 0,
                  "`rate_of` names an attribute that is no field: declare it by vertex_field()");
    static_assert(F::vertex_columns.index_of(place) >= 0,
                  "a functor reads the field that it changes: name it in `vertex_columns`");
    static_assert(has_rate<F, cell<native, M, F, purpose::force>>,
                  "a functor with `rate_of` needs `template <class Cell> static void rate(Cell& "
                  "cell)`, which sets the rate of every node");
    static_assert(!names_bounds<F>, "a functor with `rate_of` has no bounds()");
  }
}

template <class M, class F>
constexpr void check_functor() {
  static_assert(has_nodes<F>,
                "a functor, or a model without `functors`, must derive from suture::on_vertices, "
                "on_edges, on_faces or on_volumes");
  static_assert(has_name<F> || has_id<F>, "a functor needs `static constexpr const char* name`");
  static_assert(has_doc<F>, "a functor needs `static constexpr const char* doc`");
  if constexpr (has_nodes<F>) {
    static_assert(has_rate_of<F> || has_force<F, cell<native, M, F, purpose::force>>,
                  "a functor needs `template <class Cell> static void force(Cell& cell)`, which "
                  "sets the force on every node");
    check_rate<M, F>();
    check_optional_functions<M, F>();
    check_columns<M, F>();
  }
}

}  // namespace suture::detail

#endif
