// SPDX-License-Identifier: MIT
//
// suture/detail/optional_functions.hpp - which functions a functor has, with the expected
// arguments. Authors need not read it.
#ifndef SUTURE_DETAIL_OPTIONAL_FUNCTIONS_HPP
#define SUTURE_DETAIL_OPTIONAL_FUNCTIONS_HPP

#include "suture/declarations.hpp"

namespace suture::detail {

template <class F, class Cell, class = void>
inline constexpr bool has_energy = false;
template <class F, class Cell>
inline constexpr bool
    has_energy<F, Cell, std::void_t<decltype(F::energy(std::declval<const Cell&>()))>> = true;

template <class F, class Cell, class = void>
inline constexpr bool has_dissipation = false;
template <class F, class Cell>
inline constexpr bool
    has_dissipation<F, Cell, std::void_t<decltype(F::dissipation(std::declval<const Cell&>()))>> =
        true;

template <class F, class Cell, class = void>
inline constexpr bool has_bounds = false;
template <class F, class Cell>
inline constexpr bool has_bounds<
    F, Cell,
    std::void_t<decltype(F::bounds(std::declval<const Cell&>(),
                                   std::declval<bound_matrices<typename Cell::real>&>()))>> = true;

template <class F, class Cell, class = void>
inline constexpr bool has_inspect = false;
template <class F, class Cell>
inline constexpr bool
    has_inspect<F, Cell, std::void_t<decltype(F::inspect(std::declval<const Cell&>()))>> = true;

template <class F, class Cell, class = void>
inline constexpr bool has_force = false;
template <class F, class Cell>
inline constexpr bool has_force<F, Cell, std::void_t<decltype(F::force(std::declval<Cell&>()))>> =
    true;

template <class F, class Cell, class = void>
inline constexpr bool has_rate = false;
template <class F, class Cell>
inline constexpr bool has_rate<F, Cell, std::void_t<decltype(F::rate(std::declval<Cell&>()))>> =
    true;

template <class F, class Cell, class = void>
inline constexpr bool has_output = false;
template <class F, class Cell>
inline constexpr bool
    has_output<F, Cell,
               std::void_t<decltype(F::output(std::declval<const Cell&>(),
                                              std::declval<results<typename Cell::real>&>()))>> =
        true;

}  // namespace suture::detail

#endif
