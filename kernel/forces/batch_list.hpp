// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/task_order.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace suture {

class Archive;

/// The vertices of each row of a table: `nodes` per cell, where `cells` maps a row to its position
/// (null: the row itself). `live`: as in loops::Job; dead rows have no vertices.
struct Connectivity {
  const Index* nodes = nullptr;
  const Index* cells = nullptr;
  Index node_count = 0;
  const std::uint8_t* live = nullptr;

  std::span<const Index> of(Index row) const {
    if (live && (live[row / SUTURE_LANES] >> row % SUTURE_LANES & 1) == 0) return {};
    const std::size_t cell = cells ? cells[row] : row;
    return {nodes + cell * node_count, node_count};
  }
};

/// The rows that one functor visits, in fixed chunks.
///
/// Chunks are coloured so that chunks of one colour share no vertex, and numbered by colour. A
/// chunk waits for earlier chunks with which it shares a vertex, and may run in parallel with all
/// others, on any thread: each vertex receives its forces in a fixed order, so the result is
/// bitwise identical for every number of threads. Few colours make short chains of waiting chunks.
/// The chunk size depends only on the number of rows.
///
/// A cut or a removal only reduces sharing, so colours and order stay valid. Rows added by a cut go
/// to a tail, a single chunk with its own colour that waits for all others, until it holds an
/// eighth of all rows. Then the tail is coloured separately; its first chunk waits for all chunks
/// before the tail, and the rest wait for that one. After a merge, ChunkFinder finds the chunks
/// that now share a vertex.
class BatchList {
 public:
  BatchList() = default;
  /// `rows`: ascending, disjoint ranges. `vertex_count`: of the complex.
  /// O(rows x nodes); 8 B per vertex while it runs.
  BatchList(const Connectivity& cells, std::vector<loops::Rows> rows, Index vertex_count);

  /// Appends rows [first, last), which were added to the table. Returns false if the list should be
  /// rebuilt. Amortised O(rows added).
  bool append(const Connectivity& cells, Index first, Index last, Index vertex_count);

  /// Leaves out the blocks of 8 rows whose vertices are all `fixed`. The order of the others does
  /// not change, and no batch holds rows of two ranges. O(rows x nodes).
  void leave_out(const Connectivity& cells, const std::vector<bool>& fixed);
  Index left_out() const { return left_out_; }

  Index cell_count() const { return cells_ + tail_ - left_out_; }
  Index batch_count() const;
  Index chunk_count() const { return static_cast<Index>(chunk_begin_.size()) - 1; }
  Index colour_count() const { return static_cast<Index>(colour_begin_.size()) - 1; }

  /// The order in which chunks wait for each other.
  const TaskOrder& order() const { return order_; }
  /// Declares that these chunks, in ascending order, share a vertex from now on.
  void meet(std::span<const Index> chunks);

  /// Chunks and their order depend on all calls of append(), leave_out() and meet().
  void state(Archive& archive);

  /// The chunks of colour c are chunk_begin(c) .. chunk_end(c) - 1.
  Index chunk_begin(Index colour) const { return colour_begin_[colour]; }
  Index chunk_end(Index colour) const { return colour_begin_[colour + 1]; }
  std::span<const loops::Rows> ranges(Index chunk) const {
    return std::span(ranges_).subspan(chunk_begin_[chunk],
                                      chunk_begin_[chunk + 1] - chunk_begin_[chunk]);
  }

 private:
  void add_coloured(const Connectivity& cells, std::span<const loops::Rows> rows,
                    loops::Rows vertices);
  void add_chunk(std::span<const loops::Rows> ranges);
  void find_order(const Connectivity& cells, Index first, loops::Rows vertices);

  Index cells_ = 0, tail_ = 0, left_out_ = 0;
  std::vector<loops::Rows> ranges_;
  std::vector<Index> chunk_begin_{0};   // into ranges_
  std::vector<Index> colour_begin_{0};  // into chunks
  TaskOrder order_;
};

/// Finds the chunk of a row. Construction O(ranges log ranges), a query O(log ranges).
class ChunkFinder {
 public:
  explicit ChunkFinder(const BatchList& list);
  Index chunk(Index row) const;  ///< `none` if the row was left out
  Index colour(Index chunk) const { return colour_of_[chunk]; }

 private:
  struct ChunkRows {
    loops::Rows rows;
    Index chunk;
  };
  std::vector<ChunkRows> chunk_rows_;  ///< ascending
  std::vector<Index> colour_of_;
};

/// The number of rows per chunk for a functor that visits `rows` rows: enough chunks to distribute,
/// each small enough for the cache of a core.
Index chunk_rows(Index rows);

/// Colours 0, 1, ... such that chunks of one colour share no vertex, by first fit in the order of
/// the chunks. All their vertices are in `vertices`. Deterministic.
std::vector<Index> colour_chunks(const Connectivity& cells,
                                 std::span<const std::vector<loops::Rows>> chunks,
                                 loops::Rows vertices);

}  // namespace suture
