// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/geometry/shape.hpp"
#include "kernel/geometry/surface.hpp"

namespace suture {

class SurfaceTree;

/// A surface of triangles, open or closed, with two sides: each place has a nearest point on it and
/// lies above or below.
///
/// The nearest triangle is found in a SurfaceTree. A place is below if it lies behind the plane
/// through the foot whose normal is the pseudonormal there, the normal of the face, the sum of the
/// normals of both faces at an edge, or the sum of the normals around a vertex, weighted with the
/// angles of the faces. This is exact for closed surfaces that do not intersect themselves
/// (Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243). Beyond the border of an
/// open one, the surface goes on as the plane of its last triangles.
class OrientedSurface {
 public:
  /// Triangles without area are dropped. Throws InputError if no triangle is left. Cost: 1 us per
  /// triangle.
  explicit OrientedSurface(TriangleSurface surface);
  ~OrientedSurface();

  const TriangleSurface& surface() const { return surface_; }
  const SurfaceTree& tree() const { return *tree_; }
  const Vec3& face_normal(Index triangle) const { return face_normals_[triangle]; }

  /// The point of a triangle that is nearest to a place, and the pseudonormal there, of any length.
  struct Foot {
    Index triangle;
    Vec3 point, normal;
    bool is_on_border;
  };
  /// On the nearest triangle; the nearer the triangle `start`, the faster. About 1 us.
  Foot foot(const Vec3& place, Index start = 0) const;
  /// The same on a triangle of SurfaceTree::nearly_nearest(): of the side, the foot tells nothing.
  Foot rough_foot(const Vec3& place, Index start, double least_part) const;
  /// As foot(), or none if the place is `within` or farther away from the surface.
  std::optional<Foot> foot_within(const Vec3& place, double within, Index start) const;
  /// The distance of the place from its foot, negative below. `rounding`: nearer, the direction of
  /// the offset is not used, m.
  static Nearest distance(const Foot& foot, const Vec3& place, double rounding);

  /// Why the sides cannot be told apart: "three triangles share the edge from (..) to (..) m"; ""
  /// if they can. `origin`: what its points are relative to.
  std::string fault(const Vec3& origin = {}) const;

 private:
  struct Side;
  void make_normals();
  void make_edge_normals();
  void find_fault(const std::vector<Side>& sides);
  Foot foot_in(Index triangle, const Vec3& place) const;

  TriangleSurface surface_;
  std::vector<Vec3> face_normals_;                 ///< of length 1
  std::vector<std::array<Vec3, 3>> edge_normals_;  ///< of the edges 01, 12, 20; of any length
  std::vector<Vec3> vertex_normals_;
  std::vector<std::array<bool, 3>> is_border_edge_;
  std::vector<bool> is_border_vertex_;
  std::unique_ptr<SurfaceTree> tree_;
  struct Fault {
    std::string what;  ///< "": none
    Vec3 from, to;     ///< the ends of the edge
  };
  Fault fault_;
};

}  // namespace suture
