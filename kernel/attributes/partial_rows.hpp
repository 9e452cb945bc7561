// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
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
  using Range = std::pair<Index, Index>;  ///< rows first .. end-1
  struct Others {
    using Exchange = std::function<void(double* rows)>;
    /// Fill in the rows of other processes: all of them, those at cells, and all on process 0.
    Exchange complete, complete_at_cells, gather;
    /// What this process steps and reads in steps, ascending; none while that is not known.
    std::function<std::span<const Range>()> known;
  };
  void share_with(Others others) { others_ = std::move(others); }

  /// Others::known; none if this process has the body alone: then it has all rows.
  std::span<const Range> known() const {
    return others_.known ? others_.known() : std::span<const Range>();
  }
  bool keeps_all = false;  ///< states for a rollback have all rows: they go into checkpoints
  void set(Of which, bool partial) { has_[which] = partial ? Extent::own : Extent::all; }
  bool is_partial(Of which) const { return has_[which] != Extent::all; }

  Column& whole(Of which, Column& column) {
    if (has_[which] < needed_) {
      has_[which] = needed_;
      requests_ += needed_ == Extent::all ? 1 : 0;
      (needed_ == Extent::all ? others_.complete : others_.complete_at_cells)(column.rows());
    }
    return column;
  }
  /// Process 0 gets all rows of the column as it is, for files that it writes.
  void gather(Of which, Column& column) {
    if (has_[which] == Extent::all) return;
    ++requests_;
    others_.gather(column.rows());
  }
  std::uint64_t requests() const { return requests_; }  ///< for all rows of a column, so far

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
  std::uint64_t requests_ = 0;
  Others others_;
};

}  // namespace suture
