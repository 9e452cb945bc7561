// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/zeroed_vector.hpp"
#include "kernel/results/piece_cells.hpp"

namespace suture {

/// Where the parameters of an instance, and columns that were given cell by cell, jump between two
/// elements with a common face. With d(a, b) = |p_a - p_b| / max(|p_a|, |p_b|), and the elements a
/// and b behind each other in a row:
///
///     +---+---+---+---+      d(a, b) is a jump if one of them is twice the other, or if it is more
///     | c | a | b | d |      than four times the smaller of d(c, a) and d(b, d): a smooth field
///     +---+---+---+---+      differs as much in front of and behind both.
class ParameterJumps {
 public:
  ParameterJumps(const CellComplex& complex, const Instance& instance);
  /// False if nothing differs between elements.
  bool may_be() const { return !columns_.empty(); }
  bool is_at(Index element, int face) const;

 private:
  double difference(const Column& column, Index one, Index other) const;
  double difference_behind(const Column& column, Index element, int face) const;

  const CellComplex& complex_;
  const Instance& instance_;
  std::vector<const Column*> columns_;
};

/// Which elements have a continuous stress: a group per element, `none` for those without stress.
/// It has the elements of one instance that hang together through faces at which no parameter
/// jumps. Groups are numbered in the order of the instances, then of the elements. `stress`: 6
/// components by element. O(elements).
ZeroedVector<Index> stress_groups(const CellComplex& complex, const Attributes& attributes,
                                  std::span<const double> stress, const ShownCells& elements);

}  // namespace suture
