// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <utility>

#include "kernel/attributes/column.hpp"

namespace suture {

/// Says which of the columns that steps change have only some rows up to date: several processes
/// hold the body, and each steps rows of its own (forces/body_share.hpp). Whoever asks for such a
/// column gets all rows, and the others then have to ask for it, too. Steps alone ask for own rows,
/// and sums over cells for the rows at the cells that the process sums.
class PartialRows {
 public:
  enum Of : unsigned { position, velocity, force };
  /// Each includes those before it.
  enum class Extent : unsigned char { own, at_cells, all };
  using Complete = std::function<void(double* rows)>;

  /// Functions that fill in rows of the other processes: all, and those at cells.
  void complete_by(Complete all, Complete at_cells) {
    complete_ = std::move(all);
    complete_at_cells_ = std::move(at_cells);
  }
  void set(Of which, bool partial) { has_[which] = partial ? Extent::own : Extent::all; }
  bool is_partial(Of which) const { return has_[which] != Extent::all; }

  Column& whole(Of which, Column& column) {
    if (has_[which] < needed_) {
      has_[which] = needed_;
      (needed_ == Extent::all ? complete_ : complete_at_cells_)(column.rows());
    }
    return column;
  }

  /// During its life, whoever asks for a column gets these rows.
  class Enough {
   public:
    Enough(PartialRows& rows, Extent extent)
        : needed_(rows.needed_), before_(std::exchange(needed_, extent)) {}
    ~Enough() { needed_ = before_; }
    Enough(const Enough&) = delete;
    Enough& operator=(const Enough&) = delete;

   private:
    Extent& needed_;
    Extent before_;
  };
  /// During its life, columns are as they are.
  struct OwnIsEnough : Enough {
    explicit OwnIsEnough(PartialRows& rows, bool enough = true)
        : Enough(rows, enough ? Extent::own : Extent::all) {}
  };

 private:
  std::array<Extent, 3> has_{Extent::all, Extent::all, Extent::all};
  Extent needed_ = Extent::all;
  Complete complete_, complete_at_cells_;
};

}  // namespace suture
