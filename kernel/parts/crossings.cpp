// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/crossings.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/radix_sort.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

using TriangleCorners = std::array<Vec3, 3>;

TriangleCorners corners_of(const TriangleSurface& surface, const Triangle& t) {
  return {surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]};
}

/// The triangles that may meet each cube of a lattice.
class TrianglesByCube {
 public:
  TrianglesByCube(const CornerLattice& lattice, const TriangleSurface& surface)
      : lattice_(lattice) {
    for (Index t = 0; t < surface.triangles.size(); ++t) {
      Shape shape{.number = t};
      const Vec3 origin = lattice.place_of_corner({0, 0, 0});
      for (std::size_t n = 0; n < 3; ++n) {
        const Vec3& p = surface.points[surface.triangles[t][n]];
        shape.x[n] = scaled(1 / lattice.corners.edge, minus(p, origin));
        include(shape.box, shape.x[n]);
      }
      shape.normal = cross(minus(shape.x[1], shape.x[0]), minus(shape.x[2], shape.x[0]));
      for (std::size_t n = 0; n < 3; ++n)
        shape.outwards[n] = cross(minus(shape.x[(n + 1) % 3], shape.x[n]), shape.normal);
      add(shape, first_cubes(shape.box));
    }
    std::vector<Entry> spare;
    radix_sort(entries_, spare, [](const Entry& entry) { return entry.cube; });
  }

  template <class Visit>
  void for_each(std::size_t cube, Visit visit) const {
    for (auto at = std::ranges::lower_bound(entries_, cube, {}, &Entry::cube);
         at != entries_.end() && at->cube == cube; ++at)
      visit(at->triangle);
  }

 private:
  struct Entry {
    std::size_t cube;
    Index triangle;
  };
  /// Cubes first .. last-1 along each axis.
  struct Cubes {
    std::array<Index, 3> first, last;
  };
  /// Lengths in edges of a cube, from the lattice's corner.
  struct Shape {
    Index number;
    TriangleCorners x{};
    Vec3 normal{};
    std::array<Vec3, 3> outwards{};  ///< in the plane, from the side that begins at x[n]
    Box box = no_box;
  };
  static constexpr double slack = 1e-6;  // far above rounding

  Cubes first_cubes(const Box& box) const {
    Cubes cubes;
    for (std::size_t a = 0; a < 3; ++a) {
      const double end = lattice_.cubes[a];
      cubes.first[a] = static_cast<Index>(std::clamp(std::floor(box.low[a] - slack), 0.0, end - 1));
      cubes.last[a] = static_cast<Index>(
          std::clamp(std::floor(box.high[a] + slack) + 1, cubes.first[a] + 1.0, end));
    }
    return cubes;
  }

  /// Halves the cubes until one is left, or the triangle misses them.
  void add(const Shape& shape, const Cubes& cubes) {
    Vec3 half, middle;
    std::size_t widest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (shape.box.high[a] + slack < cubes.first[a] || shape.box.low[a] - slack > cubes.last[a])
        return;
      half[a] = 0.5 * (cubes.last[a] - cubes.first[a]) + slack;
      middle[a] = 0.5 * (double(cubes.first[a]) + cubes.last[a]);
      if (cubes.last[a] - cubes.first[a] > cubes.last[widest] - cubes.first[widest]) widest = a;
    }
    // The least distance of the cubes from a plane, times the length of its normal.
    const auto gap = [&](const Vec3& normal, const Vec3& on, bool is_two_sided) {
      const double height = dot(normal, minus(middle, on));
      double reach = 0;
      for (std::size_t a = 0; a < 3; ++a) reach += std::abs(normal[a]) * half[a];
      return (is_two_sided ? std::abs(height) : height) - reach;
    };
    if (gap(shape.normal, shape.x[0], true) > 0) return;
    for (std::size_t n = 0; n < 3; ++n)
      if (gap(shape.outwards[n], shape.x[n], false) > 0) return;
    if (cubes.last[widest] - cubes.first[widest] == 1) {
      const auto [i, j, k] = cubes.first;
      entries_.push_back({i + lattice_.step(1) * j + lattice_.step(2) * k, shape.number});
      return;
    }
    Cubes lower = cubes, upper = cubes;
    lower.last[widest] = upper.first[widest] = (cubes.first[widest] + cubes.last[widest]) / 2;
    add(shape, lower);
    add(shape, upper);
  }

  const CornerLattice& lattice_;
  std::vector<Entry> entries_;  ///< by cube
};

/// The share of the link before it meets the triangle, if it may do so; else more than 1.
double share_before(const TriangleCorners& t, const Segment& link) {
  constexpr double no = 2, rounding = 1e-6;
  const Vec3 normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const double from_a = dot(normal, minus(link.a, t[0]));
  const double from_b = dot(normal, minus(link.b, t[0]));
  const double share = from_a / (from_a - from_b);
  if (!(share >= 0 && share <= 1)) return no;
  const Vec3 place = plus(link.a, scaled(share, minus(link.b, link.a)));
  const double least = -rounding * dot(normal, normal);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 side = minus(t[(i + 1) % 3], t[i]);
    if (dot(normal, cross(side, minus(place, t[i]))) < least) return no;
  }
  return share;
}

/// From the outer end, the first triangle is where the material begins, however many sheets follow.
double first_share(const TrianglesByCube& triangles, std::size_t cube, const Segment& way,
                   const TriangleSurface& surface) {
  // A corner may lie on a triangle: the way is extended by more than rounding.
  constexpr double more = 1e-9;
  const Vec3 beyond = scaled(more, minus(way.b, way.a));
  const Segment longer{minus(way.a, beyond), plus(way.b, beyond)};
  double first = 2;
  triangles.for_each(cube, [&](Index t) {
    const TriangleCorners corners = corners_of(surface, surface.triangles[t]);
    const double share = share_before(corners, longer);
    if (share < first && geometry_module().crosses(corners, longer)) first = share;
  });
  return first > 1 ? 0.5 : first * (1 + 2 * more) - more;
}

}  // namespace

Crossings::Crossings(const CornerLattice& lattice, const std::vector<Piece>& pieces,
                     const TriangleSurface& surface)
    : lattice_(lattice) {
  struct Edge {
    std::size_t key, cube;
  };
  std::vector<Edge> edges, spare;
  for (const Piece& piece : pieces)
    for (const PatternPoint point : cut_pattern(piece.corners).points)
      if (direction(point) != 0) edges.push_back({key_of(piece, point), piece.cube});
  radix_sort(edges, spare, [](const Edge& edge) { return edge.key; });
  const TrianglesByCube triangles(lattice, surface);
  const auto [nx, ny, nz] = lattice.corners.cells;
  for (const auto& [key, cube] : edges) {
    if (!keys_.empty() && keys_.back() == key) continue;
    const std::size_t low = key / 8;
    std::array<Index, 3> at{Index(low % nx), Index(low / nx % ny), Index(low / nx / ny)};
    Segment way{lattice.place_of_corner(at), {}};
    for (std::size_t a = 0; a < 3; ++a) at[a] += key >> a & 1;
    way.b = lattice.place_of_corner(at);
    const bool low_is_inside = lattice.inside[low] != 0;
    if (low_is_inside) std::swap(way.a, way.b);
    const double share =
        std::clamp(first_share(triangles, cube, way, surface), nearest, 1 - nearest);
    keys_.push_back(key);
    shares_.push_back(low_is_inside ? 1 - share : share);
  }
}

double Crossings::of(const Piece& piece, PatternPoint point) const {
  const auto at = std::ranges::lower_bound(keys_, key_of(piece, point));
  return shares_[static_cast<std::size_t>(at - keys_.begin())];
}

std::size_t Crossings::key_of(const Piece& piece, PatternPoint point) const {
  std::array<Index, 3> at = lattice_.place(piece.cube);
  for (std::size_t a = 0; a < 3; ++a) at[a] += low_corner(point) >> a & 1;
  return 8 * lattice_.corner(at) + direction(point);
}

}  // namespace suture
