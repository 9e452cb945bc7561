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
  Index first_element = none;  ///< the smallest number that users see
  Index elements = 0;
  std::array<bool, 3> translations{};  ///< along x, y, z
  std::vector<Vec3> axes;              ///< of independent rotations, unit vectors
  Vec3 force{};                        ///< sum of the given forces, N
  double force_scale = 0;              ///< sum of their lengths, N

  /// Along a free translation there is a resultant: it is accelerated for ever.
  bool is_pushed() const;
  /// "move along x and y and turn about z"
  std::string motions() const;
};

/// The pieces that are not held. With a row per held component, its velocity in the six
/// rigid motions of the piece (about its centre, rotations over its radius), the free motions
/// are the null space of the 6 x 6 normal matrix: eigenvalues below 1e-9 of its trace.
/// Translations are free or not by component, as constraints are. Positions are those at
/// present; moved vertices count as held. `force`: rows of 4 per vertex. O(elements).
std::vector<FreePiece> find_free_pieces(const CellComplex& complex, Attributes& attributes,
                                        const std::vector<double>& force);

}  // namespace suture
