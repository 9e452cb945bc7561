// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/attributes/partial_rows.hpp"
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
  std::size_t bytes;  ///< of a row; a multiple of 8 but for complete() and release()
};

/// The part of a body that this process computes, of several that hold the same body
/// (kernel/processes). All of them call the same functions in the same order.
///
///   vertices   0 ........ | own | ........ | own | ........ | common | end
///
/// It steps its own vertices, and together with all others the common ones, the last: among them
/// are those that operations make, until shares are made again. Both are whole blocks, so that sums
/// by blocks are those of one process.
class BodyShare {
 public:
  static constexpr Index block = 1024;  ///< vertices

  virtual ~BodyShare() = default;

  /// Ranges, ascending.
  virtual std::span<const loops::Rows> own() const = 0;
  virtual Index common_begin() const = 0;
  /// Makes equal shares of the complex as it is now. All processes must have all rows of the
  /// columns that steps change, and of states to which a run may go back. O(cells).
  virtual void divide(const CellComplex& complex) = 0;
  /// Does so after an operation that has left shares which are not equal, or whole blocks common.
  virtual void follow(const CellComplex& complex) = 0;

  // ---- forces

  /// By vertex of the complex as it is now: whether another process sums its forces. O(vertices).
  virtual std::vector<bool> others(const CellComplex& complex) = 0;
  /// Own and common vertices get the rows that other processes have summed for them, and `failure`
  /// becomes the first of all processes. After others().
  virtual void join_forces(VertexRows rows, Failure& failure) = 0;
  /// Each vertex of another process gets the row of that process.
  virtual void complete(VertexRows rows) = 0;
  /// The same for process 0 alone.
  virtual void gather(VertexRows rows) = 0;

  /// What a process has of the body.
  struct Part {
    std::string machine;
    unsigned threads;
    loops::Rows elements;  ///< those that exist are as many for each process
    Index vertices;        ///< that it steps alone
  };
  virtual std::vector<Part> parts() const = 0;  ///< of all processes

  // ---- steps

  /// The vertices that this process reads when it computes forces, by vertex.
  virtual void read(const std::vector<bool>& vertices) = 0;
  /// Those of read() that other processes step.
  virtual std::span<const Index> borders() const = 0;
  /// The rows at borders() of some columns become those of the processes that step them.
  virtual void join_borders(std::span<double* const> columns) = 0;
  virtual void join_borders(VertexRows rows) = 0;
  /// The rows at marked vertices of other processes become theirs, once; returns these vertices.
  virtual std::vector<Index> join_at(const std::vector<bool>& vertices,
                                     std::span<double* const> columns) = 0;
  /// Own and common vertices, and borders().
  virtual std::span<const PartialRows::Range> known() const = 0;
  /// All other rows become 0, and take no memory where they fill pages.
  virtual void release(VertexRows rows) const = 0;
  /// The same for rows of `width` numbers, one per block of vertices, on all processes. Returns
  /// whether all of them are `good`.
  virtual bool join_blocks(std::span<double> rows, std::size_t width, bool good) = 0;
  virtual bool all(bool good) = 0;  ///< whether all of them are

  // ---- sums

  virtual unsigned number() const = 0;       ///< of this process
  virtual unsigned processes() const = 0;    ///< that hold the body
  virtual loops::Rows elements() const = 0;  ///< that this process sums; all, together with others
  /// The process with the first element of the vertex.
  virtual unsigned process_at(const CellComplex& complex, Index vertex) const = 0;
  /// The vertices of the cells that this process sums, by vertex.
  virtual void read_at_cells(const std::vector<bool>& vertices) = 0;
  /// The rows of `column` at these become those of the processes that step them.
  virtual void complete_at_cells(double* column) = 0;
  /// Each process gets the sums of the others, and `failure` becomes the first of all. Sum i is
  /// that of processes[i].
  virtual void join_sums(std::span<double> sums, std::span<const unsigned> processes,
                         Failure& failure) = 0;
  /// The lists of all processes, one after the other.
  virtual std::vector<Index> join_lists(const std::vector<Index>& mine) = 0;
  /// Process 0 calls take(bytes) with those of each process, in their order.
  using Bytes = std::vector<std::uint8_t>;
  virtual void collect(const Bytes& mine, const std::function<void(const Bytes&)>& take) = 0;
};

/// visit(first, end) for the ranges of vertices that other processes step alone.
template <class Visit>
void for_each_range_of_others(const BodyShare& share, Visit visit) {
  Index first = 0;
  for (const loops::Rows& own : share.own()) {
    visit(first, own.begin);
    first = own.end;
  }
  visit(first, share.common_begin());
}

}  // namespace suture
