// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/contact/contact_in_progress.hpp"
#include "kernel/contact/piece_contact.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

/// Pushes the vertices of whole elements out of obstacles and pieces. A vertex that only obstacles
/// push depends on no other one; where pieces touch, their sweeps and those pushes take turns.
class VertexPushes {
 public:
  /// `edge`: the shortest of the elements, m. All outlive this.
  VertexPushes(Attributes& attributes, ContactInProgress& step, double edge)
      : attributes_(attributes), step_(step), edge_(edge) {}
  void touch(PieceContact& pieces) { pieces_ = &pieces; }

  /// Adds the vertices of what touches to those near obstacles.
  void find_touching(const ContactStep& step);
  /// Obstacles have the last word: nothing is left inside them.
  void push(double dt);
  /// That of a vertex by its place in PieceContact::touching().
  const ContactInProgress::Near& near(Index place) const { return step_.near[near_place_[place]]; }

 private:
  void move(const ContactInProgress::Near& near, double dt);
  void push_out(std::size_t i, double dt);
  void settle(std::size_t i, bool meets, double dt);
  Vec3 velocity(std::size_t i) const {
    return row(attributes_.velocity().rows(), step_.pushed[i].vertex);
  }

  Attributes& attributes_;
  ContactInProgress& step_;
  double edge_;
  PieceContact* pieces_ = nullptr;
  std::vector<Index> near_place_;  ///< in near, by place in PieceContact::touching()
  std::vector<Index> shared_;      ///< places in pushed of those that pieces touch, too
};

}  // namespace suture
