// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <unordered_map>

#include "kernel/parts/part_materials.hpp"
#include "kernel/parts/side_triangles.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The contact of elements at faces, at rest.
class FaceContacts {
 public:
  /// `parts` must outlive this.
  explicit FaceContacts(const Parts& parts) : materials_(parts) {}
  const SideTriangles& triangles_of(Index element) const;
  /// Twice the area, in the reference cube, that covers each other.
  double area(const Seam& seam) const;
  /// What lies open on both sides of elements that are joined by seams: triangles only.
  Parts uncovered(std::span<const Seam> seams) const;

 private:
  PartMaterials materials_;
  mutable std::unordered_map<Index, SideTriangles> triangles_;
};

}  // namespace suture
