// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kernel/dynamics/body.hpp"

// What rules out rest
// ===================
//
// Only a resultant along a free translation does so with certainty. A body that can only turn
// finds its hanging position, as a pendulum does, and loads may balance. Models whose tangent
// resists the translation, such as springs to the ground, also hold the body. Without a tangent
// this cannot be decided, so it is only a warning. A free bar compressed by two loads is at rest;
// its lowest eigenvalue (modes.hpp) shows that it will turn round.

namespace suture {

/// A connected piece that its constraints leave free to move as a rigid body.
struct FreePiece {
  Index first_element = none;  ///< its smallest user number
  Index elements = 0;
  std::array<bool, 3> translations{};  ///< along x, y, z
  std::vector<Vec3> axes;              ///< of independent rotations, unit vectors
  Vec3 force{};                        ///< sum of the given forces, N
  double force_scale = 0;              ///< sum of their magnitudes, N
  Index number = none;                 ///< among the pieces (pieces_of())
  Vec3 centre{};                       ///< mean of the positions of its vertices, m
  double radius = 0;                   ///< root mean square of their distances from it, m
  /// Its independent free motions: the velocity at x is t + w x (x - centre) / radius, with t the
  /// first three numbers and w the others.
  std::vector<std::array<double, 6>> modes;

  /// True if there is a resultant force along a free translation, which accelerates the piece
  /// indefinitely.
  bool is_pushed() const;
  /// "move along x and y and turn about z"
  std::string motions() const;
};

/// The pieces that can move freely. Each constrained component gives a matrix row with its
/// velocities in the six rigid motions of the piece (about its centre, with rotations scaled by its
/// radius); the free motions are the null space of the 6 x 6 normal matrix, with eigenvalues below
/// 1e-9 of its trace. Translations are free or not by component, like constraints. Positions are
/// the current ones; moved vertices count as constrained. `force`: rows of 4 per vertex.
/// O(elements).
std::vector<FreePiece> find_free_pieces(const CellComplex& complex, Attributes& attributes,
                                        const std::vector<double>& force);

/// Whether models and foundations leave the translations of a piece for which `matters[c]`: springs
/// to the ground do not. Costs 4 products with the tangent if there is one.
bool forces_allow_motion(Body& body, const FreePiece& piece, const std::array<bool, 3>& matters);

/// The pieces that neither constraints nor models nor foundations hold. Costs 4 products with the
/// tangent if there is one.
std::vector<FreePiece> find_unheld_pieces(Body& body);

}  // namespace suture
