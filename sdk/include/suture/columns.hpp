// SPDX-License-Identifier: MIT
//
// suture/columns.hpp - names for the columns of a model.
//
// A column<N> stands for the attribute at place N of the model's list. Reading a column
// that is not declared is a compile-time error where the function is instantiated.
//
//   static constexpr suture::column<0> stiffness{};
//   static constexpr suture::column<1> rest_length{};
//   static constexpr auto cell_columns = suture::columns(stiffness, rest_length);
//   ...
//   c.column(stiffness) * (length - c.column(rest_length))
#ifndef SUTURE_COLUMNS_HPP
#define SUTURE_COLUMNS_HPP

#include <array>
#include <cstdint>

#include "suture/parts.h"

namespace suture {

template <std::uint32_t Place>
struct column {
  static constexpr std::uint32_t place = Place;
};

/// The kernel's mass of a vertex, for the vertex_columns of a functor.
inline constexpr column<UINT32_MAX> vertex_mass{};

/// The moments of the part of an element that is material (parts.h), for the cell_columns of
/// functors on parts.
inline constexpr column<SUTURE_PART_COLUMN> element_part{};
/// The same for functors on parts of general hexahedra.
inline constexpr column<SUTURE_GENERAL_PART_COLUMN> element_general_part{};

/// Several columns: those that a functor declares, or some from which one is chosen at run
/// time.
template <std::uint32_t... Places>
struct column_list {
  static constexpr std::array<std::uint32_t, sizeof...(Places)> places{Places...};

  /// The index of a column in the list; -1 if it is not in it.
  static constexpr int index_of(std::uint32_t place) {
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i] == place) return int(i);
    return -1;
  }
};

template <std::uint32_t... Places>
constexpr column_list<Places...> columns(column<Places>...) {
  return {};
}

/// The columns of two lists, one list after the other.
template <std::uint32_t... A, std::uint32_t... B>
constexpr column_list<A..., B...> joined(column_list<A...>, column_list<B...>) {
  return {};
}

}  // namespace suture

#endif
