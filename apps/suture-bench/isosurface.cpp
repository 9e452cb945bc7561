// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/isosurface.hpp"

#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/facets_in_complex_2_to_triangle_mesh.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Random.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_default_triangulation_3.h>
#include <CGAL/make_surface_mesh.h>

namespace suture::bench {
namespace {

/// Cells and vertices numbered as they are made: CGAL then orders its handles by number
/// and not by address, and the mesh is the same each time.
template <class Base>
class Numbered : public Base {
 public:
  using Base::Base;
  template <class Structure>
  struct Rebind_TDS {
    using Other = Numbered<typename Base::template Rebind_TDS<Structure>::Other>;
  };
  using Has_timestamp = CGAL::Tag_true;
  std::size_t time_stamp() const { return number_; }
  void set_time_stamp(std::size_t number) { number_ = number; }

 private:
  std::size_t number_ = std::size_t(-1);
};

// As CGAL's Surface_mesh_default_triangulation_3, numbered.
using MeshKernel =
    CGAL::Robust_circumcenter_traits_3<CGAL::Exact_predicates_inexact_constructions_kernel>;
using Vertex = CGAL::Surface_mesh_vertex_base_3<MeshKernel>;
using Cell = CGAL::Delaunay_triangulation_cell_base_with_circumcenter_3<
    MeshKernel, CGAL::Surface_mesh_cell_base_3<MeshKernel>>;
using Triangulation = CGAL::Delaunay_triangulation_3<
    MeshKernel, CGAL::Triangulation_data_structure_3<Numbered<Vertex>, Numbered<Cell>>>;
using Complex2 = CGAL::Complex_2_in_triangulation_3<Triangulation>;

TriangleSurface to_surface(const CGAL::Surface_mesh<MeshKernel::Point_3>& mesh) {
  TriangleSurface surface;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.points.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : mesh.faces()) {
    Triangle corners{};
    std::size_t n = 0;
    for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh)) corners[n++] = v;
    surface.triangles.push_back(corners);
  }
  return surface;
}

}  // namespace

TriangleSurface isosurface(const std::function<double(const Vec3&)>& value, const Vec3& centre,
                           double radius, double size) {
  CGAL::get_default_random() = CGAL::Random(1);  // the mesher's first points
  const auto function = [&](const MeshKernel::Point_3& p) { return value({p.x(), p.y(), p.z()}); };
  const CGAL::Implicit_surface_3<MeshKernel, decltype(function)> surface(
      function, MeshKernel::Sphere_3({centre[0], centre[1], centre[2]}, radius * radius), 1e-7);
  const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(30, size, size / 10);
  Triangulation triangulation;
  Complex2 complex(triangulation);
  CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Manifold_tag());
  CGAL::Surface_mesh<MeshKernel::Point_3> mesh;
  CGAL::facets_in_complex_2_to_triangle_mesh(complex, mesh);
  return to_surface(mesh);
}

}  // namespace suture::bench
