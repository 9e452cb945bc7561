// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/forces/failures.hpp"
#include "kernel/forces/loops/loops.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The part of a body's forces and energies that this process computes, of several that hold the
/// same body (kernel/processes). All of them call the same functions in the same order.
class ForceShare {
 public:
  virtual ~ForceShare() = default;

  /// By vertex of the complex as it is now: whether another process sums its forces. O(vertices).
  virtual std::vector<bool> others(const CellComplex& complex) = 0;
  /// Each vertex of `rows` (4 numbers) gets what its process has summed, and `failure` becomes the
  /// first of all processes. After others().
  virtual void join(double* rows, Failure& failure) = 0;

  /// Those of `count` sums that this process computes.
  virtual loops::Rows part(Index count) const = 0;
  /// The same for such sums.
  virtual void join_sums(std::span<double> sums, Failure& failure) = 0;
};

}  // namespace suture
