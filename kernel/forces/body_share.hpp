// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernel/forces/failures.hpp"
#include "kernel/forces/loops/loops.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Rows of numbers, one for each vertex.
struct VertexRows {
  template <class Number>
  VertexRows(Number* rows, std::size_t numbers)
      : data(reinterpret_cast<std::byte*>(rows)), bytes(numbers * sizeof(Number)) {}
  std::byte* data;
  std::size_t bytes;  ///< of a row, a multiple of 8
};

/// The part of a body that this process computes, of several that hold the same body
/// (kernel/processes). All of them call the same functions in the same order.
///
///   vertices   0 ........ | own | ........ | common | end
///
/// It steps its own vertices, and together with all others the common ones, the last: among them
/// are those that operations make. Both are whole blocks, so that sums by blocks are those of one
/// process.
class BodyShare {
 public:
  static constexpr Index block = 1024;  ///< vertices

  virtual ~BodyShare() = default;

  virtual loops::Rows own() const = 0;
  virtual Index common_begin() const = 0;

  // ---- forces

  /// By vertex of the complex as it is now: whether another process sums its forces. O(vertices).
  virtual std::vector<bool> others(const CellComplex& complex) = 0;
  /// Each common vertex gets the row that its process has summed, and `failure` becomes the first
  /// of all processes. After others().
  virtual void join_common(VertexRows rows, Failure& failure) = 0;
  /// Each vertex of another process gets the row of that process.
  virtual void complete(VertexRows rows) = 0;

  // ---- steps

  /// The vertices that this process reads when it computes forces, by vertex.
  virtual void read(const std::vector<bool>& vertices) = 0;
  /// Those of read() that other processes step, ascending.
  virtual std::span<const Index> borders() const = 0;
  /// The rows at borders() of some columns become those of the processes that step them.
  virtual void join_borders(std::span<double* const> columns) = 0;
  /// The same for rows of `width` numbers, one per block of vertices, on all processes. Returns
  /// whether all of them are `good`.
  virtual bool join_blocks(std::span<double> rows, std::size_t width, bool good) = 0;
  virtual bool all(bool good) = 0;  ///< whether all of them are

  // ---- sums

  /// Those of `count` sums that this process computes.
  virtual loops::Rows part(Index count) const = 0;
  /// Each process gets those of the others, and `failure` becomes the first of all.
  virtual void join_sums(std::span<double> sums, Failure& failure) = 0;
};

}  // namespace suture
