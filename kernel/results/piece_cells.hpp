// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// What one of several processes shows of a body in a frame (output/frame_pieces.hpp).
struct PieceCells {
  std::vector<Index> vertices, elements;  ///< ascending

  /// Range `number` of `count` equal ranges of the elements that exist, and their vertices.
  /// O(elements).
  static PieceCells of(const CellComplex& complex, std::size_t number, std::size_t count);
  /// The elements around these vertices, and those behind their faces. O(elements).
  std::vector<Index> elements_near(const CellComplex& complex) const;
  /// The numbers of the vertices in a frame of the body: removed ones are not counted.
  std::vector<std::int64_t> points(const CellComplex& complex) const;
};

/// All cells of one dimension, or those of a list.
class ShownCells {
 public:
  explicit ShownCells(Index count) : size_(count) {}
  explicit ShownCells(const std::vector<Index>& list)
      : is_all_(false), list_(list.data()), size_(static_cast<Index>(list.size())) {}

  Index size() const { return size_; }
  Index operator[](Index place) const { return is_all_ ? place : list_[place]; }
  /// `none` if the cell is not shown.
  Index place(Index cell) const {
    if (is_all_) return cell;
    if (size_ == 0 || cell < list_[0] || cell > list_[size_ - 1]) return none;
    if (const Index consecutive = cell - list_[0]; consecutive < size_)
      if (list_[consecutive] == cell) return consecutive;
    const Index* const found = std::lower_bound(list_, list_ + size_, cell);
    return *found == cell ? static_cast<Index>(found - list_) : none;
  }

 private:
  bool is_all_ = true;
  const Index* list_ = nullptr;  ///< of an empty list, too
  Index size_;
};

}  // namespace suture
