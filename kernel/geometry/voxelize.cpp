// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/voxelize.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/geometry/geometry_module.hpp"
#include "kernel/mesh/file_text.hpp"
#include "kernel/topology/import.hpp"

namespace suture {
namespace {

std::string number_text(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

std::string size_text(const Box& box) {
  return number_text(box.high[0] - box.low[0]) + " x " + number_text(box.high[1] - box.low[1]) +
         " x " + number_text(box.high[2] - box.low[2]) + " m";
}

// Links name 2^26 elements (topology/incidence.hpp); a lattice has more, outside.
constexpr double max_cells = 67e6, max_lattice = 4e9;
// A lattice of 10,000 cubes for each that is wanted: a wire across its box is 200 times as long
// as thick. What is further away is a stray point, or a surface around next to nothing.
constexpr double max_outside = 1e4, always_allowed = 1e6;

/// The cubes of a lattice that are inside.
struct Filling {
  CubeGrid grid;
  std::vector<std::uint8_t> inside;
  std::size_t count = 0;
};

/// V = 1/6 sum over triangles of p . (q x r), by the divergence theorem; points are
/// taken from the first one, against cancellation.
double volume_of(const TriangleSurface& surface) {
  double six = 0;
  const Vec3& o = surface.points[0];
  for (const Triangle& t : surface.triangles) {
    Vec3 x[3];
    for (int n = 0; n < 3; ++n)
      for (int a = 0; a < 3; ++a) x[n][a] = surface.points[t[n]][a] - o[a];
    six += x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) +
           x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
           x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
  }
  return std::abs(six) / 6;
}

/// A layer that the body would fill by less than a thousandth of an edge is left out: where the
/// edge divides the length, rounding would add one, and move the others by half an edge.
double layers(const Box& box, int axis, double edge) {
  return std::max(1.0, std::ceil((box.high[axis] - box.low[axis]) / edge - 1e-3));
}

CubeGrid grid_around(const Box& box, double edge, const std::string& source) {
  CubeGrid grid{.edge = edge};
  double lattice = 1;
  for (int a = 0; a < 3; ++a) {
    const double cells = layers(box, a, edge);
    lattice *= cells;
    if (!(lattice <= max_lattice))
      throw InputError(source + ": cubes of " + number_text(edge) +
                       " m are too small for a body of this size: the lattice around it would have "
                       "more than 4,000,000,000 cubes; use fewer cells or a longer edge");
    grid.cells[a] = static_cast<Index>(cells);
    grid.origin[a] = (box.low[a] + box.high[a]) / 2 - cells * edge / 2;
  }
  return grid;
}

int longest_axis(const Box& box) {
  int longest = 0;
  for (const int a : {1, 2})
    if (box.high[a] - box.low[a] > box.high[longest] - box.low[longest]) longest = a;
  return longest;
}

void require_compact(const TriangleSurface& surface, const Box& box, double edge, double wanted) {
  double lattice = 1;
  for (int a = 0; a < 3; ++a) lattice *= layers(box, a, edge);
  if (lattice <= std::max(always_allowed, max_outside * wanted)) return;
  const int a = longest_axis(box);
  throw InputError(surface.source + ": the surface encloses only " +
                   number_text(volume_of(surface)) + " m^3 in a box of " + size_text(box) + ": " +
                   number_text(wanted) + " cubes inside would need a lattice of " +
                   number_text(lattice) + "; it extends from " + number_text(box.low[a]) + " to " +
                   number_text(box.high[a]) + " m along " + "xyz"[a] +
                   "; check for stray points, or give --edge to use the surface as it is");
}

Filling fill(const TriangleSurface& surface, const Box& box, double edge) {
  Filling result{grid_around(box, edge, surface.source), {}, 0};
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

/// n(edge) is about volume / edge^3, with jumps where the lattice gets a layer more: steps
/// after that law, halved between the edges known to give too many and too few.
Filling fill_with_cells(const TriangleSurface& surface, const Box& box,
                        const VoxelizeOptions& options, Diagnostics& diagnostics) {
  const double wanted = double(options.cells);
  if (wanted > max_cells)
    throw InputError(surface.source + ": " + grouped(options.cells) +
                     " cells exceed the 67,000,000 that the map can number");
  double edge = std::cbrt(volume_of(surface) / wanted);
  if (!(edge > 0)) throw InputError(surface.source + ": the surface encloses no volume");
  const auto error = [&](const Filling& f) { return std::abs(double(f.count) - wanted) / wanted; };
  double short_edge = 0, long_edge = std::numeric_limits<double>::infinity();
  Filling best;
  for (int round = 0; round < 16; ++round) {
    require_compact(surface, box, edge, wanted);
    Filling now = fill_with(surface, box, edge, options);
    (double(now.count) > wanted ? short_edge : long_edge) = edge;
    edge *= std::cbrt(std::max(1.0, double(now.count)) / wanted);
    if (!(edge > short_edge && edge < long_edge)) edge = (short_edge + long_edge) / 2;
    if (round == 0 || error(now) < error(best)) best = std::move(now);
    if (error(best) <= 0.01) return best;
  }
  if (best.count != 0)
    diagnostics.warn(surface.source + ": " + grouped(best.count) + " cells instead of " +
                     grouped(options.cells) + ": no other cube size came closer");
  return best;
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
  const bool by_edge = options.edge != 0;
  if (by_edge == (options.cells != 0) ||
      (by_edge && !(options.edge > 0 && std::isfinite(options.edge))))
    throw InputError(
        surface.source +
        ": give either the number of cells or the edge of the cubes, as a positive number");
  if (surface.triangles.empty()) throw InputError(surface.source + ": the surface is empty");
  const Box box = box_of(surface.points);
  const Filling filling = by_edge ? fill_with(surface, box, options.edge, options)
                                  : fill_with_cells(surface, box, options, diagnostics);
  if (filling.count == 0)
    throw InputError(surface.source + ": no cube of edge " + number_text(filling.grid.edge) +
                     " m has its centre inside the body of " + size_text(box) +
                     "; use more cells or a shorter edge");
  if (double(filling.count) > max_cells)
    throw InputError(surface.source + ": " + grouped(filling.count) +
                     " cubes exceed the 67,000,000 that the map can number");
  if (!options.largest_island) warn_if_coarse(filling, surface, box, diagnostics);
  Mesh mesh = mesh_of(filling);
  mesh.source = surface.source;
  split_non_manifold(mesh, diagnostics);
  return mesh;
}

}  // namespace suture
