// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/forces/body_share.hpp"
#include "kernel/processes/communicator.hpp"

namespace suture {

/// Each process sums the forces on its own vertices, over all cells there: no sum crosses a border.
/// Its vertices are those whose first element is in its range of the elements, rounded to blocks.
/// The ranges are equal, and elements in an order that is local (ordering.hpp) share few vertices.
/// As vertices are numbered by first use, its own are consecutive, and their rows need not be
/// packed. The last block and what operations add are common to all processes: each sums the forces
/// where the first element is its own.
class ProcessShare final : public BodyShare {
 public:
  /// The communicator must outlive it.
  explicit ProcessShare(Communicator& processes);

  loops::Rows own() const override { return own_of(processes_.rank()); }
  Index common_begin() const override { return begins_.back(); }
  std::vector<bool> others(const CellComplex& complex) override;
  void join_common(VertexRows rows, Failure& failure) override;
  void complete(VertexRows rows) override;
  void read(const std::vector<bool>& vertices) override;
  std::span<const Index> borders() const override { return borders_; }
  void join_borders(std::span<double* const> columns) override;
  bool join_blocks(std::span<double> rows, std::size_t width, bool good) override;
  bool all(bool good) override { return processes_.largest(good ? 0 : 1) == 0; }
  loops::Rows part(Index count) const override { return part_of(processes_.rank(), count); }
  void join_sums(std::span<double> sums, Failure& failure) override;

 private:
  loops::Rows part_of(unsigned process, Index count) const;
  loops::Rows own_of(unsigned process) const { return {begins_[process], begins_[process + 1]}; }
  unsigned owner_of(const CellComplex& complex, Index vertex) const;
  void divide(const CellComplex& complex);
  bool exchange(bool fault);
  void exchange(Failure& failure);

  Communicator& processes_;
  std::vector<Index> begins_;               ///< of the vertices of each process, and of the common
  std::vector<std::vector<Index>> common_;  ///< vertices whose forces each process sums
  /// Vertices that others step and this process reads; by process, also the reverse.
  std::vector<Index> borders_;
  std::vector<std::vector<Index>> taken_, given_;
  std::vector<Communicator::Parcel> in_, out_;  ///< of processes with such vertices
  // The present exchange: the numbers of this process, those of all, and how many each gives.
  // The last number of a process says whether it has met a fault.
  std::vector<double> mine_, all_;
  std::vector<int> counts_;
};

}  // namespace suture
