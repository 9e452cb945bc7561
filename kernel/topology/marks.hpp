// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "kernel/topology/incidence.hpp"

/// Marks used while an operation runs: links to be removed, and one bit per cell.
namespace suture::marks {

/// Set in a link that the operation removes.
inline constexpr incidence::Link leaving = 0x80000000u;

/// The position of the link of a dart's face.
inline std::size_t side_of(incidence::Link dart) {
  return std::size_t{6} * (dart >> 5) + (dart & 31) / 4;
}

/// Sets the bit of cell i; returns true if it was not set before.
inline bool mark(std::vector<std::uint64_t>& marks, Index i) {
  std::uint64_t& word = marks[i / 64];
  const std::uint64_t bit = std::uint64_t{1} << (i % 64);
  const bool fresh = !(word & bit);
  word |= bit;
  return fresh;
}

/// The cells whose bits are set, ascending.
inline std::vector<Index> marked(const std::vector<std::uint64_t>& marks) {
  std::vector<Index> cells;
  for (std::size_t i = 0; i < marks.size(); ++i)
    for (std::uint64_t word = marks[i]; word != 0; word &= word - 1)
      cells.push_back(
          static_cast<Index>(64 * i + static_cast<std::size_t>(std::countr_zero(word))));
  return cells;
}

inline void unmark(std::vector<std::uint64_t>& marks, const std::vector<Index>& marked) {
  for (const Index i : marked) marks[i / 64] = 0;
}

}  // namespace suture::marks
