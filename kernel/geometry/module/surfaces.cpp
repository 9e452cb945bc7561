// SPDX-License-Identifier: GPL-3.0-or-later
//
// Surfaces from files, made closed: CGAL's polygon mesh processing.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/exceptions.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>

#include "kernel/geometry/module/parts.hpp"
#include "kernel/geometry/sound_soup.hpp"
#include "kernel/geometry/surface_tree.hpp"

namespace suture::cgal {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
namespace processing = CGAL::Polygon_mesh_processing;
using Points = std::vector<Point>;
using Polygons = std::vector<std::vector<std::size_t>>;

void from_soup(const PolygonSoup& soup, Points& points, Polygons& polygons) {
  points.reserve(soup.points.size());
  for (const Vec3& p : soup.points) points.emplace_back(p[0], p[1], p[2]);
  polygons.reserve(soup.size());
  for (std::size_t i = 0; i < soup.size(); ++i)
    if (soup.offsets[i + 1] - soup.offsets[i] >= 3)
      polygons.emplace_back(soup.corners.begin() + soup.offsets[i],
                            soup.corners.begin() + soup.offsets[i + 1]);
}

TriangleSurface to_surface(const SurfaceMesh& mesh) {
  TriangleSurface surface;
  std::vector<Index> number(mesh.number_of_vertices() + mesh.number_of_removed_vertices(), none);
  for (const auto v : mesh.vertices()) {
    number[v] = static_cast<Index>(surface.points.size());
    const Point& p = mesh.point(v);
    surface.points.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : mesh.faces()) {
    Triangle corners{};
    std::size_t n = 0;
    for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh))
      corners[n++] = number[v];
    surface.triangles.push_back(corners);
  }
  return surface;
}

std::size_t border_edges(const SurfaceMesh& mesh) {
  std::size_t count = 0;
  for (const auto h : mesh.halfedges()) count += mesh.is_border(h) ? 1 : 0;
  return count;
}

std::vector<SurfaceMesh::Halfedge_index> borders_of(const SurfaceMesh& mesh) {
  std::vector<SurfaceMesh::Halfedge_index> borders;
  processing::extract_boundary_cycles(mesh, std::back_inserter(borders));
  return borders;
}

Hole hole_along(SurfaceMesh::Halfedge_index border, const SurfaceMesh& mesh) {
  Hole hole;
  for (const auto h : CGAL::halfedges_around_face(border, mesh)) {
    const Point& p = mesh.point(mesh.source(h));
    hole.length += std::sqrt(CGAL::squared_distance(p, mesh.point(mesh.target(h))));
    ++hole.edges;
    for (int a = 0; a < 3; ++a) hole.middle[a] += p[a];
  }
  for (double& x : hole.middle) x /= static_cast<double>(hole.edges);
  return hole;
}

std::vector<Hole> holes_of(const SurfaceMesh& mesh) {
  std::vector<Hole> holes;
  for (const auto border : borders_of(mesh)) holes.push_back(hole_along(border, mesh));
  std::ranges::stable_sort(holes, std::greater{}, &Hole::edges);
  return holes;
}

std::size_t count_components(SurfaceMesh& mesh) {
  auto component = mesh.add_property_map<SurfaceMesh::Face_index, std::size_t>("f:component").first;
  const std::size_t count = processing::connected_components(mesh, component);
  mesh.remove_property_map(component);
  return count;
}

// Returns the number of holes that got a lid.
std::size_t fill_holes(SurfaceMesh& mesh) {
  std::size_t filled = 0;
  for (const auto border : borders_of(mesh)) {
    std::vector<SurfaceMesh::Face_index> lid;
    processing::triangulate_hole(mesh, border, std::back_inserter(lid));
    filled += lid.empty() ? 0 : 1;
  }
  return filled;
}

/// `surface`: that of the mesh.
std::size_t count_crossings(const SurfaceMesh& mesh, const TriangleSurface& surface) {
  const std::vector<Index> doubtful = find_doubtful(surface, SurfaceTree(surface));
  if (doubtful.empty()) return 0;
  const std::vector<SurfaceMesh::Face_index> all(mesh.faces().begin(), mesh.faces().end());
  std::vector<SurfaceMesh::Face_index> faces;
  for (const Index i : doubtful) faces.push_back(all[i]);
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> pairs;
  processing::self_intersections(faces, mesh, std::back_inserter(pairs));
  return pairs.size();
}

}  // namespace

std::string write(SurfaceFormat format, const TriangleSurface& surface) {
  Points points;
  for (const Vec3& p : surface.points) points.emplace_back(p[0], p[1], p[2]);
  const auto exact = CGAL::parameters::stream_precision(17);
  std::ostringstream out;
  if (format == SurfaceFormat::stl || format == SurfaceFormat::ply) CGAL::IO::set_binary_mode(out);
  switch (format) {
    case SurfaceFormat::obj:
      CGAL::IO::write_OBJ(out, points, surface.triangles, exact);
      break;
    case SurfaceFormat::off:
      CGAL::IO::write_OFF(out, points, surface.triangles, exact);
      break;
    case SurfaceFormat::ply:
      CGAL::IO::write_PLY(out, points, surface.triangles, exact);
      break;
    case SurfaceFormat::stl:
      CGAL::IO::write_STL(out, points, surface.triangles, exact);
      break;
  }
  return std::move(out).str();
}

namespace {

/// Whether the projection of a polygon onto the coordinate plane that it faces most is simple.
bool is_simple(const std::vector<Point>& corners) {
  std::array<double, 3> normal{};  // Newell: twice the areas of the three projections
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point &p = corners[i], &q = corners[(i + 1) % corners.size()];
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      normal[a] += (p[b] - q[b]) * (p[c] + q[c]);
    }
  }
  const auto size = [&](int a) { return std::abs(normal[a]); };
  const int away = size(0) > size(1) ? (size(0) > size(2) ? 0 : 2) : (size(1) > size(2) ? 1 : 2);
  std::vector<Kernel::Point_2> flat;
  for (const Point& p : corners) flat.emplace_back(p[(away + 1) % 3], p[(away + 2) % 3]);
  return CGAL::is_simple_2(flat.begin(), flat.end(), Kernel());
}

/// Divides all faces into triangles, up to a face that folds back onto itself. CGAL would leave a
/// mesh with such a face in a state in which walks along its borders never end.
FoldedFace triangulate(SurfaceMesh& mesh) {
  const std::vector<SurfaceMesh::Face_index> all(mesh.faces().begin(), mesh.faces().end());
  for (const auto face : all) {
    std::vector<Point> corners;
    for (const auto v : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      corners.push_back(mesh.point(v));
    if (corners.size() <= 3 || (is_simple(corners) && processing::triangulate_face(face, mesh)))
      continue;
    FoldedFace folded{corners.size(), {}};
    for (const Point& p : corners)
      for (int a = 0; a < 3; ++a) folded.middle[a] += p[a] / static_cast<double>(corners.size());
    return folded;
  }
  return {};
}

/// The faces of a soup that are kept where some are there twice.
enum class Doubles { first, none };

/// The faces of the soup as a mesh, oriented as far as they can be. The mesh is empty if no face
/// has an area.
SurfaceMesh mesh_of(const PolygonSoup& soup, Doubles doubles, Closing& result) {
  Points points;
  Polygons polygons;
  from_soup(soup, points, polygons);
  if (!is_sound(soup)) {
    processing::repair_polygon_soup(
        points, polygons, CGAL::parameters::erase_all_duplicates(doubles == Doubles::none));
    processing::orient_polygon_soup(points, polygons);
  }
  result.faces_dropped = soup.size() - std::min(soup.size(), polygons.size());
  SurfaceMesh mesh;
  processing::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  result.folded = triangulate(mesh);
  return mesh;
}

bool is_closed(const SurfaceMesh& mesh) {
  return mesh.number_of_faces() != 0 && border_edges(mesh) == 0;
}

}  // namespace

Closing close(const PolygonSoup& soup, bool repair) {
  Closing result;
  SurfaceMesh mesh = mesh_of(soup, Doubles::first, result);
  if (result.folded.corners == 0 && result.faces_dropped != 0 && !is_closed(mesh)) {
    Closing other;
    SurfaceMesh without_doubles = mesh_of(soup, Doubles::none, other);
    if (other.folded.corners == 0 && is_closed(without_doubles)) {
      result = std::move(other);
      mesh = std::move(without_doubles);
    }
  }
  if (result.folded.corners != 0 || mesh.number_of_faces() == 0) return result;
  result.triangles = mesh.number_of_faces();
  result.components = count_components(mesh);
  result.border_edges = border_edges(mesh);
  if (result.border_edges != 0) {
    if (repair) result.holes_filled = fill_holes(mesh);
    result.holes = holes_of(mesh);
    if (!result.holes.empty()) return result;
  }
  result.crossings = count_crossings(mesh, to_surface(mesh));
  if (result.crossings != 0 && !repair) return result;
  try {
    if (result.crossings == 0)
      processing::orient_to_bound_a_volume(mesh);
    else
      processing::orient(mesh);
  } catch (const CGAL::Failure_exception&) {  // flat: no side of it is the inner one
    result.border_edges = 0;
    return result;
  }
  result.volume = processing::volume(mesh);
  result.surface = to_surface(mesh);
  result.surface.source = soup.source;
  return result;
}

}  // namespace suture::cgal
