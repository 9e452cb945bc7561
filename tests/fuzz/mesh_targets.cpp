// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdlib>

#include "kernel/mesh/mesh_file.hpp"
#include "kernel/topology/import.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace suture::fuzz {
namespace {

void require_in_range(const std::map<std::string, std::vector<Index>>& sets, std::size_t count) {
  for (const auto& [name, members] : sets)
    for (const Index member : members) require(member < count);
}

void read(const std::string& name, std::string_view bytes) {
  answered([&] {
    Diagnostics diagnostics;
    Mesh mesh = read_mesh(input_file(name, bytes), 1, diagnostics);
    for (const Vec3& x : mesh.points)
      for (const double c : x) require(std::isfinite(c));
    for (const Hexahedron& nodes : mesh.hexahedra)
      for (const Index node : nodes) require(node < mesh.points.size());
    require_in_range(mesh.point_sets, mesh.points.size());
    require_in_range(mesh.element_sets, mesh.hexahedra.size());
    import_mesh(std::move(mesh), {}, diagnostics);
  });
}

}  // namespace

void vtk(std::string_view bytes) { read("m.vtk", bytes); }
void vtu(std::string_view bytes) { read("m.vtu", bytes); }
void msh(std::string_view bytes) { read("m.msh", bytes); }
void medit(std::string_view bytes) { read("m.mesh", bytes); }

}  // namespace suture::fuzz
