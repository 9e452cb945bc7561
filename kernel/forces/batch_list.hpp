// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/task_order.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace suture {

class Archive;

/// Which vertices a row of a table touches: `nodes` per cell, `cells` maps a row
/// to its place there (null: the row itself). `live`: as in loops::Job; dead rows touch
/// none.
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
/// Chunks are coloured so that those of one colour share no vertex, and numbered by
/// colour. A chunk waits for those before it with which it shares a vertex, and may run
/// beside all others, on any thread: each vertex receives its forces in one order, so
/// the same bits for every number of threads. Few colours make short chains of chunks
/// that wait. Chunk size depends on the number of rows alone.
///
/// A cut or a removal only takes sharing away, so colours and order stay valid. Rows
/// that a cut adds go to a tail, one chunk and a colour of its own that waits for all,
/// until it is an eighth of all; then the tail is coloured by itself, and its first chunk
/// waits for all before the tail, the rest for that one. After a merge ChunkFinder tells which
/// chunks meet.
class BatchList {
 public:
  BatchList() = default;
  /// `rows`: ascending, disjoint ranges. `vertex_count`: of the complex.
  /// O(rows x nodes); 8 B per vertex while it runs.
  BatchList(const Connectivity& cells, std::vector<loops::Rows> rows, Index vertex_count);

  /// Rows [first, last) were added behind all others. Returns false if it is
  /// time to build the list anew. Amortised O(rows added).
  bool append(const Connectivity& cells, Index first, Index last, Index vertex_count);

  /// Leaves out the blocks of 8 rows all of whose vertices are `still`. The order of
  /// the others stays. O(rows x nodes).
  void leave_out(const Connectivity& cells, const std::vector<bool>& still);
  Index left_out() const { return left_out_; }

  Index cell_count() const { return cells_ + tail_ - left_out_; }
  Index batch_count() const;
  Index chunk_count() const { return static_cast<Index>(chunk_begin_.size()) - 1; }
  Index colour_count() const { return static_cast<Index>(colour_begin_.size()) - 1; }

  /// Which chunks wait for which.
  const TaskOrder& order() const { return order_; }
  /// These chunks, ascending, share a vertex from now on.
  void meet(std::span<const Index> chunks);

  /// Chunks and their order depend on all that was appended, left out and met.
  void state(Archive& archive);

  /// Chunks chunk_begin .. chunk_end of colour c; chunks are numbered by colour.
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

/// Finds the chunk of a row. O(ranges log ranges) to make, O(log ranges) to ask.
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

/// Rows of a chunk for a functor that visits `rows` rows: enough chunks to share
/// out, each large enough to stay in a core's cache for a while.
Index chunk_rows(Index rows);

/// Colours 0, 1, ... such that chunks of one colour share no vertex, by first
/// fit in order of the chunks, all of whose vertices are in `vertices`. Deterministic.
std::vector<Index> colour_chunks(const Connectivity& cells,
                                 std::span<const std::vector<loops::Rows>> chunks,
                                 loops::Rows vertices);

}  // namespace suture
