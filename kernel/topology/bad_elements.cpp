// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/bad_elements.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "kernel/base/error.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/disjoint_sets.hpp"
#include "kernel/topology/face_matching.hpp"
#include "kernel/topology/hexahedron_tables.hpp"
#include "kernel/topology/mesh_texts.hpp"
#include "kernel/topology/rest_shape.hpp"

namespace suture {
namespace {

using namespace mesh_texts;

/// Positions in the mesh, ascending.
struct BadElements {
  std::vector<Index> repeated;  ///< the same point twice
  std::vector<Index> inverted;
  std::vector<Index> inside_out;

  std::vector<Index> all() const {
    std::vector<Index> result = repeated;
    result.insert(result.end(), inverted.begin(), inverted.end());
    result.insert(result.end(), inside_out.begin(), inside_out.end());
    return result;
  }
};

/// The elements of good shape, with mirror images turned round.
struct Turned {
  std::vector<Hexahedron> hexahedra;
  std::vector<Index> place;  ///< in the mesh
  std::vector<bool> mirrored;
};

bool has_repeated_point(Hexahedron nodes) {
  std::ranges::sort(nodes);
  return std::ranges::adjacent_find(nodes) != nodes.end();
}

bool has_finite_corners(const Mesh& mesh, const Hexahedron& nodes) {
  return std::ranges::all_of(nodes, [&](Index v) {
    if (v >= mesh.points.size()) return false;
    const Vec3& x = mesh.points[v];
    return std::isfinite(x[0] + x[1] + x[2]);
  });
}

/// Elements that would seem mirrored if only their negative volume were tested: their neighbours,
/// which they overlap, show that they are numbered like the others and turned inside out.
std::vector<Index> find_inside_out(const Turned& turned, Index point_count) {
  const auto mirrored = static_cast<std::size_t>(std::ranges::count(turned.mirrored, true));
  if (mirrored == 0) return {};
  const bool bad_are_mirrored = 2 * mirrored <= turned.mirrored.size();
  std::vector<MapFault> faults;
  match_faces(turned.hexahedra, point_count, faults);
  std::vector<Index> result;
  for (const MapFault& fault : faults) {
    const auto [one, other, unused] = fault.elements;
    if (fault.kind != MapFault::Kind::same_side) continue;
    if (turned.mirrored[one] == turned.mirrored[other]) continue;
    result.push_back(turned.place[turned.mirrored[one] == bad_are_mirrored ? one : other]);
  }
  sort_unique(result);
  return result;
}

BadElements find_bad(const Mesh& mesh, bool allow_inverted_rest) {
  BadElements bad;
  Turned turned;
  for (Index e = 0; e < mesh.hexahedra.size(); ++e) {
    Hexahedron nodes = mesh.hexahedra[e];
    if (!has_finite_corners(mesh, nodes)) continue;
    if (has_repeated_point(nodes)) {
      bad.repeated.push_back(e);
      continue;
    }
    Corners x;
    for (std::size_t i = 0; i < 8; ++i) x[i] = mesh.points[nodes[i]];
    const RestShape shape = rest_shape(x);
    if (allow_inverted_rest ? shape.unusable : shape.inverted) {
      bad.inverted.push_back(e);
      continue;
    }
    if (shape.mirrored) mirror(nodes);
    turned.hexahedra.push_back(nodes);
    turned.place.push_back(e);
    turned.mirrored.push_back(shape.mirrored);
  }
  bad.inside_out = find_inside_out(turned, static_cast<Index>(mesh.points.size()));
  return bad;
}

std::string kinds_text(const BadElements& bad, bool allow_inverted_rest, const UserNames& names) {
  const auto ids = [&](const std::vector<Index>& elements) {
    return std::to_string(elements.size()) + " (" +
           listed(
               elements, [&](Index e) { return names.element(e); }, 20) +
           ") ";
  };
  std::string text;
  if (!bad.inverted.empty())
    text = ids(bad.inverted) + (allow_inverted_rest
                                    ? "with a Jacobian <= 0 at a corner and at a Gauss point"
                                    : "with a corner Jacobian <= 0");
  if (!bad.inside_out.empty())
    text += (text.empty() ? "" : ", ") + ids(bad.inside_out) + "inside out";
  if (!bad.repeated.empty())
    text += (text.empty() ? "" : ", ") + ids(bad.repeated) + "with the same point twice";
  return text;
}

/// Unites elements with a common face, whatever the order of its points: elements may be numbered
/// as mirror images.
void unite_across_faces(std::span<const Hexahedron> hexahedra, DisjointSets& sets) {
  struct Face {
    std::array<Index, 4> points;
    Index element;
  };
  std::vector<Face> faces;
  faces.reserve(hexahedra.size() * 6);
  for (Index e = 0; e < hexahedra.size(); ++e)
    for (std::size_t f = 0; f < 6; ++f) {
      Face face{{}, e};
      for (std::size_t k = 0; k < 4; ++k)
        face.points[k] = hexahedra[e][hexahedron::dart_vertex[4 * f + k]];
      std::ranges::sort(face.points);
      faces.push_back(face);
    }
  std::ranges::sort(faces, {}, &Face::points);
  for (std::size_t i = 1; i < faces.size(); ++i)
    if (faces[i].points == faces[i - 1].points) sets.unite(faces[i].element, faces[i - 1].element);
}

/// Unites bad elements with all that have a point in common with them.
void unite_around(std::span<const Index> bad, const Mesh& mesh, DisjointSets& sets) {
  std::vector<Index> bad_at(mesh.points.size(), none);
  for (const Index e : bad)
    for (const Index v : mesh.hexahedra[e]) bad_at[v] = e;
  for (Index e = 0; e < mesh.hexahedra.size(); ++e)
    for (const Index v : mesh.hexahedra[e])
      if (v < bad_at.size() && bad_at[v] != none) sets.unite(e, bad_at[v]);
}

/// How many sets of elements there are that are connected by common faces; a bad element, whose
/// faces may be collapsed, holds all around it together.
std::size_t pieces_of(const Mesh& mesh, std::span<const Index> bad = {}) {
  DisjointSets sets(mesh.hexahedra.size());
  unite_across_faces(mesh.hexahedra, sets);
  unite_around(bad, mesh, sets);
  std::size_t pieces = 0;
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) pieces += sets.find(e) == e ? 1 : 0;
  return pieces;
}

/// Keeps the numbers of the remaining elements by writing them down, and their sets.
void remove(std::span<const Index> bad, Mesh& mesh) {
  std::vector<bool> is_bad(mesh.hexahedra.size());
  for (const Index e : bad) is_bad[e] = true;
  std::vector<Index> new_place(is_bad.size(), none);
  std::vector<std::uint64_t> ids;
  for (Index e = 0, next = 0; e < is_bad.size(); ++e) {
    if (is_bad[e]) continue;
    mesh.hexahedra[next] = mesh.hexahedra[e];
    for (MeshArray& array : mesh.arrays) array.move_element(e, next);
    ids.push_back(mesh.element_ids.empty() ? e : mesh.element_ids[e]);
    new_place[e] = next++;
  }
  mesh.hexahedra.resize(ids.size());
  for (MeshArray& array : mesh.arrays) array.keep_elements(ids.size());
  mesh.element_ids = std::move(ids);
  for (auto& [name, members] : mesh.element_sets) {
    for (Index& member : members) member = new_place[member];
    std::erase(members, none);
  }
}

}  // namespace

void drop_bad_elements(Mesh& mesh, bool allow_inverted_rest, Diagnostics& diagnostics) {
  const BadElements found = find_bad(mesh, allow_inverted_rest);
  const std::vector<Index> bad = found.all();
  if (bad.empty()) return;
  const std::string where = prefix(mesh.source);
  const std::string kinds = kinds_text(found, allow_inverted_rest, {{}, mesh.element_ids});
  const std::string total = std::to_string(mesh.hexahedra.size());
  if (bad.size() == mesh.hexahedra.size())
    throw TopologyError(where + "has no element that could be kept: all " + total + " are bad, " +
                        kinds + ". Check the order of the nodes, or repair the mesh");
  const std::size_t pieces_before = pieces_of(mesh, bad);
  remove(bad, mesh);
  diagnostics.warn(where + "has " + counted(bad.size(), "bad element", "bad elements") + " of " +
                   total + ", left out: " + kinds);
  const std::size_t pieces = pieces_of(mesh);
  if (pieces > pieces_before)
    diagnostics.warn(where + "falls into " + std::to_string(pieces) +
                     " separate pieces without its bad elements (" + std::to_string(pieces_before) +
                     " with them): constrain each, or repair the mesh");
}

}  // namespace suture
