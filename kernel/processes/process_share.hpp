// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/forces/body_share.hpp"
#include "kernel/processes/communicator.hpp"

namespace suture {

/// Equal ranges of the elements that exist, one for each process. As elements are in an order that
/// is local (ordering.hpp), ranges share few vertices. Where the work on a vertex is done:
///
///   numbered with the mesh   stepped, and its forces summed, by the process of its block, which is
///                            that of the first elements of the block's vertices: vertices are
///                            numbered by first use, so they need not be packed
///   made by operations       summed where its first element is, so no cell is computed for it in
///                            vain; stepped by the process of its block, or by all in the last one
///
/// Blocks are ranges of 4096 vertices, as sums over vertices are made of these.
class ProcessShare final : public BodyShare {
 public:
  /// Shares of the complex as it is built. The communicator must outlive it. `threads`: of this
  /// process.
  ProcessShare(Communicator& processes, unsigned threads, const CellComplex& complex);

  std::span<const loops::Rows> own() const override { return own_[processes_.rank()]; }
  Index common_begin() const override {
    return static_cast<Index>(process_of_block_.size()) * aligned;
  }
  void divide(const CellComplex& complex) override;
  void follow(const CellComplex& complex) override;
  std::vector<bool> others(const CellComplex& complex) override;
  void join_forces(VertexRows rows, Failure& failure) override;
  void complete(VertexRows rows) override;
  void gather(VertexRows rows) override;
  void read(const std::vector<bool>& vertices) override;
  std::span<const Index> borders() const override { return borders_; }
  void join_borders(std::span<double* const> columns) override { join(at_borders_, columns); }
  void join_borders(VertexRows rows) override { join_rows(at_borders_, rows); }
  std::vector<Index> join_at(const std::vector<bool>& vertices,
                             std::span<double* const> columns) override;
  std::span<const PartialRows::Range> known() const override { return known_; }
  void release(VertexRows rows) const override;
  bool join_blocks(std::span<double> rows, std::size_t width, bool good) override;
  bool all(bool good) override { return processes_.largest(good ? 0 : 1) == 0; }
  std::vector<Part> parts() const override;
  unsigned number() const override { return processes_.rank(); }
  unsigned processes() const override { return processes_.size(); }
  loops::Rows elements() const override;
  unsigned process_at(const CellComplex& complex, Index vertex) const override;
  void read_at_cells(const std::vector<bool>& vertices) override;
  void complete_at_cells(double* column) override { join(at_cells_, {&column, 1}); }
  void join_sums(std::span<double> sums, std::span<const unsigned> processes,
                 Failure& failure) override;
  std::vector<Index> join_lists(const std::vector<Index>& mine) override;
  void collect(const Bytes& mine, const std::function<void(const Bytes&)>& take) override;

 private:
  /// Vertices: whole ranges of every sum over vertices (Motion).
  static constexpr Index aligned = 4 * block;
  /// By process: vertices whose rows this process gets from it, and gives to it.
  struct Exchange {
    std::vector<std::vector<Index>> taken, given;
    std::vector<Communicator::Parcel> in, out;  ///< of processes with such vertices
    void clear(unsigned processes);
    void prepare();
  };

  Index steps(unsigned process) const;
  void find(Exchange& exchange, const std::vector<bool>& vertices);
  template <class Give, class Take>
  void join(Exchange& exchange, std::size_t numbers, Give give, Take take);
  void join(Exchange& exchange, std::span<double* const> columns);
  void join_rows(Exchange& exchange, VertexRows rows);
  void divide_elements(const CellComplex& complex);
  void divide_blocks(const CellComplex& complex);
  bool is_in_order() const;
  std::vector<double> own_rows(VertexRows rows);
  void take(const double* packed, VertexRows rows) const;
  void join_common(VertexRows rows, Failure& failure);
  bool exchange(bool fault);
  void exchange(Failure& failure);

  Communicator& processes_;
  std::vector<std::string> machines_;          ///< of each process, with its threads
  std::vector<Index> element_begins_;          ///< of the elements of each process, and their end
  const Index mesh_blocks_;                    ///< of vertices that are numbered with the mesh
  std::uint64_t changed_elements_ = 0;         ///< removed and copied before the last division
  std::vector<unsigned> process_of_block_;     ///< that steps its vertices
  std::vector<std::vector<loops::Rows>> own_;  ///< the same by process
  std::vector<std::vector<Index>> common_;     ///< vertices whose forces each process sums
  Exchange moved_;                             ///< vertices that others step than sum their forces
  std::vector<Index> borders_;                 ///< vertices that others step and this process reads
  std::vector<PartialRows::Range> known_;
  Exchange at_borders_, at_cells_;
  // The present exchange: the numbers of this process, those of all, and how many each gives.
  // The last number of a process says whether it has met a fault.
  std::vector<double> mine_, all_;
  std::vector<int> counts_;
};

}  // namespace suture
