// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/forces/load_profile.hpp"
#include "kernel/forces/quad.hpp"
#include "kernel/parts/surface_triangle.hpp"

// What a pressure acts on. The force on node a, and its derivative, are
//   f_a  = p  integral of N_a dx/dr x dx/ds  dr ds,   dx/dr x dx/ds inward
//   df_a = p  sum_b w_ab x du_b,   w_ab = integral of N_a (dx/dr dN_b/ds - dx/ds dN_b/dr) dr ds

namespace suture {

/// A boundary face: bilinear, with four nodes.
struct PressedFace {
  static constexpr std::size_t node_count = 4;
  static constexpr bool may_be_divided = false;
  using Given = Dart;  ///< any dart of the face, on the side of the element that carries it
  using Positions = std::array<Vec3, node_count>;
  using Arms = std::array<std::array<Vec3, node_count>, node_count>;

  Dart face;
  std::array<double, node_count> factors{1, 1, 1, 1};  ///< of the pressure at the nodes

  static std::vector<PressedFace> all(const RestPlaces& rest, std::span<const Dart> faces,
                                      const LoadProfile& profile);
  std::array<Index, node_count> nodes(const CellComplex& complex) const {
    return face_nodes(complex, face);
  }
  bool exists(const CellComplex& complex) const { return is_open(complex, face); }
  Positions forces(const Positions& x, double pressure) const;
  Arms arms(const Positions& x) const;
  static void state(Archive& archive, std::vector<PressedFace>& faces);
};

/// The triangles of the embedded surface in one element. On a closed surface the forces add up to
/// zero: the surface has no gaps between elements, and the quadrature is exact.
struct PressedPart {
  static constexpr std::size_t node_count = hexahedron::vertices;
  static constexpr bool may_be_divided = true;   ///< by a cut along a blade
  static constexpr std::size_t pair_count = 21;  ///< of nodes 1 <= b < c <= 7
  using Given = SurfaceTriangle;
  using Positions = std::array<Vec3, node_count>;
  using Arms = std::array<std::array<Vec3, node_count>, node_count>;

  Index element;
  /// By node a and pair (b, c): integral of N_a (dN_b/dr dN_c/ds - dN_b/ds dN_c/dr) dr ds, times
  /// the profile.
  std::array<std::array<double, pair_count>, node_count> products{};

  static std::vector<PressedPart> all(const RestPlaces& rest,
                                      std::span<const SurfaceTriangle> triangles,
                                      const LoadProfile& profile);
  std::array<Index, node_count> nodes(const CellComplex& complex) const {
    return complex.vertices_of(element);
  }
  bool exists(const CellComplex& complex) const { return complex.exists(3, element); }
  Positions forces(const Positions& x, double pressure) const;
  Arms arms(const Positions& x) const;
  static void state(Archive& archive, std::vector<PressedPart>& parts);
};

}  // namespace suture
