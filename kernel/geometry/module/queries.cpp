// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions to triangles: which cubes they enclose and which links they cross, exactly.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/saturate.hpp"
#include "kernel/geometry/module/parts.hpp"

namespace suture::cgal {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangles = std::vector<Kernel::Triangle_3>;

Point to_point(const Vec3& p) { return {p[0], p[1], p[2]}; }

// ------------------------------------------------------------------- links --

/// Whether the triangle has the ends of the link on different sides (an end on its
/// plane is on the positive one), and the line through them meets it, its border
/// included. Exact. A triangle without area crosses nothing.
bool separates(const Kernel::Triangle_3& t, const Point& a, const Point& b) {
  const bool a_above = CGAL::orientation(t[0], t[1], t[2], a) != CGAL::NEGATIVE;
  const bool b_above = CGAL::orientation(t[0], t[1], t[2], b) != CGAL::NEGATIVE;
  if (a_above == b_above) return false;
  bool left = false, right = false;
  for (int i = 0; i < 3; ++i) {
    const auto side = CGAL::orientation(a, b, t[i], t[i + 1]);
    left = left || side == CGAL::POSITIVE;
    right = right || side == CGAL::NEGATIVE;
  }
  return !(left && right);
}

using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

/// Goes down where the boxes meet, until one triangle is crossed.
struct Search {
  Point a, b;
  CGAL::Bbox_3 box = a.bbox() + b.bbox();
  bool found = false;

  bool go_further() const { return !found; }
  template <class Query>
  void intersection(const Query&, const Primitive& primitive) {
    found = separates(*primitive.id(), a, b);
  }
  template <class Query, class Node>
  bool do_intersect(const Query&, const Node& node) const {
    return CGAL::do_overlap(node.bbox(), box);
  }
};

class CgalTree final : public TriangleTree {
 public:
  explicit CgalTree(const TriangleSurface& surface) {
    triangles_.reserve(surface.triangles.size());
    for (const Triangle& t : surface.triangles)
      triangles_.emplace_back(to_point(surface.points[t[0]]), to_point(surface.points[t[1]]),
                              to_point(surface.points[t[2]]));
    tree_.insert(triangles_.begin(), triangles_.end());
    tree_.build();
  }
  void crossings(std::span<const Segment> links, std::uint8_t* crossed) const override {
    for (std::size_t i = 0; i < links.size(); ++i) {
      Search search{to_point(links[i].a), to_point(links[i].b)};
      tree_.traversal(0, search);
      crossed[i] = search.found;
    }
  }

 private:
  Triangles triangles_;
  Tree tree_;
};

// ------------------------------------------------------------------- cubes --

/// Signed crossings of rows of cube centres, in front of each cube of the row.
///
/// A row is a line along x. It passes a triangle whose projection along x holds the
/// row's (y, z); if that lies on the projected edge, (y + e, z + e^2) with an infinitely
/// small e decides, so that of two triangles with a common edge exactly one is passed.
class RowCrossings {
 public:
  explicit RowCrossings(const CubeGrid& grid) : grid_(grid), turns_(grid.size()) {}

  void pass(Point p, Point q, Point r) {
    const auto facing = CGAL::orientation(flat(p), flat(q), flat(r));
    if (facing == CGAL::COLLINEAR) return;
    if (facing == CGAL::RIGHT_TURN) std::swap(q, r);
    const auto [k0, k1] = range({p.z(), q.z(), r.z()}, 2);
    for (Index k = k0; k < k1; ++k) {
      const auto [j0, j1] = range_near({p, q, r}, centre(2, k));
      for (Index j = j0; j < j1; ++j) {
        const Kernel::Point_2 row(centre(1, j), centre(2, k));
        if (!left_of(p, q, row) || !left_of(q, r, row) || !left_of(r, p, row)) continue;
        const Index i = first_behind(p, q, r, j, k);
        // The outer side faces +x: the row leaves the body.
        if (i < grid_.cells[0]) turns_[place(i, j, k)] += facing == CGAL::LEFT_TURN ? -1 : 1;
      }
    }
  }

  std::vector<std::uint8_t> inside() const {
    std::vector<std::uint8_t> result(turns_.size());
    for (std::size_t row = 0; row < turns_.size(); row += grid_.cells[0]) {
      int winding = 0;
      for (std::size_t i = row; i < row + grid_.cells[0]; ++i)
        result[i] = (winding += turns_[i]) != 0;
    }
    return result;
  }

 private:
  static Kernel::Point_2 flat(const Point& p) { return {p.y(), p.z()}; }
  double centre(int axis, Index i) const {
    return grid_.origin[axis] + grid_.edge * (double(i) + 0.5);
  }
  std::size_t place(Index i, Index j, Index k) const {
    return i + std::size_t{grid_.cells[0]} * (j + std::size_t{grid_.cells[1]} * k);
  }
  // Cubes whose centres may lie between the coordinates, and one more on each side.
  std::pair<Index, Index> range(std::initializer_list<double> x, int axis) const {
    const double cells = grid_.cells[axis];
    const double low = (std::min(x) - grid_.origin[axis]) / grid_.edge;
    const double high = (std::max(x) - grid_.origin[axis]) / grid_.edge;
    return {saturate<Index>(std::clamp(std::floor(low) - 1, 0.0, cells)),
            saturate<Index>(std::clamp(std::ceil(high) + 1, 0.0, cells))};
  }
  // Cubes along y near the part of a triangle within an edge of this z: a slanting sliver has far
  // fewer than its bounding box.
  std::pair<Index, Index> range_near(const std::array<Point, 3>& corners, double z) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < 3; ++i) {
      const Point &a = corners[i], &b = corners[(i + 1) % 3];
      const double from = a.z() - z, to = b.z() - z, reach = grid_.edge;
      if (std::min(from, to) > reach || std::max(from, to) < -reach) continue;
      for (const double end : {-reach, reach}) {
        const double share = from == to ? 0 : std::clamp((end - from) / (to - from), 0.0, 1.0);
        const double y = a.y() + share * (b.y() - a.y());
        low = std::min({low, y, from == to ? b.y() : y});
        high = std::max({high, y, from == to ? b.y() : y});
      }
    }
    return low <= high ? range({low, high}, 1) : std::pair<Index, Index>{0, 0};
  }
  static bool left_of(const Point& p, const Point& q, const Kernel::Point_2& row) {
    const auto side = CGAL::orientation(flat(p), flat(q), row);
    if (side != CGAL::COLLINEAR) return side == CGAL::LEFT_TURN;
    return p.z() != q.z() ? q.z() < p.z() : q.y() > p.y();
  }
  // The first cube of the row with its centre behind the triangle, or on it.
  Index first_behind(const Point& p, const Point& q, const Point& r, Index j, Index k) const {
    const double y = centre(1, j), z = centre(2, k);
    Index low = 0, high = grid_.cells[0];
    while (low < high) {
      const Index middle = low + (high - low) / 2;
      if (CGAL::orientation(p, q, r, Point(centre(0, middle), y, z)) != CGAL::NEGATIVE)
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  }

  const CubeGrid& grid_;
  std::vector<std::int16_t> turns_;
};

}  // namespace

std::unique_ptr<TriangleTree> tree(const TriangleSurface& surface) {
  return std::make_unique<CgalTree>(surface);
}

bool crosses(const std::array<Vec3, 3>& t, const Segment& link) {
  return separates({to_point(t[0]), to_point(t[1]), to_point(t[2])}, to_point(link.a),
                   to_point(link.b));
}

std::vector<std::uint8_t> fill(const TriangleSurface& surface, const CubeGrid& grid) {
  RowCrossings rows(grid);
  for (const Triangle& t : surface.triangles)
    rows.pass(to_point(surface.points[t[0]]), to_point(surface.points[t[1]]),
              to_point(surface.points[t[2]]));
  return rows.inside();
}

}  // namespace suture::cgal
