// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/contact/contact.hpp"

namespace suture {

/// Two pieces that are partly or wholly in the same place.
struct PieceOverlap {
  std::array<Index, 2> elements;  ///< the first of each piece
  Index vertices = 0;             ///< of one inside the other
  double depth = 0;               ///< of the deepest one, m
  Vec3 place{};                   ///< its position
};

/// The pieces that are, at their current positions, deeper in each other than this part of
/// a typical edge. O(surface) where none are, O(surfaces squared) for two that are.
std::vector<PieceOverlap> find_piece_overlaps(const Contact& contact, const CellComplex& complex,
                                              Attributes& attributes, double least = 1e-3);

}  // namespace suture
