// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "kernel/parts/division.hpp"

namespace suture {

/// Writes the parts of the copies of elements, copy by copy in ascending order, and the surface
/// that they bring.
class PartWriter {
 public:
  /// `parts`: empty; must outlive this.
  explicit PartWriter(Parts& parts) : parts_(parts) { parts_.first.push_back(0); }

  /// Room for so many more of each.
  void reserve(std::size_t points, std::size_t tetrahedra, std::size_t triangles);
  /// Points and tetrahedra of a copy. Returns the number of its first point.
  Index add_volume(Index copy, const Material& material);
  /// A triangle of a material whose first point has that number.
  void add_triangle(Index first, const std::array<Index, 3>& corners, bool is_cut);
  /// A triangle of an element that a blade has laid open, at places in its reference cube.
  void add_open_triangle(Index element, const std::array<Vec3, 3>& places);
  /// A copy is whole with its last tetrahedron.
  void end_copy(Index copy, const PartMoments& moments);

 private:
  Index add_points(Index element, std::span<const Vec3> places);

  Parts& parts_;
  Index next_cell_ = 0;  ///< of the copy that is being written
};

}  // namespace suture
