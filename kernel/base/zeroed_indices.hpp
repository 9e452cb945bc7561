// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#include "kernel/base/types.hpp"

namespace suture {

/// A table over all cells of which an operation needs the rows of a few: they are 0 until they are
/// written, and its pages take memory only where they are touched. A large table that is filled
/// when the first operation asks for it costs more than the operation.
class ZeroedIndices {
 public:
  /// Makes room for `count` rows and some that will be added. Where it was too small, all rows are
  /// 0 again. O(1) for large tables.
  void reserve(std::size_t count) {
    if (count <= count_) return;
    const std::size_t with_more = count + count / 2;
    auto* const rows = static_cast<Index*>(std::calloc(with_more, sizeof(Index)));
    if (!rows) throw std::bad_alloc();
    rows_.reset(rows);
    count_ = with_more;
  }
  Index& operator[](std::size_t row) { return rows_[row]; }
  Index operator[](std::size_t row) const { return rows_[row]; }

 private:
  struct Free {
    void operator()(Index* rows) const { std::free(rows); }
  };
  std::unique_ptr<Index[], Free> rows_;
  std::size_t count_ = 0;
};

}  // namespace suture
