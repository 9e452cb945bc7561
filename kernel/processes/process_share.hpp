// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/forces/force_share.hpp"
#include "kernel/processes/communicator.hpp"

namespace suture {

/// Each process sums the forces on its own vertices, over all cells there: no sum crosses a border.
/// Its vertices are those whose first element is in its range of the elements. The ranges are
/// equal, and elements in an order that is local (ordering.hpp) share few vertices. As vertices are
/// numbered by first use, its own are consecutive, and their rows need not be packed; those that
/// operations add follow in packed form.
class ProcessShare final : public ForceShare {
 public:
  /// The communicator must outlive it.
  explicit ProcessShare(Communicator& processes);

  std::vector<bool> others(const CellComplex& complex) override;
  void join(double* rows, Failure& failure) override;
  loops::Rows part(Index count) const override { return part_of(processes_.rank(), count); }
  void join_sums(std::span<double> sums, Failure& failure) override;

 private:
  loops::Rows part_of(unsigned process, Index count) const;
  void exchange(Failure& failure);

  Communicator& processes_;
  std::vector<Index> borders_;             ///< vertices from each to the next are of one process
  std::vector<std::vector<Index>> added_;  ///< vertices of each process behind the last border
  // The present exchange: the numbers of this process, those of all, and how many each gives.
  // The last number of a process says whether it has failed.
  std::vector<double> mine_, all_;
  std::vector<int> counts_;
};

}  // namespace suture
