// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/mesh/parts.hpp"

// A blade divides the material of an element. The material is a set of tetrahedra in the reference
// cube: of a full element the six around the diagonal X0-X7, of a part those that earlier cuts, or
// the surface of the body, have left. Each tetrahedron is clipped into tetrahedra on both sides:
//
//      +----------+            +----------+      Points near the blade, to within a tolerance,
//      |        / |            |   1    / |      are on it (0): no sliver is left between blade
//      |  -   /   |            |      0   |      and point, and blades along the faces of a grid
//      |    / +   |  ------>   |    / | 2 |      separate the elements that meet there.
//      |  /       |            |  /   |   |
//      +----------+            +------0---+
//
// Both sides of a face that two elements share must be divided in the same way. They are: what is
// done on a face depends on the heights and places of its points alone, and points are compared by
// their places in the cube, whose order is the same in all elements of a grid.

namespace suture {

/// The material of an element, or a connected part of it.
struct Material {
  std::vector<Vec3> points;                      ///< in the reference cube [-1, 1]^3
  std::vector<std::array<Index, 4>> tetrahedra;  ///< positively oriented
  /// By tetrahedron: its convex cell (coarse_parts.hpp), numbered from 0.
  std::vector<Index> cells;
  /// The surface of the body inside the cube, oriented outwards; sides of the cube do not count.
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::uint8_t> is_cut;  ///< by triangle: a blade made it

  static const Material& full_element();
  /// Keeps the memory.
  void clear() {
    points.clear();
    tetrahedra.clear();
    cells.clear();
    triangles.clear();
    is_cut.clear();
  }
};

/// A connected part of a divided material. Each cell of the material is divided into one on either
/// side of the blade.
struct DividedPart {
  Material material;
  PartMoments moments;
  int side = 0;  ///< -1 below the blade, 1 above it
};

/// The side of the material, if no blade divides it: 0 if it does. `heights`: above the blade, by
/// point; those of at most `tolerance` are on it.
int side_of(const Material& material, const std::vector<double>& heights, double tolerance);

/// A material in finer tetrahedra.
struct RefinedMaterial {
  Material material;
  std::vector<Index> sources;  ///< by triangle: the one of the material before in which it lies
};

/// Divides materials one after the other, in memory that it keeps.
class Divider {
 public:
  Divider();
  ~Divider();

  /// Parts are connected through faces; those smaller than 1e-13 of the cube are dropped. In the
  /// order of their first tetrahedra. About 2 us for a full element.
  std::vector<DividedPart> divide(const Material& material, const std::vector<double>& heights,
                                  double tolerance);
  /// Clips a material in the same way, but leaves it in one piece. Its triangles may lie on sides
  /// of the cube, too.
  RefinedMaterial refine(const Material& material, const std::vector<double>& heights,
                         double tolerance);
  /// The share of the cube in the parts that the last divide() has dropped.
  double dropped() const;

 private:
  class Clipping;
  class FacePairs;
  class PartBuilder;
  std::unique_ptr<Clipping> clipping_;
  std::unique_ptr<FacePairs> faces_;
  std::unique_ptr<PartBuilder> parts_;
};

}  // namespace suture
