// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "kernel/base/diagnostics.hpp"
#include "kernel/geometry/element_blocks.hpp"
#include "kernel/geometry/near_grid.hpp"

namespace suture {

class TriangleTree;

/// A stationary blade of triangles, open or closed.
///
/// A face is cut if its link crosses a triangle: the ends lie on different sides of the triangle's
/// plane, and the line through them meets the triangle, including its border. All of this is
/// decided exactly for the given doubles. Consequently
///  - a centroid on the blade counts as lying on the positive side, the one from which the
///    triangle's corners are counterclockwise: its links to the other side are cut;
///  - a link that lies in the plane of a triangle does not cross it;
///  - a link through a common side or corner of triangles crosses all of them and is cut once; the
///    border of an open blade cuts;
///  - a blade along faces lies between centroids and cuts exactly these faces; a blade tangent to
///    the mesh cuts nothing;
///  - where a centroid lies on an edge or corner of the blade, each triangle decides by its own
///    plane, so that too many faces may be cut, but never too few.
class SurfaceBlade {
 public:
  /// Degenerate triangles are dropped with a warning. Throws InputError if there is no triangle, if
  /// a corner is not a valid point or not finite, or if all triangles are degenerate.
  SurfaceBlade(TriangleSurface surface, Diagnostics& diagnostics);
  ~SurfaceBlade();
  SurfaceBlade(SurfaceBlade&&) noexcept;
  SurfaceBlade& operator=(SurfaceBlade&&) noexcept;

  /// A dart of each face cut, 24 e + 4 f with e the smaller element, ascending. Empty if the blade
  /// misses the mesh (why_nothing_was_cut). Boundary faces and removed elements are skipped. A grid
  /// excludes elements far from every triangle; tree queries are made only for links near one. The
  /// result does not depend on the number of threads. Cost: 20 ns per element, and 1 us per link
  /// near the blade; with `blocks`, of the vertices at these places, only for elements near its
  /// box.
  std::vector<Dart> faces_cut(const CellComplex& complex, const Places& places,
                              const Workers* workers = nullptr,
                              const ElementBlocks* blocks = nullptr) const;

  const TriangleSurface& surface() const { return surface_; }
  const Box& box() const { return box_; }

 private:
  TriangleSurface surface_;
  Box box_;
  NearGrid grid_;
  std::unique_ptr<TriangleTree> tree_;
};

}  // namespace suture
