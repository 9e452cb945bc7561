// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/fill_surface.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/geometry/cube_size.hpp"
#include "kernel/parts/crossings.hpp"
#include "kernel/parts/moments.hpp"

namespace suture {
namespace {

struct CornerFilling : CornerLattice {
  std::size_t count = 0;  ///< of cubes with a corner inside
};

/// A face of the body in a plane of the lattice would be moved by Crossings::nearest.
Vec3 layers_around(const Box& box, double edge) {
  Vec3 cells;
  for (std::size_t a = 0; a < 3; ++a) cells[a] = std::ceil(box.length(a) / edge + 0.1);
  return cells;
}

std::size_t count_cubes(const Lattice& lattice, const std::vector<std::uint8_t>& inside) {
  const std::size_t row = lattice.cubes[0] + std::size_t{1};
  const std::size_t layer = row * (lattice.cubes[1] + std::size_t{1});
  std::size_t count = 0;
  for (Index k = 0; k < lattice.cubes[2]; ++k)
    for (Index j = 0; j < lattice.cubes[1]; ++j) {
      const std::uint8_t* at = inside.data() + lattice.corner({0, j, k});
      const auto pair = [&](Index i) {
        return at[i] | at[i + row] | at[i + layer] | at[i + layer + row];
      };
      for (Index i = 0; i < lattice.cubes[0]; ++i) count += (pair(i) | pair(i + 1)) != 0 ? 1 : 0;
    }
  return count;
}

CornerFilling fill_lattice(const TriangleSurface& surface, const Box& box, double edge) {
  CornerFilling filling;
  CubeGrid& corners = filling.corners;
  corners = grid_around(box, edge, layers_around(box, edge), surface.source);
  filling.cubes = corners.cells;
  for (std::size_t a = 0; a < 3; ++a) {
    corners.origin[a] -= edge / 2;
    ++corners.cells[a];
  }
  filling.inside = geometry_module().fill(surface, corners);
  filling.count = count_cubes(filling, filling.inside);
  return filling;
}

CornerFilling fill_lattice(const TriangleSurface& surface, const Box& box, const CubeSize& size,
                           Diagnostics& diagnostics) {
  require_size(surface, size.cells, size.edge);
  if (size.cells == 0) return fill_lattice(surface, box, size.edge);
  const auto fill_now = [&](double edge) {
    require_compact(surface, box, layers_around(box, edge), double(size.cells));
    return fill_lattice(surface, box, edge);
  };
  return fill_with_cells(surface, size.cells, fill_now, diagnostics);
}

/// Adds the material of one element.
void add_part(Index element, const Piece& piece, const Crossings& crossings, Parts& parts) {
  const CutPattern& pattern = cut_pattern(piece.corners);
  const auto first = static_cast<Index>(parts.points.size());
  for (const PatternPoint point : pattern.points) {
    const double share = direction(point) == 0 ? 0 : crossings.of(piece, point);
    parts.points.push_back({element, place_of(point, share)});
  }
  MomentSum sum;
  for (const auto& t : pattern.tetrahedra) {
    std::array<Index, 4>& corners = parts.tetrahedra.emplace_back();
    std::array<Vec3, 4> places;
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = first + t[i];
      places[i] = parts.points[corners[i]].at;
    }
    sum.add(places);
  }
  for (const auto& t : pattern.triangles)
    parts.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  parts.elements.push_back(element);
  parts.moments.push_back(sum.moments());
  parts.first.push_back(static_cast<Index>(parts.tetrahedra.size()));
}

Parts parts_of(const CornerFilling& filling, const std::vector<Piece>& pieces,
               const TriangleSurface& surface) {
  const Crossings crossings(filling, pieces, surface);
  Parts parts;
  parts.first.push_back(0);
  for (Index e = 0; e < pieces.size(); ++e)
    if (pieces[e].corners != all_corners) add_part(e, pieces[e], crossings, parts);
  return parts;
}

Mesh mesh_of_pieces(const CornerFilling& filling, const std::vector<Piece>& pieces) {
  Mesh mesh;
  mesh.hexahedra = nodes_of(filling, pieces);
  for (std::size_t e = 0; e < pieces.size(); ++e) {
    const std::array<Index, 3> at = filling.place(pieces[e].cube);
    for (Index n = 0; n < 8; ++n)
      if (mesh.hexahedra[e][n] == mesh.points.size())
        mesh.points.push_back(
            filling.place_of_corner({at[0] + (n & 1), at[1] + (n >> 1 & 1), at[2] + (n >> 2 & 1)}));
  }
  return mesh;
}

void warn_if_thin(const Mesh& mesh, double edge, const TriangleSurface& surface, const Box& box,
                  Diagnostics& diagnostics) {
  double cubes = double(mesh.hexahedra.size() - mesh.parts.elements.size());
  for (const PartMoments& moments : mesh.parts.moments) cubes += moments.fraction;
  const double wanted = volume_of(surface), found = cubes * edge * edge * edge;
  if (std::abs(found - wanted) <= 0.1 * wanted) return;
  diagnostics.warn(surface.source + ": cubes of edge " + number_text(edge) + " m see only " +
                   number_text(found / wanted) + " of the volume of the body of " + size_text(box) +
                   ", whose walls or gaps are thinner than that; use more cells or a shorter edge");
}

}  // namespace

Mesh fill_surface(const TriangleSurface& surface, const CubeSize& size, Diagnostics& diagnostics) {
  const Box box = box_of(surface.points);
  const CornerFilling filling = fill_lattice(surface, box, size, diagnostics);
  const double edge = filling.corners.edge;
  if (filling.count == 0)
    throw InputError(surface.source + ": no cube of edge " + number_text(edge) +
                     " m has a corner inside the body of " + size_text(box) +
                     "; use more cells or a shorter edge");
  std::vector<Piece> pieces = pieces_of(filling, filling.inside);
  require_numbers(double(pieces.size()),
                  surface.source + ": " + grouped(pieces.size()) + " elements");
  if (const std::size_t specks = drop_specks(filling, pieces); specks != 0)
    diagnostics.note(surface.source + ": " + grouped(specks) +
                     (specks == 1 ? " piece" : " pieces") +
                     " of the size of a cube or two, at sharp edges or thin walls, " +
                     (specks == 1 ? "was" : "were") + " left out");
  if (const std::size_t joined = join_pieces(filling, pieces); joined != 0)
    diagnostics.note(surface.source + ": " + grouped(joined) +
                     " elements were joined to others in the same cube, at the ends of gaps that "
                     "are narrower than a cube");
  Mesh mesh = mesh_of_pieces(filling, pieces);
  mesh.source = surface.source;
  mesh.parts = parts_of(filling, pieces, surface);
  warn_if_thin(mesh, edge, surface, box, diagnostics);
  return mesh;
}

}  // namespace suture
