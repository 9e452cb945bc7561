// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

class Archive;

/// Which rows of a table are live: a byte per block of 8 rows, a bit per lane, as the
/// loops over batches read it. Rows never move, so a row whose cell was removed remains
/// as a hole. Nothing is stored as long as every row is live.
class LiveMask {
 public:
  static constexpr std::uint8_t full = 0xFF;  ///< every row of a block is live

  bool all() const { return blocks_.empty(); }
  bool operator[](Index row) const { return all() || (blocks_[row / 8] >> row % 8 & 1) != 0; }
  Index dead() const { return dead_; }

  /// `rows`: number of rows of the table. O(1); the first call O(rows).
  void kill(Index row, Index rows) {
    if (all()) blocks_.assign(blocks_for(rows), full);
    dead_ += (*this)[row] ? 1 : 0;
    blocks_[row / 8] &= static_cast<std::uint8_t>(~(1u << row % 8));
  }
  /// New rows are live, and so are the lanes after the last row.
  void resize(Index rows) {
    if (!all()) blocks_.resize(blocks_for(rows), full);
  }

  bool fits(Index rows) const { return all() || blocks_.size() == blocks_for(rows); }
  void state(Archive& archive);

  /// Null while all rows are live.
  const std::uint8_t* data() const { return all() ? nullptr : blocks_.data(); }

 private:
  static std::size_t blocks_for(Index rows) { return rows / std::size_t{8} + 1; }

  std::vector<std::uint8_t> blocks_;
  Index dead_ = 0;
};

}  // namespace suture
