// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/neighbour_lists.hpp"

#include <algorithm>

#include "kernel/base/rows.hpp"
#include "kernel/contact/patch.hpp"
#include "kernel/contact/place_grid.hpp"

namespace suture {
namespace {

// In typical edges: how far things move in all before pairs are sought again.
constexpr double skin = 0.5;
// In typical edges: what is less far behind a face at rest belongs to the same sheet, unless it is
// in the face but for rounding.
constexpr double thin = 0.5, level = 1e-4;

Box box_of(const FeatureEdge& edge, const double* positions) {
  Box box = no_box;
  for (const Index v : edge.ends) include(box, row(positions, v));
  return box;
}

}  // namespace

NeighbourLists::NeighbourLists(const CellComplex& complex, const BoundarySurface& surface,
                               Attributes& attributes, bool self, double edge, double depth)
    : complex_(complex),
      surface_(surface),
      attributes_(attributes),
      self_(self),
      edge_(edge),
      reach_((depth + skin) * edge),
      islands_(complex),
      was_outside_(6 * std::size_t{complex.element_count()}) {
  for (const Index face : surface.faces()) was_outside_[face] = true;
}

void NeighbourLists::update(const double* positions, const LiveMask& moving) {
  if (is_stale_) may_meet_ = find_what_may_meet();
  if (is_stale_ || (may_meet_ && has_moved(positions))) rebuild(positions, moving);
  is_stale_ = false;
}

/// False if nothing may.
bool NeighbourLists::find_what_may_meet() {
  meeting_.piece_of.assign(attributes_.vertex_count(), none);
  ascending_ = surface_.ascending_vertices();
  for (const Index v : ascending_)
    meeting_.piece_of[v] = islands_.of(element_of(complex_.dart_of(0, v)));
  meeting_.vertex_meets_own.assign(attributes_.vertex_count(), self_);
  meeting_.face_meets_own.assign(surface_.faces().size(), self_);
  bool has_lips = false;
  for (Index i = 0; i < surface_.faces().size(); ++i) {
    if (was_outside_[surface_.faces()[i]]) continue;
    has_lips = true;
    meeting_.face_meets_own[i] = true;
    for (const Index v : surface_.corners()[i]) meeting_.vertex_meets_own[v] = true;
  }
  edges_ = suture::feature_edges(complex_, surface_, attributes_.rest().rows());
  return has_lips || self_ || islands_.existing() > 1;
}

bool NeighbourLists::has_moved(const double* positions) const {
  const double limit = edge_ * skin / 2;
  for (std::size_t i = 0; i < built_at_.size(); ++i) {
    const Vec3 way = minus(row(positions, ascending_[i]), built_at_[i]);
    if (dot(way, way) > limit * limit) return true;
  }
  return false;
}

void NeighbourLists::rebuild(const double* positions, const LiveMask& moving) {
  built_at_.clear();
  pairs_.clear();
  edge_pairs_.clear();
  if (may_meet_) {
    for (const Index v : ascending_) built_at_.push_back(row(positions, v));
    find_pairs(positions, moving);
    find_edge_pairs(positions, moving);
  }
  number_what_is_near();
}

void NeighbourLists::find_pairs(const double* positions, const LiveMask& moving) {
  pairs_ = near_pairs(surface_, meeting_, positions, reach_);
  std::erase_if(pairs_, [&](const NearPair& pair) {
    const bool both_sleep = !moving[pair.vertex] && !moving[surface_.corners()[pair.face][0]];
    return both_sleep || is_behind_at_rest(pair);
  });
}

/// Within a piece: only material is between the vertex and the face, as across a thin sheet.
bool NeighbourLists::is_behind_at_rest(const NearPair& pair) const {
  if (meeting_.piece_of[pair.vertex] != meeting_.piece_of[surface_.corners()[pair.face][0]])
    return false;
  const auto& of_element = complex_.vertices_of(surface_.faces()[pair.face] / 6);
  if (std::ranges::find(of_element, pair.vertex) != of_element.end()) return true;
  const double* rest = attributes_.rest().rows();
  const Patch::Foot foot =
      patch_of(surface_.corners()[pair.face], rest).foot(row(rest, pair.vertex));
  return norm(foot.offset) < thin * edge_ && dot(foot.offset, foot.normal) < -level * edge_;
}

bool NeighbourLists::may_meet(const NearPair& pair) const {
  const BoundarySurface::Corners& corners = surface_.corners()[pair.face];
  if (meeting_.piece_of[pair.vertex] != meeting_.piece_of[corners[0]]) return true;
  return meeting_.face_meets_own[pair.face] && meeting_.vertex_meets_own[pair.vertex] &&
         std::ranges::find(corners, pair.vertex) == corners.end() && !is_behind_at_rest(pair);
}

bool NeighbourLists::may_meet(const NearEdges& pair) const {
  const std::array<Index, 2>&a = edges_[pair.first].ends, &b = edges_[pair.second].ends;
  if (meeting_.piece_of[a[0]] != meeting_.piece_of[b[0]]) return true;
  const bool have_common_end = std::ranges::find_first_of(a, b) != a.end();
  return self_ && !have_common_end && !are_near_at_rest(pair);
}

void NeighbourLists::find_edge_pairs(const double* positions, const LiveMask& moving) {
  edge_pairs_ = near_edges(edges_, meeting_.piece_of, self_, positions, reach_);
  std::erase_if(edge_pairs_, [&](const NearEdges& pair) {
    const bool both_sleep =
        !moving[edges_[pair.first].ends[0]] && !moving[edges_[pair.second].ends[0]];
    return both_sleep || are_near_at_rest(pair);
  });
}

/// Within a piece: as edges on both sides of a thin sheet.
bool NeighbourLists::are_near_at_rest(const NearEdges& pair) const {
  const FeatureEdge &a = edges_[pair.first], &b = edges_[pair.second];
  if (meeting_.piece_of[a.ends[0]] != meeting_.piece_of[b.ends[0]]) return false;
  const double* rest = attributes_.rest().rows();
  return overlap(enlarged(box_of(a, rest), thin * edge_), box_of(b, rest));
}

/// By place in the surface.
std::vector<Index> NeighbourLists::near_faces() const {
  std::vector<bool> has_pair(attributes_.vertex_count()), is_near(surface_.corners().size());
  for (const NearPair& pair : pairs_) has_pair[pair.vertex] = is_near[pair.face] = true;
  for (const NearEdges& pair : edge_pairs_)
    for (const Index i : {pair.first, pair.second})
      for (const Index face : edges_[i].faces) is_near[face] = true;
  std::vector<Index> faces;
  for (Index face = 0; face < is_near.size(); ++face)
    if (is_near[face] ||
        std::ranges::any_of(surface_.corners()[face], [&](Index v) { return has_pair[v]; }))
      faces.push_back(face);
  std::ranges::sort(faces, {}, [&](Index face) { return surface_.corners()[face]; });
  return faces;
}

/// A vertex of a pair is a corner of faces around it.
void NeighbourLists::number_what_is_near() {
  const std::vector<Index> faces = near_faces();
  std::vector<Index> vertex_place(attributes_.vertex_count(), none);
  std::vector<Index> face_place(surface_.corners().size(), none), edge_place(edges_.size(), none);
  for (Index i = 0; i < faces.size(); ++i) {
    face_place[faces[i]] = i;
    for (const Index v : surface_.corners()[faces[i]]) vertex_place[v] = 0;
  }
  vertices_.clear();
  for (const Index v : ascending_) {
    if (vertex_place[v] == none) continue;
    vertex_place[v] = static_cast<Index>(vertices_.size());
    vertices_.push_back(v);
  }
  faces_.clear();
  for (const Index face : faces) {
    BoundarySurface::Corners& corners = faces_.emplace_back(surface_.corners()[face]);
    for (Index& v : corners) v = vertex_place[v];
  }
  for (NearPair& pair : pairs_) pair = {vertex_place[pair.vertex], face_place[pair.face]};
  near_edges_.clear();
  const auto place_of = [&](Index i) {
    if (edge_place[i] == none) {
      edge_place[i] = static_cast<Index>(near_edges_.size());
      const auto& [ends, of_edge] = edges_[i];
      near_edges_.push_back({{vertex_place[ends[0]], vertex_place[ends[1]]},
                             {face_place[of_edge[0]], face_place[of_edge[1]]}});
    }
    return edge_place[i];
  };
  for (NearEdges& pair : edge_pairs_) {
    const Index first = place_of(pair.first);
    pair = {first, place_of(pair.second)};
  }
}

void NeighbourLists::follow(const TopologyChange& change) {
  islands_.update(complex_, change);
  is_stale_ = true;
}

void NeighbourLists::state(Archive& archive) {
  if (archive.has_cells()) archive("islands", islands_);
  if (archive.loads()) is_stale_ = true;
}

}  // namespace suture
