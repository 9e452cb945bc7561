// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/import.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/base/safe_range.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/mesh_texts.hpp"
#include "kernel/topology/ordering.hpp"
#include "kernel/topology/rest_shape.hpp"

namespace suture {
namespace {

using namespace mesh_texts;

// ------------------------------------------------------------------ checks --

void check_not_empty(const Mesh& mesh) {
  if (!mesh.hexahedra.empty()) return;
  std::string text = prefix(mesh.source) + "has no hexahedra";
  if (!mesh.skipped_cells.empty())
    text += "; it contains " + listed(mesh.skipped_cells, [](const auto& cell) {
              return std::to_string(cell.second) + " cells of type " + cell.first;
            });
  throw InputError(text + ". Suture simulates hexahedra: export or generate a hexahedral mesh");
}

/// Throws if a point that is used is not finite or too far away to compute with, or if the mesh is
/// too small for that.
void check_coordinates(const Mesh& mesh, const std::vector<bool>& used, const UserNames& names) {
  std::vector<Index> not_finite, too_far;
  Box box = no_box;
  for (Index p = 0; p < mesh.points.size(); ++p) {
    const Vec3& x = mesh.points[p];
    if (!used[p]) continue;
    include(box, x);
    if (is_safe_point(x) && is_safe_point(mesh.origin)) continue;
    (std::isfinite(x[0] + x[1] + x[2]) ? too_far : not_finite).push_back(p);
  }
  const auto refuse = [&](const std::vector<Index>& points, const char* what) {
    if (!points.empty())
      throw InputError(prefix(mesh.source) + "has " + counted(points.size(), "point", "points") +
                       " with a coordinate that is " + what + ": " +
                       listed(points, [&](Index p) { return names.point(p); }));
  };
  refuse(not_finite, "not finite");
  refuse(too_far, "larger than 1e30 m; check the file and /mesh/scale");
  if (std::max({box.length(0), box.length(1), box.length(2)}) < shortest_length)
    throw InputError(prefix(mesh.source) +
                     "is smaller than 1e-30 m in all directions; check the file and /mesh/scale");
}

/// The points that elements name; throws if one does not exist or cannot be computed with.
std::vector<bool> check_points(const Mesh& mesh, const UserNames& names) {
  const auto count = static_cast<Index>(mesh.points.size());
  std::vector<bool> used(count, false);
  std::vector<MapFault> faults;
  for (Index e = 0; e < mesh.hexahedra.size(); ++e)
    for (const Index v : mesh.hexahedra[e]) {
      if (v >= count) {
        faults.push_back(
            {MapFault::Kind::index_out_of_range, {e, none, none}, {v, none, none, none}});
        break;
      }
      used[v] = true;
    }
  if (!faults.empty())
    throw TopologyError(prefix(mesh.source) + "has " + counted(count, "point", "points") +
                        ", numbered from 0, and " +
                        describe(faults, {.element = [&](Index e) { return names.element(e); }}));
  check_coordinates(mesh, used, names);
  return used;
}

// --------------------------------------------------------------- numbering --

/// Loops over the full elements, and over the others, then run through blocks without gaps.
void put_parts_last(const Parts& parts, std::vector<Index>& order) {
  if (parts.empty()) return;
  std::vector<bool> is_partial(order.size(), false);
  for (const Index e : parts.elements)
    if (e < order.size()) is_partial[e] = true;
  std::stable_partition(order.begin(), order.end(), [&](Index e) { return !is_partial[e]; });
}

/// Fills the maps between the numbers of the mesh and those of the complex, and the
/// rest positions; returns the elements in their new order, over new vertices.
std::vector<Hexahedron> number(const Mesh& mesh, const std::vector<bool>& used, bool renumber,
                               Imported& out) {
  const auto elements = static_cast<Index>(mesh.hexahedra.size());
  const auto points = static_cast<Index>(mesh.points.size());
  if (renumber) {
    std::vector<Index> order = local_order(mesh.hexahedra, mesh.points, used);
    put_parts_last(mesh.parts, order);
    out.user_element = Renumbering(std::move(order));
    out.element_of = out.user_element.inverse();
  }

  out.vertex_of_point.assign(points, none);
  const auto add_vertex = [&](Index point) {
    out.vertex_of_point[point] = static_cast<Index>(out.user_vertex.size());
    out.user_vertex.push_back(point);
    out.rest.push_back(mesh.points[point]);
  };
  out.user_vertex.reserve(points);
  out.rest.reserve(points);
  for (Index p = 0; p < points && !renumber; ++p)
    if (used[p]) add_vertex(p);
  // Elements and points far apart in memory, in an order that is known ahead: fetching
  // them early takes a fifth off the import of a mesh in random order.
  constexpr Index ahead = 16;
  const auto old_element = [&](Index e) -> const Hexahedron& {
    return mesh.hexahedra[out.user_element[std::min(e, elements - 1)]];
  };
  std::vector<Hexahedron> hexahedra(elements);
  for (Index e = 0; e < elements; ++e) {
    __builtin_prefetch(&old_element(e + 2 * ahead));
    for (const Index point : old_element(e + ahead)) {
      __builtin_prefetch(&out.vertex_of_point[point]);
      __builtin_prefetch(&mesh.points[point]);
    }
    for (int i = 0; i < 8; ++i) {
      const Index point = old_element(e)[i];
      if (out.vertex_of_point[point] == none) add_vertex(point);
      hexahedra[e][i] = out.vertex_of_point[point];
    }
  }
  return hexahedra;
}

// ------------------------------------------------------------------- shape --

struct Shapes {
  std::vector<Index> flipped;   ///< were mirror images
  std::vector<Index> inverted;  ///< a corner Jacobian <= 0
  std::vector<Index> unusable;  ///< a Gauss point too
};

/// Turns mirrored elements round and finds the inverted ones.
Shapes orient(std::vector<Hexahedron>& hexahedra, const std::vector<Vec3>& rest) {
  Shapes shapes;
  for (Index e = 0; e < hexahedra.size(); ++e) {
    Corners x;
    for (int i = 0; i < 8; ++i) x[i] = rest[hexahedra[e][i]];
    const RestShape shape = rest_shape(x);
    if (shape.mirrored) {
      mirror(hexahedra[e]);
      shapes.flipped.push_back(e);
    }
    if (shape.inverted) shapes.inverted.push_back(e);
    if (shape.unusable) shapes.unusable.push_back(e);
  }
  return shapes;
}

// ------------------------------------------------------------ non-manifold --

/// Pairs of points with several edges of the complex between them, each of them on
/// the boundary. The elements around a boundary edge form a path, on whose ends it is
/// a side of a boundary face, once from a to b and once from b to a: so each such edge
/// appears once among the sides with a < b.
std::vector<std::array<Index, 2>> non_manifold_edges(const CellComplex& complex,
                                                     const std::vector<Index>& user_vertex) {
  struct Side {
    Index a, b;
  };
  std::vector<Side> sides, spare;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (int f = 0; f < 6; ++f) {
      if (complex.neighbour(e, f) != none) continue;
      for (Dart d = 24 * e + 4 * f; d < 24 * e + 4 * f + 4; ++d) {
        const Side side{user_vertex[complex.origin(d)],
                        user_vertex[complex.origin(CellComplex::beta1(d))]};
        if (side.a < side.b) sides.push_back(side);
      }
    }
  radix_sort(sides, spare, [](const Side& s) { return s.a; });
  std::vector<std::array<Index, 2>> result;
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last =
        std::find_if(first, sides.end(), [&](const Side& s) { return s.a != first->a; });
    std::sort(first, last, [](const Side& s, const Side& t) { return s.b < t.b; });
    for (auto it = first; it + 1 < last; ++it)
      if (it[0].b == it[1].b && (it == first || it[-1].b != it[0].b))
        result.push_back({it->a, it->b});
    first = last;
  }
  return result;
}

/// Gives the vertices that the complex split their points; refuses or warns.
void report_non_manifold(const std::vector<Split>& splits, const std::string& where,
                         const UserNames& names, ImportOptions::NonManifold option, bool has_parts,
                         Imported& out, Diagnostics& diagnostics) {
  std::vector<Index> points;
  for (const Split& split : splits) {
    const Index point = out.user_vertex[split.old_cell];
    out.user_vertex.push_back(point);
    out.rest.push_back(out.rest[split.old_cell]);
    out.split_points.emplace_back(point, split.new_cell);
    points.push_back(point);
  }
  std::ranges::sort(out.split_points);
  sort_unique(points);
  // Two parts in one cube may share two nodes, and not the edge: the material does not meet there.
  std::vector<std::array<Index, 2>> edges;
  if (!has_parts) edges = non_manifold_edges(out.complex, out.user_vertex);
  if (points.empty() && edges.empty()) return;

  const std::string what = counted(points.size(), "vertex", "vertices") + " and " +
                           counted(edges.size(), "edge", "edges");
  if (option == ImportOptions::NonManifold::split) {
    diagnostics.warn(where + "is non-manifold at " + what +
                     " (elements meet there without a common face); these were split");
    return;
  }
  std::string text =
      where + "is non-manifold at " + what + " (elements meet there without a common face)";
  if (!points.empty())
    text += "\n  points " + listed(points, [&](Index p) { return names.point(p); });
  if (!edges.empty())
    text += "\n  edges " + listed(edges, [&](const std::array<Index, 2>& e) {
              return names.point(e[0]) + "-" + names.point(e[1]);
            });
  throw TopologyError(text + "\n  set \"pinched\": \"split\" in /mesh to separate them");
}

void report_inverted(const Shapes& shapes, const std::string& where, const Naming& naming,
                     bool allowed, Diagnostics& diagnostics) {
  if (shapes.inverted.empty()) return;
  const std::vector<Index>& refused = allowed ? shapes.unusable : shapes.inverted;
  if (refused.empty()) {
    diagnostics.warn(where + "has " + counted(shapes.inverted.size(), "element", "elements") +
                     " with a corner Jacobian <= 0, accepted because of \"allow_inverted_rest\" "
                     "(positive at their Gauss points): " +
                     listed(shapes.inverted, naming.element, 20));
    return;
  }
  const std::size_t admissible = shapes.inverted.size() - shapes.unusable.size();
  std::string text = where + "has " + counted(refused.size(), "element", "elements") +
                     (allowed ? " with a Jacobian <= 0 at a corner and at a Gauss point: "
                              : " with a corner Jacobian <= 0 at rest: ") +
                     listed(refused, naming.element) + ". ";
  if (!allowed && admissible > 0)
    text += "\"allow_inverted_rest\": true accepts " +
            (admissible == refused.size() ? std::string("them") : std::to_string(admissible)) +
            " (positive at all quadrature points). ";
  if (allowed || admissible < refused.size())
    text += "Repair the mesh where " +
            std::string(allowed ? "these are" : "quadrature points are not positive") + ". ";
  throw TopologyError(text + "\"bad_elements\": \"drop\" in /mesh leaves out " +
                      (refused.size() == 1 ? "this element" : "these elements"));
}

}  // namespace

Renumbering::Renumbering(std::vector<Index> of) {
  Index next = 0;
  if (!std::ranges::all_of(of, [&](Index number) { return number == next++; })) of_ = std::move(of);
}

void Renumbering::append(Index count, std::span<const Index> extra) {
  if (of_.empty()) {
    of_.resize(count);
    std::iota(of_.begin(), of_.end(), Index{0});
  }
  of_.insert(of_.end(), extra.begin(), extra.end());
}

Renumbering Renumbering::inverse() const {
  std::vector<Index> inverse(of_.size());
  for (Index i = 0; i < of_.size(); ++i) inverse[of_[i]] = i;
  return Renumbering(std::move(inverse));
}

std::vector<Index> Imported::vertices_of_point(Index point) const {
  std::vector<Index> result;
  if (point >= vertex_of_point.size() || vertex_of_point[point] == none) return result;
  result.push_back(vertex_of_point[point]);
  for (auto it = std::ranges::lower_bound(split_points, std::pair{point, Index{0}});
       it != split_points.end() && it->first == point; ++it)
    result.push_back(it->second);
  return result;
}

Imported import_mesh(Mesh mesh, const ImportOptions& options, Diagnostics& diagnostics) {
  check_not_empty(mesh);
  const UserNames names{std::move(mesh.point_ids), std::move(mesh.element_ids)};
  const std::string where = prefix(mesh.source);
  const std::vector<bool> used = check_points(mesh, names);

  Imported out;
  std::vector<Hexahedron> hexahedra = number(mesh, used, options.renumber, out);
  const std::size_t unused = mesh.points.size() - out.rest.size();
  const Parts parts = std::move(mesh.parts);
  mesh = {};  // gives its memory back before the map is built

  const Naming naming{[&](Index e) { return names.element(out.user_element[e]); },
                      [&](Index v) { return names.point(out.user_vertex[v]); }};
  const Shapes shapes = orient(hexahedra, out.rest);
  out.parts = number_parts(
      parts, static_cast<Index>(hexahedra.size()), [&](Index e) { return out.element_of[e]; },
      [&](Index e) { return names.element(e); });
  for (const Index e : shapes.flipped) out.parts.mirror(e);
  std::vector<Split> splits;
  try {
    out.complex =
        CellComplex(std::move(hexahedra), static_cast<Index>(out.rest.size()), &splits, naming);
  } catch (const TopologyError& error) {
    throw TopologyError(where + "is not a conforming hexahedral mesh. It has\n" + error.what());
  }
  report_inverted(shapes, where, naming, options.allow_inverted_rest, diagnostics);
  report_non_manifold(splits, where, names, options.non_manifold, !parts.empty(), out, diagnostics);
  if (unused > 0)
    diagnostics.warn(where + "has " + counted(unused, "point", "points") +
                     " not used by any hexahedron; dropped");
  if (!shapes.flipped.empty())
    diagnostics.warn(where + "has " + counted(shapes.flipped.size(), "element", "elements") +
                     " with mirrored node numbering; reordered (" +
                     listed(shapes.flipped, naming.element, 20) + ")");
  return out;
}

}  // namespace suture
