// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/parts/cut_patterns.hpp"

namespace suture {

/// The material of one hexahedron: a connected part of a cube of a lattice, by its inner corners.
struct Piece {
  std::size_t cube = 0;  ///< number along x, then y, then z
  CornerSet corners = 0;
};

/// The cubes of a lattice and their corners, numbered along x, then y, then z.
struct Lattice {
  std::array<Index, 3> cubes{};

  std::size_t step(int axis) const {  ///< between the numbers of neighbouring cubes
    return axis == 0 ? 1 : step(axis - 1) * cubes[static_cast<std::size_t>(axis - 1)];
  }
  std::array<Index, 3> place(std::size_t cube) const {
    return {Index(cube % cubes[0]), Index(cube / cubes[0] % cubes[1]), Index(cube / step(2))};
  }
  /// The number of a corner.
  std::size_t corner(const std::array<Index, 3>& at) const {
    return at[0] + (cubes[0] + std::size_t{1}) * (at[1] + (cubes[1] + std::size_t{1}) * at[2]);
  }
};

/// The connected parts of all cubes with an inner corner, ascending by cube. `inside`: by corner.
std::vector<Piece> pieces_of(const Lattice& lattice, const std::vector<std::uint8_t>& inside);

/// Drops pieces whose connected material holds fewer than 4 corners, but not the largest: corners
/// near sharp edges of a surface may have no neighbour inside. Returns the number of such islands.
std::size_t drop_specks(const Lattice& lattice, std::vector<Piece>& pieces);

/// Joins pieces of one cube whose hexahedra would share all nodes of a face: at the bottom of a gap
/// that is narrower than a cube, both walls touch the same piece of the next cube. Pieces are thus
/// joined only if their material is connected in the neighbourhood. Returns the number of pieces
/// that are gone.
std::size_t join_pieces(const Lattice& lattice, std::vector<Piece>& pieces);

/// Numbers of the nodes of the hexahedra of pieces, in the order of their first use. Neighbouring
/// hexahedra share the nodes of a face if their material touches there; others do not.
std::vector<Hexahedron> nodes_of(const Lattice& lattice, const std::vector<Piece>& pieces);

}  // namespace suture
