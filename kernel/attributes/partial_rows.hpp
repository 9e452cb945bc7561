// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <utility>

#include "kernel/attributes/column.hpp"

namespace suture {

/// Says which of the columns that steps change have only some rows up to date: several processes
/// hold the body, and each steps rows of its own (forces/body_share.hpp). Whoever asks for such a
/// column gets all rows, and the others then have to ask for it, too. Steps alone ask for own rows.
class PartialRows {
 public:
  enum Of : unsigned { position, velocity, force };

  /// `complete` fills in the rows of the other processes.
  void complete_by(std::function<void(double* rows)> complete) { complete_ = std::move(complete); }
  void set(Of which, bool partial) { is_partial_[which] = partial; }
  bool is_partial(Of which) const { return is_partial_[which]; }

  Column& whole(Of which, Column& column) {
    if (is_partial_[which] && !own_is_enough_) {
      is_partial_[which] = false;
      complete_(column.rows());
    }
    return column;
  }

  /// During its life, columns are as they are.
  class OwnIsEnough {
   public:
    explicit OwnIsEnough(PartialRows& rows, bool enough = true)
        : flag_(rows.own_is_enough_), before_(std::exchange(flag_, enough)) {}
    ~OwnIsEnough() { flag_ = before_; }
    OwnIsEnough(const OwnIsEnough&) = delete;
    OwnIsEnough& operator=(const OwnIsEnough&) = delete;

   private:
    bool& flag_;
    bool before_;
  };

 private:
  std::array<bool, 3> is_partial_{};
  bool own_is_enough_ = false;
  std::function<void(double* rows)> complete_;
};

}  // namespace suture
