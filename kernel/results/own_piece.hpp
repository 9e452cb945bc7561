// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/results/fields.hpp"

// What one of several processes needs for its piece of a frame.

namespace suture {

/// The vertices whose rows the fields of a piece read, by vertex. O(elements).
std::vector<bool> vertices_read_for(const PieceCells& piece, BuiltScene& built,
                                    const std::vector<FieldChoice>& fields);

/// During its life, this process has the positions, velocities and forces at some vertices of
/// others, too, and columns are as they are. All processes make one.
class RowsAt {
 public:
  RowsAt(Body& body, const std::vector<bool>& vertices);
  ~RowsAt();
  RowsAt(const RowsAt&) = delete;
  RowsAt& operator=(const RowsAt&) = delete;

 private:
  PartialRows::OwnIsEnough as_they_are_;
  Column& force_;
  std::vector<Index> with_force_;  ///< vertices of others
};

/// The whole frame on process 0, from the pieces of all.
Frame join_pieces(const Frame& mine, BodyShare& share);

}  // namespace suture
