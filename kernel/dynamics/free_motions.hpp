// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// A connected piece that its constraints leave free to move as a rigid body.
struct FreePiece {
  Index first_element = none;  ///< its smallest user number
  Index elements = 0;
  std::array<bool, 3> translations{};  ///< along x, y, z
  std::vector<Vec3> axes;              ///< of independent rotations, unit vectors
  Vec3 force{};                        ///< sum of the given forces, N
  double force_scale = 0;              ///< sum of their magnitudes, N

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

}  // namespace suture
