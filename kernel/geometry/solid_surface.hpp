// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "kernel/geometry/shape.hpp"
#include "kernel/geometry/surface.hpp"

namespace suture {

class OrientedSurface;
class SurfaceTree;

/// A closed surface of triangles as the boundary of a solid, about the middle of its box.
///
/// The distance is that of an OrientedSurface, negative inside.
///
/// A grid of about 65,000 cells stores the distance of each centre, to within 2 %, and a triangle
/// that is about nearest to it. The first rules out most far places in 10 ns, because a distance
/// changes no faster than the place; from the second the search in the tree begins.
class SolidSurface {
 public:
  /// `surface`: closed, oriented outward, without self-intersections (read_solid). Triangles
  /// without area are dropped. Throws InputError if no triangle is left. Cost: 1 to 5 us per cell
  /// and 1 us per triangle.
  explicit SolidSurface(TriangleSurface surface);
  ~SolidSurface();

  /// About 1 us.
  Nearest nearest(const Vec3& place) const;
  /// False only if the distance of the place is larger than this.
  bool may_be_within(const Vec3& place, double distance) const {
    return least_distance(place) <= distance;
  }
  /// The surface, with the middle of its box at the origin.
  const TriangleSurface& surface() const;
  const SurfaceTree& tree() const;                ///< of surface()
  const Vec3& middle() const { return middle_; }  ///< of the box of the surface as given, m
  double radius() const { return radius_; }  ///< of the ball around the origin that contains it, m
  /// The diameter of a ball that fits inside at the centroid of every triangle, m: at least 0.47
  /// of the largest one's, and at most the distance of parallel sides.
  double thickness() const { return thickness_; }
  /// Returns the lengths of the box around it along the principal axes of its points, m.
  std::array<double, 3> extents() const;
  /// The middle of the cell that is deepest inside, if one is inside, and the points of the surface
  /// that are extreme along 13 axes.
  std::vector<Vec3> points_inside() const;

 private:
  struct Cell {
    float distance = 0;  ///< of its centre: that or, farther from the surface, up to 2 % more
    Index nearest = 0;   ///< triangle
    double least() const;
    double greatest() const;
  };
  void make_grid();
  void fill_row(std::size_t first);
  void find_thickness();
  Nearest nearest(const Vec3& place, Index start, Index& triangle) const;
  std::size_t cell_at(const Vec3& place) const;
  Vec3 centre(std::size_t cell) const;
  double least_distance(const Vec3& place) const;
  double greatest_distance(const Vec3& place) const;
  bool is_inside(const Vec3& place, double distance) const;

  std::unique_ptr<OrientedSurface> oriented_;
  Vec3 middle_{};
  Box box_ = no_box;
  double radius_ = 0, thickness_ = 0;
  Vec3 low_{};
  double edge_ = 1;
  std::array<std::size_t, 3> count_{};
  std::vector<Cell> cells_;  ///< along x, then y, then z
};

}  // namespace suture
