// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/free_motions.hpp"

namespace suture {

/// Inertia relief: holds the rigid motions R of pieces that nothing holds, so that they relax where
/// they are. The forces r on a piece are balanced by those of its acceleration as a rigid body,
///   r - M R a,   a = (R^T M R)^-1 R^T r
/// and motions d lose their rigid part, R (R^T M R)^-1 R^T M d. As the balanced forces have no
/// resultant, as many supports as there are rigid motions carry none of them: they make the
/// linear equations regular and change nothing else.
class InertiaRelief {
 public:
  explicit InertiaRelief(Body& body) : body_(body) {}

  /// Finds the pieces and their motions at the current positions. O(elements).
  void find();
  /// Components, 3 per vertex: of every piece one for each motion.
  const std::vector<std::size_t>& supports() const { return supports_; }

  // Vectors of 3 numbers per vertex, with the motions about the current positions:
  void balance(std::vector<double>& forces) const;
  void remove_rigid_motion(std::vector<double>& direction) const;

 private:
  struct Piece {
    FreePiece motions;
    std::vector<Index> vertices;
  };
  void add_supports(const Piece& piece);

  Body& body_;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> supports_;
};

}  // namespace suture
