// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/select.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kernel/base/box.hpp"
#include "kernel/base/box_text.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/regions.hpp"
#include "kernel/geometry/centroid.hpp"
#include "kernel/parts/embedding.hpp"
#include "kernel/parts/node_places.hpp"

namespace suture {
namespace {

/// The box of a column of places.
Box box_of(const Column& places) {
  Box box = no_box;
  for (Index v = 0; v < places.size(); ++v)
    include(box, {places.get(v, 0), places.get(v, 1), places.get(v, 2)});
  return box;
}

using MeshSets = std::map<std::string, std::vector<Index>>;
std::vector<std::string> set_names(const MeshSets& a, const MeshSets& b,
                                   const std::vector<NamedSelection>& defined) {
  std::vector<std::string> names;
  for (const NamedSelection& set : defined) names.push_back(set.name);
  for (const auto& [name, unused] : a) names.push_back(name);
  for (const auto& [name, unused] : b) names.push_back(name);
  return names;
}

[[noreturn]] void unknown_set(const Selection& selection, const std::string& set,
                              const std::vector<std::string>& names) {
  std::string text =
      selection.path + ": the mesh has no set " + quote(set) + did_you_mean(set, names);
  text += names.empty() ? "; the mesh has no named sets" : "; it has";
  for (std::size_t i = 0; i < names.size() && i < 12; ++i)
    text += (i ? ", " : " ") + escaped(names[i]);
  throw InputError(text + (names.size() > 12 ? ", ..." : ""));
}

[[noreturn]] void unknown_id(const Selection& selection, const char* kind, std::uint64_t id) {
  throw InputError(selection.path + ": the mesh has no " + kind + " with id " + std::to_string(id));
}

/// mask_of(selection) of each part, combined. What is not selected is in mask_of("all") only.
template <class MaskOf>
std::vector<char> combined(const Selection::Combined& selection, MaskOf mask_of) {
  using How = Selection::Combined::How;
  std::vector<char> mask = mask_of(selection.parts.front());
  for (std::size_t i = 1; i < selection.parts.size(); ++i) {
    const std::vector<char> next = mask_of(selection.parts[i]);
    for (std::size_t cell = 0; cell < mask.size(); ++cell)
      mask[cell] =
          selection.how == How::all_of ? (mask[cell] && next[cell]) : (mask[cell] || next[cell]);
  }
  if (selection.how != How::none_of) return mask;
  std::vector<char> all = mask_of(Selection{});
  for (std::size_t cell = 0; cell < mask.size(); ++cell) all[cell] = all[cell] && !mask[cell];
  return all;
}

std::vector<Index> places_of(const std::vector<char>& mask) {
  std::vector<Index> cells;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] != 0) cells.push_back(static_cast<Index>(i));
  return cells;
}

std::map<std::uint64_t, Index> positions(const std::vector<std::uint64_t>& ids) {
  std::map<std::uint64_t, Index> map;
  for (std::size_t i = 0; i < ids.size(); ++i) map.emplace(ids[i], static_cast<Index>(i));
  return map;
}

// Position of a user's id in the mesh, or `none`.
Index position_of(std::uint64_t id, std::size_t count, const std::map<std::uint64_t, Index>& map) {
  if (map.empty()) return id < count ? static_cast<Index>(id) : none;
  const auto found = map.find(id);
  return found == map.end() ? none : found->second;
}

}  // namespace

MeshNames MeshNames::of(const Mesh& mesh) {
  return {mesh.point_sets, mesh.element_sets, mesh.point_ids,     mesh.element_ids,
          mesh.arrays,     mesh.mixtures,     mesh.points.size(), mesh.hexahedra.size()};
}

Selector::Selector(const Imported& imported, const MeshNames& names, const Column& rest,
                   const BodyFrame& frame, const Parts& parts,
                   const std::vector<NamedSelection>& sets)
    : imported_(imported),
      names_(names),
      rest_(rest),
      frame_(frame),
      parts_(parts),
      sets_(sets),
      diagonal_(diagonal_of(box_of(rest))),
      point_position_(positions(names.point_ids)),
      element_position_(positions(names.element_ids)) {}

/// Says where the nodes are, as selections by place see them.
std::string Selector::bounds_text() const {
  Box box = no_box;
  if (parts_.empty()) {
    box = box_of(rest_);
  } else {
    const NodePlaces places = node_places(parts_, imported_.complex);
    for (Index v = 0; v < rest_.size(); ++v)
      if (places.is_inside[v] != 0) include(box, row(rest_.rows(), v));
    for (const auto& [vertex, place] : places.crossings)
      include(box,
              place_in(imported_.complex.vertices_of(place.element), place.at, rest_.rows(), 4));
  }
  return box_text(frame_.in_scene(box.low), frame_.in_scene(box.high), 6) + " m";
}

Index Selector::element_with_id(std::uint64_t id) const {
  const Index position = position_of(id, names_.element_count, element_position_);
  return position == none ? none : imported_.element_of[position];
}

const Selection* Selector::defined(const Selection& selection) const {
  const auto* named = std::get_if<Selection::Named>(&selection.what);
  if (named == nullptr) return nullptr;
  const auto found = std::ranges::find(sets_, named->set, &NamedSelection::name);
  return found == sets_.end() ? nullptr : &found->where;
}

std::vector<Index> Selector::named_vertices(const Selection& selection,
                                            const std::string& set) const {
  std::vector<Index> result;
  if (const Selection* where = defined(selection)) return vertices(*where);
  if (const auto found = names_.point_sets.find(set); found != names_.point_sets.end()) {
    for (Index point : found->second) {
      for (Index vertex : imported_.vertices_of_point(point)) result.push_back(vertex);
    }
  } else if (const auto elements = names_.element_sets.find(set);
             elements != names_.element_sets.end()) {
    for (Index position : elements->second) {
      const Index element = imported_.element_of[position];
      if (!imported_.complex.exists(3, element)) continue;
      const Hexahedron& nodes = imported_.complex.vertices_of(element);
      result.insert(result.end(), nodes.begin(), nodes.end());
    }
  } else {
    unknown_set(selection, set, set_names(names_.point_sets, names_.element_sets, sets_));
  }
  return result;
}

bool Selector::contains(const Selection& selection, const Vec3& p) const {
  return lies_in(selection, p, diagonal_);
}

/// Cells selected by where they are, ascending: place(cell), which removed ones do not have.
/// `blocks`: of the cells, if they are elements.
template <class Place>
std::vector<Index> Selector::located(const Selection& selection, Index count,
                                     const ElementBlocks* blocks, Place place) const {
  std::vector<Index> result;
  if (selection.is_listed()) return result;
  if (const auto* near = std::get_if<Selection::Nearest>(&selection.what)) {
    NearestSearch search(*near);
    search.look(blocks, count, place);
    return search.found();
  }
  const auto may_hold = [&](const Box& box) { return may_hold_some(selection, box, diagonal_); };
  SearchedElements(blocks, count, may_hold).for_each([&](Index cell) {
    const std::optional<Vec3> p = place(cell);
    if (p && contains(selection, *p)) result.push_back(cell);
  });
  return result;
}

std::vector<Index> Selector::listed_vertices(const Selection& selection) const {
  std::vector<Index> result;
  if (const auto* ids = std::get_if<Selection::Ids>(&selection.what)) {
    for (std::uint64_t id : ids->ids) {
      const Index point = position_of(id, names_.point_count, point_position_);
      if (point == none) unknown_id(selection, "node", id);
      for (Index vertex : imported_.vertices_of_point(point)) result.push_back(vertex);
    }
  } else if (const auto* named = std::get_if<Selection::Named>(&selection.what)) {
    result = named_vertices(selection, named->set);
  }
  return result;
}

std::vector<char> Selector::vertex_mask(const Selection& selection, const double* rows) const {
  if (const auto* parts = selection.needs_masks())
    return combined(*parts, [&](const Selection& part) { return vertex_mask(part, rows); });
  const auto exists = [&](Index v) { return imported_.complex.exists(0, v); };
  std::vector<char> mask(rest_.size());
  for (const Index v : listed_vertices(selection)) mask[v] = exists(v);
  for (const Index v : located_vertices(selection, rows)) mask[v] = 1;
  return mask;
}

std::vector<Index> Selector::located_vertices(const Selection& selection,
                                              const double* rows) const {
  const auto located_where = [&](auto is_there) {
    return located(selection, rest_.size(), nullptr, [&](Index v) -> std::optional<Vec3> {
      const double* row = rows + std::size_t{v} * 4;
      if (!is_there(v)) return {};
      return Vec3{row[0], row[1], row[2]};
    });
  };
  if (parts_.empty()) return located_where([&](Index v) { return imported_.complex.exists(0, v); });
  const NodePlaces places = node_places(parts_, imported_.complex);
  std::vector<Index> result = located_where([&](Index v) { return places.is_inside[v] != 0; });
  for (const auto& [vertex, place] : places.crossings) {
    const Hexahedron& nodes = imported_.complex.vertices_of(place.element);
    if (contains(selection, place_in(nodes, place.at, rows, 4))) result.push_back(vertex);
  }
  return result;
}

std::vector<Index> Selector::vertices_now(const Selection& selection, const double* rows) const {
  return places_of(vertex_mask(selection, rows));
}

std::vector<Index> Selector::vertices(const Selection& selection) const {
  std::vector<Index> result = vertices_now(selection, rest_.rows());
  if (result.empty()) {
    throw InputError(selection.path + ": the selection contains no node; the nodes lie in " +
                     bounds_text());
  }
  return result;
}

std::vector<Index> Selector::named_elements(const Selection& selection,
                                            const std::string& set) const {
  if (const Selection* where = defined(selection)) return elements(*where);
  const auto found = names_.element_sets.find(set);
  if (found == names_.element_sets.end()) {
    if (names_.point_sets.contains(set))
      throw InputError(selection.path + ": " + quote(set) +
                       " is a set of nodes, but elements are expected; select them with a box, a "
                       "half_space or ids");
    unknown_set(selection, set, set_names(names_.element_sets, {}, sets_));
  }
  std::vector<Index> result;
  for (const Index position : found->second) result.push_back(imported_.element_of[position]);
  return result;
}

std::vector<char> Selector::element_mask(const Selection& selection, const double* rows) const {
  if (const auto* parts = selection.needs_masks())
    return combined(*parts, [&](const Selection& part) { return element_mask(part, rows); });
  std::vector<char> mask(element_count());
  for (const Index e : elements_now(selection, rows)) mask[e] = 1;
  return mask;
}

// Elements that the scene names one by one or by a set, ascending.
std::vector<Index> Selector::listed_elements(const Selection& selection) const {
  std::vector<Index> result;
  if (const auto* ids = std::get_if<Selection::Ids>(&selection.what)) {
    for (std::uint64_t id : ids->ids) {
      const Index element = element_with_id(id);
      if (element == none) unknown_id(selection, "element", id);
      result.push_back(element);
    }
  } else if (const auto* named = std::get_if<Selection::Named>(&selection.what)) {
    result = named_elements(selection, named->set);
  } else if (selection.is_listed()) {
    result = places_of(element_mask(selection, rest_.rows()));
  }
  sort_unique(result);
  return result;
}

std::vector<Index> Selector::elements(const Selection& selection,
                                      const ElementBlocks* at_rest) const {
  std::vector<Index> result = listed_elements(selection);
  if (selection.needs_masks()) result = places_of(element_mask(selection, rest_.rows()));
  if (const auto* named = std::get_if<Selection::Named>(&selection.what); named && result.empty())
    throw InputError(selection.path + ": no element belongs to the set " + quote(named->set) +
                     (names_.mixtures.materials.contains(named->set)
                          ? "; it fills most of no element: use more cells, or give its values in "
                            "a table of one model, where it counts by volume"
                          : ""));
  if (result.empty()) result = located_elements(selection, rest_.rows(), at_rest);
  if (result.empty()) {
    throw InputError(selection.path +
                     ": the selection contains no element (elements are selected by their "
                     "centroids); the mesh lies in " +
                     bounds_text());
  }
  return result;
}

std::vector<Index> Selector::located_elements(const Selection& selection, const double* rows,
                                              const ElementBlocks* blocks) const {
  const CellComplex& complex = imported_.complex;
  return located(selection, complex.element_count(), blocks, [&](Index e) -> std::optional<Vec3> {
    if (!complex.exists(3, e)) return {};
    return centroid_of(e, rows);
  });
}

Vec3 Selector::centroid_of(Index e, const double* rows) const {
  const Hexahedron& nodes = imported_.complex.vertices_of(e);
  const std::size_t part = position_in(parts_.elements, e);
  if (part == parts_.elements.size()) return centroid(nodes, rows, 4);
  return place_in(nodes, parts_.moments[part].centroid, rows, 4);
}

std::vector<Index> Selector::elements_now(const Selection& selection, const double* rows,
                                          const ElementBlocks* blocks) const {
  if (selection.needs_masks()) return places_of(element_mask(selection, rows));
  std::vector<Index> result = listed_elements(selection);
  const std::size_t listed = result.size();  // copies of them, too
  for (auto e = static_cast<Index>(names_.element_count); e < element_count() && listed > 0; ++e)
    if (std::binary_search(result.begin(), result.begin() + std::ptrdiff_t(listed),
                           imported_.element_of[imported_.user_element[e]]))
      result.push_back(e);
  std::erase_if(result, [&](Index e) { return !imported_.complex.exists(3, e); });
  const std::vector<Index> located = located_elements(selection, rows, blocks);
  result.insert(result.end(), located.begin(), located.end());
  return result;
}

std::vector<Dart> Selector::boundary_faces(const Selection& selection) const {
  const CellComplex& complex = imported_.complex;
  const std::vector<char> mask = vertex_mask(selection, rest_.rows());
  std::vector<Dart> result;
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Hexahedron& nodes = complex.vertices_of(e);
    for (int f = 0; f < hexahedron::faces; ++f) {
      const auto& corners = suture_hexahedron_faces[f];
      const bool selected =
          std::all_of(corners, corners + 4, [&](auto c) { return mask[nodes[c]] != 0; });
      if (selected && complex.neighbour(e, f) == none) result.push_back(face_dart(e, f));
    }
  }
  if (result.empty()) {
    throw InputError(selection.path +
                     ": the selection contains no boundary face (all four nodes of a face must be "
                     "selected); the nodes lie in " +
                     bounds_text());
  }
  return result;
}

std::vector<char> Selector::point_mask(const Selection& selection,
                                       const EmbeddedPoints& points) const {
  if (const auto* parts = selection.needs_masks())
    return combined(*parts, [&](const Selection& part) { return point_mask(part, points); });
  if (const Selection* where = defined(selection)) return point_mask(*where, points);
  std::vector<char> is_listed(rest_.size()), mask(points.size());
  for (const Index v : listed_vertices(selection)) is_listed[v] = 1;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::span nodes =
        std::span(points.vertices).subspan(points.first[p], points.first[p + 1] - points.first[p]);
    Vec3 place;
    for (std::size_t c = 0; c < 3; ++c) place[c] = points.value(p, rest_.rows(), 4, c);
    mask[p] = contains(selection, place) ||
              std::ranges::all_of(nodes, [&](Index v) { return is_listed[v] != 0; });
  }
  return mask;
}

std::vector<SurfaceTriangle> Selector::surface_triangles(const Selection& selection) const {
  if (parts_.empty()) return triangles_of_faces(boundary_faces(selection));
  const Embedding embedding(parts_, imported_.complex);
  const std::vector<char> mask = point_mask(selection, embedding.points);
  std::vector<SurfaceTriangle> result;
  for (Index t = 0; t < embedding.triangles.size(); ++t)
    if (std::ranges::all_of(embedding.triangles[t], [&](Index p) { return mask[p] != 0; }))
      result.push_back(surface_triangle(embedding, t, imported_.complex));
  if (result.empty()) {
    throw InputError(selection.path +
                     ": the selection contains no triangle of the surface (all three corners of a "
                     "triangle must be selected); the nodes lie in " +
                     bounds_text());
  }
  return result;
}

}  // namespace suture
