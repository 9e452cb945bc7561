// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/geometry/geometry_module.hpp"
#include "kernel/parts/pieces.hpp"

namespace suture {

/// A lattice, where it lies, and which of its corners lie inside a surface.
struct CornerLattice : Lattice {
  CubeGrid corners;  ///< cubes of which these are the centres, as GeometryModule::fill() wants them
  std::vector<std::uint8_t> inside;

  Vec3 place_of_corner(const std::array<Index, 3>& at) const {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = corners.origin[a] + corners.edge * (double(at[a]) + 0.5);  // as fill() has it
    return p;
  }
};

/// Where a surface crosses the edges of the tetrahedra in cubes of a lattice.
class Crossings {
 public:
  /// The least distance of a crossing from the ends, as a share of the edge.
  static constexpr double nearest = 0.02;

  /// Finds the crossings of all edges of the pieces, each once, with a triangle that is known
  /// exactly to cross the edge. 0.1 us per triangle, and 1 us per edge if triangles are no smaller
  /// than cubes.
  Crossings(const CornerLattice& lattice, const std::vector<Piece>& pieces,
            const TriangleSurface& surface);

  /// The share of the edge, from its low corner.
  double of(const Piece& piece, PatternPoint point) const;

 private:
  std::size_t key_of(const Piece& piece, PatternPoint point) const;

  const CornerLattice& lattice_;
  std::vector<std::size_t> keys_;  ///< ascending
  std::vector<double> shares_;
};

}  // namespace suture
