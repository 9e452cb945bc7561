// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/voxelize.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/geometry/cube_size.hpp"
#include "kernel/geometry/geometry_module.hpp"
#include "kernel/topology/import.hpp"

namespace suture {
namespace {

/// The cubes of a lattice that are inside.
struct Filling {
  CubeGrid grid;
  std::vector<std::uint8_t> inside;
  std::size_t count = 0;
};

/// A layer that the body would fill by less than a thousandth of an edge is left out: where the
/// edge divides the length, rounding would add one, and move the others by half an edge.
Vec3 layers(const Box& box, double edge) {
  Vec3 cells;
  for (std::size_t a = 0; a < 3; ++a)
    cells[a] = std::max(1.0, std::ceil(box.length(a) / edge - 1e-3));
  return cells;
}

Filling fill(const TriangleSurface& surface, const Box& box, double edge) {
  Filling result{grid_around(box, edge, layers(box, edge), surface.source), {}, 0};
  result.inside = geometry_module().fill(surface, result.grid);
  result.count = result.inside.size() - std::ranges::count(result.inside, 0);
  return result;
}

/// Cubes that are connected by faces, found by flooding; the largest such set stays,
/// the first of several.
void keep_largest_island(Filling& filling) {
  const auto [nx, ny, nz] = filling.grid.cells;
  const std::size_t steps[3] = {1, nx, std::size_t{nx} * ny};
  const Index cells[3] = {nx, ny, nz};
  std::vector<std::uint8_t>& inside = filling.inside;
  std::vector<std::size_t> island, largest;
  for (std::size_t start = 0; start < inside.size(); ++start) {
    if (inside[start] != 1) continue;
    island.assign(1, start);
    inside[start] = 2;
    for (std::size_t at = 0; at < island.size(); ++at) {
      const std::size_t cube = island[at];
      for (int a = 0; a < 3; ++a) {
        const std::size_t along = cube / steps[a] % cells[a];
        for (const int way : {-1, 1}) {
          if (way < 0 ? along == 0 : along + 1 == cells[a]) continue;
          const std::size_t next = way < 0 ? cube - steps[a] : cube + steps[a];
          if (inside[next] != 1) continue;
          inside[next] = 2;
          island.push_back(next);
        }
      }
    }
    if (island.size() > largest.size()) largest.swap(island);
  }
  std::ranges::fill(inside, 0);
  for (const std::size_t cube : largest) inside[cube] = 1;
  filling.count = largest.size();
}

Filling fill_with(const TriangleSurface& surface, const Box& box, double edge,
                  const VoxelizeOptions& options) {
  Filling filling = fill(surface, box, edge);
  if (options.largest_island) keep_largest_island(filling);
  return filling;
}

Mesh mesh_of(const Filling& filling) {
  const auto [nx, ny, nz] = filling.grid.cells;
  Mesh mesh;
  mesh.hexahedra.reserve(filling.count);
  // Numbers of the corners of two layers: below and above the cubes of layer k.
  const std::size_t row = std::size_t{nx} + 1;
  std::vector<Index> layers[2];
  for (auto& layer : layers) layer.assign(row * (ny + 1), none);
  const std::uint8_t* inside = filling.inside.data();
  for (Index k = 0; k < nz; ++k) {
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        if (!*inside++) continue;
        Hexahedron nodes;
        for (Index n = 0; n < 8; ++n) {
          const Index at[3] = {i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1)};
          Index& number = layers[n >> 2 & 1][at[0] + row * at[1]];
          if (number == none) {
            number = static_cast<Index>(mesh.points.size());
            Vec3& point = mesh.points.emplace_back();
            for (int a = 0; a < 3; ++a)
              point[a] = filling.grid.origin[a] + filling.grid.edge * at[a];
          }
          nodes[n] = number;
        }
        mesh.hexahedra.push_back(nodes);
      }
    layers[0].swap(layers[1]);
    std::ranges::fill(layers[1], none);
  }
  return mesh;
}

/// Gives every part of a non-manifold vertex a separate point. The import finds these vertices.
void split_non_manifold(Mesh& mesh, Diagnostics& diagnostics) {
  const Imported imported = import_mesh(mesh, {.renumber = false}, diagnostics);
  std::vector<Index> point = imported.user_vertex;
  for (const auto& [old, vertex] : imported.split_points) {
    point[vertex] = static_cast<Index>(mesh.points.size());
    mesh.points.push_back(Vec3(mesh.points[old]));
  }
  for (Index e = 0; e < imported.complex.element_count(); ++e)
    for (int n = 0; n < hexahedron::vertices; ++n)
      mesh.hexahedra[imported.user_element[e]][n] = point[imported.complex.vertices_of(e)[n]];
}

void warn_if_coarse(const Filling& filling, const TriangleSurface& surface, const Box& box,
                    Diagnostics& diagnostics) {
  const double edge = filling.grid.edge, volume = volume_of(surface);
  const double cubes = double(filling.count) * edge * edge * edge;
  if (cubes <= 2 * volume && volume <= 2 * cubes) return;
  diagnostics.warn(surface.source + ": the cubes, of edge " + number_text(edge) + " m, have " +
                   number_text(cubes / volume) + " times the volume of the body of " +
                   size_text(box) + "; use more cells or a shorter edge to follow the surface");
}

}  // namespace

Mesh voxelize(const TriangleSurface& surface, const VoxelizeOptions& options,
              Diagnostics& diagnostics) {
  require_size(surface, options.cells, options.edge);
  const Box box = box_of(surface.points);
  const auto fill_now = [&](double edge) {
    if (options.cells != 0) require_compact(surface, box, layers(box, edge), double(options.cells));
    return fill_with(surface, box, edge, options);
  };
  const Filling filling = options.cells == 0
                              ? fill_now(options.edge)
                              : fill_with_cells(surface, options.cells, fill_now, diagnostics);
  if (filling.count == 0)
    throw InputError(surface.source + ": no cube of edge " + number_text(filling.grid.edge) +
                     " m has its centre inside the body of " + size_text(box) +
                     "; use more cells or a shorter edge");
  require_numbers(double(filling.count), surface.source + ": " + grouped(filling.count) + " cubes");
  if (!options.largest_island) warn_if_coarse(filling, surface, box, diagnostics);
  Mesh mesh = mesh_of(filling);
  mesh.source = surface.source;
  split_non_manifold(mesh, diagnostics);
  return mesh;
}

}  // namespace suture
