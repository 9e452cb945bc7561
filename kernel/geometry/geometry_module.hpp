// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/geometry/surface.hpp"

// CGAL behind a small interface of plain data. Its headers take a minute to compile
// and its objects 3 MB: both stay in libsuture-geometry.so, which is loaded when a
// scene has a blade or an obstacle of triangles or a surface is filled with cubes.

namespace suture {

enum class SurfaceFormat { obj, off, ply, stl };

/// A closed chain of edges with a face on one side only.
struct Hole {
  std::size_t edges = 0;
  double length = 0;  ///< m, of its edges
  Vec3 middle{};      ///< m, mean of its points
};

/// A polygon that cannot be divided into triangles, because it folds back onto itself.
struct FoldedFace {
  std::size_t corners = 0;  ///< 0: there is no such polygon
  Vec3 middle{};            ///< m, mean of its corners
};

/// What was found and repaired while closing a surface.
struct Closing {
  std::size_t triangles = 0, components = 0;
  double volume = 0;              ///< m^3, if closed
  std::size_t border_edges = 0;   ///< edges with a face on one side only
  std::vector<Hole> holes;        ///< most edges first; with repair, those that stay open
  std::size_t holes_filled = 0;   ///< only with repair
  std::size_t crossings = 0;      ///< pairs of intersecting triangles
  std::size_t faces_dropped = 0;  ///< degenerate or duplicate, and walls between two solids
  FoldedFace folded;              ///< with one, nothing else is known of the surface
  TriangleSurface surface;        ///< oriented outward; empty if not closed
};

/// Cubes in rows along x, then y, then z.
struct CubeGrid {
  Vec3 origin{};  ///< the corner with the smallest coordinates, m
  double edge = 0;
  std::array<Index, 3> cells{};
  std::size_t size() const { return std::size_t{cells[0]} * cells[1] * cells[2]; }
};

/// The two ends of a link.
struct Segment {
  Vec3 a, b;
};

/// Triangles in an AABB tree. Queries may be made from several threads at once.
class TriangleTree {
 public:
  virtual ~TriangleTree() = default;
  /// crossed[i] = whether link i crosses a triangle: crosses() of blade.hpp.
  virtual void crossings(std::span<const Segment> links, std::uint8_t* crossed) const = 0;
};

class GeometryModule {
 public:
  virtual ~GeometryModule() = default;
  virtual std::string write(SurfaceFormat format, const TriangleSurface& surface) const = 0;
  /// Merges equal points, orients, triangulates; with `repair`, fills holes. Where two closed
  /// shells share a face, both copies of the face are dropped, so that the shells bound one body.
  virtual Closing close(const PolygonSoup& soup, bool repair) const = 0;
  /// For each cube, whether its centre lies inside (its winding number is not 0).
  virtual std::vector<std::uint8_t> fill(const TriangleSurface& surface,
                                         const CubeGrid& grid) const = 0;
  virtual std::unique_ptr<TriangleTree> tree(const TriangleSurface& surface) const = 0;
  /// crosses() of blade.hpp for one triangle.
  virtual bool crosses(const std::array<Vec3, 3>& triangle, const Segment& link) const = 0;
};

/// The module, loaded at the first call. Throws IoError if it cannot be loaded.
const GeometryModule& geometry_module();

}  // namespace suture
