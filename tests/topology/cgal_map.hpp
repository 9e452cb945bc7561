// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The oracle: the same hexahedra in CGAL's Linear_cell_complex_for_combinatorial_map,
/// glued by looking for equal sets of four points, with nothing of ours but the
/// numbering of darts (formulas of the dart[6][4] array: each hexahedron as CGAL
/// makes it, dart[j][k] = beta1^k of its j-th face). CGAL stays in one translation unit.
class CgalMap {
 public:
  explicit CgalMap(const Mesh& mesh);
  ~CgalMap();

  /// unsew<3> for each, in the given order.
  void cut(const std::vector<Dart>& faces);

  /// remove_cell<3> for each.
  void pierce(const std::vector<Index>& elements);
  /// sew<3> for each. Throws std::logic_error where CGAL finds it not sewable.
  void sew(const std::vector<Seam>& seams);
  /// The same hexahedra again, numbered after all others; the originals are removed, and the copies
  /// sewn.
  void clone(const Cloning& cloning);
  /// Whether sewing would make two corners of an element one vertex; tries it and
  /// undoes it.
  bool folds(const std::vector<Seam>& seams);

  /// For every dart 24 e + 4 f + k the smallest dart of its orbit: of the cell of
  /// dimension 0..3, or of the connected component (4); `none`
  /// for darts of removed elements.
  std::vector<Dart> orbits(int dimension) const;
  bool is_valid() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
