// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/embedded_parts.hpp"

#include <algorithm>
#include <unordered_set>

#include "kernel/base/archive.hpp"
#include "kernel/parts/coarse_parts.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/face_contacts.hpp"
#include "kernel/topology/dart.hpp"

namespace suture {
namespace {

/// Triangles that are no faces of the finer tetrahedra of their element have stayed: their corners
/// become the points from `first` at the same places. Those of an element follow each other.
void take_new_points(Parts& parts, Index first) {
  const std::vector<EmbeddedPoint>& points = parts.points;
  std::unordered_map<Index, Index> first_of;
  for (Index p = first; p < points.size(); ++p) first_of.try_emplace(points[p].element, p);
  for (auto& triangle : parts.triangles) {
    const Index element = points[triangle[0]].element;
    const auto of_element = first_of.find(element);
    if (of_element == first_of.end()) continue;
    for (Index& corner : triangle)
      for (Index p = of_element->second;
           corner < first && p < points.size() && points[p].element == element; ++p)
        if (points[p].at == points[corner].at) corner = p;
  }
}

}  // namespace

void EmbeddedParts::let_grow(const CellComplex& complex) {
  if (parts_.first.empty()) parts_.first.push_back(0);
  parts_.is_cut.assign(parts_.triangles.size(), 0);
  lattice_.assign(complex.vertices().begin(), complex.vertices().end());
  if (parts_.cells.empty())
    for (std::size_t i = 0; i < parts_.elements.size(); ++i)
      for (Index t = parts_.first[i]; t < parts_.first[i + 1]; ++t)
        parts_.cells.push_back(t - parts_.first[i]);
  if (!parts_.empty()) return;  // its triangles are the surface
  parts_.outer_sides.assign(complex.element_count(), 0);
  for (Index e = 0; e < complex.element_count(); ++e)
    for (int f = 0; f < hexahedron::faces; ++f)
      if (complex.neighbour(e, f) == none)
        parts_.outer_sides[e] |= static_cast<std::uint8_t>(1u << f);
}

void EmbeddedParts::append(const Parts& added, std::span<const Index> origins, Index cut) {
  has_grown_ = true;
  is_current_ = false;
  const auto first_point = static_cast<Index>(parts_.points.size());
  const auto first_tetrahedron = static_cast<Index>(parts_.tetrahedra.size());
  const std::size_t first_triangle = parts_.triangles.size();
  const auto append = [](auto& list, const auto& more) {
    list.insert(list.end(), more.begin(), more.end());
  };
  append(parts_.elements, added.elements);
  append(parts_.moments, added.moments);
  append(parts_.points, added.points);
  append(parts_.is_cut, added.is_cut);
  append(parts_.cells, added.cells);
  for (const Index origin : origins) lattice_origin_.push_back(lattice_element(origin));
  for (auto corners : added.tetrahedra) {
    for (Index& p : corners) p += first_point;
    parts_.tetrahedra.push_back(corners);
  }
  for (std::size_t i = 1; i < added.first.size(); ++i)
    parts_.first.push_back(first_tetrahedron + added.first[i]);
  for (auto corners : added.triangles) {
    for (Index& p : corners) p += first_point;
    parts_.triangles.push_back(corners);
  }
  const Index first_copy = added.elements.empty() ? none : added.elements.front();
  inherit_cuts(first_triangle, first_copy, origins, cut);
  inherit_sides(first_copy, origins);
  for (const Index e : origins)
    if (!parts_.outer_sides.empty())
      parts_.outer_sides.push_back(std::uint8_t{parts_.outer_sides[e]});
}

void EmbeddedParts::refine(const RefinedParts& refined) {
  if (refined.parts.elements.empty()) return;
  has_grown_ = true;
  is_current_ = false;
  const auto first_point = static_cast<Index>(parts_.points.size());
  parts_.points.insert(parts_.points.end(), refined.parts.points.begin(),
                       refined.parts.points.end());
  replace_tetrahedra(refined.parts, first_point);
  cut_of_triangle_.resize(parts_.triangles.size(), none);
  std::unordered_set<Index> replaced;
  for (std::size_t t = 0; t < refined.sources.size(); ++t) {
    auto corners = refined.parts.triangles[t];
    for (Index& p : corners) p += first_point;
    const Index source = refined.sources[t];
    if (replaced.insert(source).second) {  // the first piece of a triangle takes its place
      parts_.triangles[source] = corners;
      continue;
    }
    parts_.triangles.push_back(corners);
    parts_.is_cut.push_back(std::uint8_t{parts_.is_cut[source]});
    cut_of_triangle_.push_back(Index{cut_of_triangle_[source]});
  }
  take_new_points(parts_, first_point);
}

void EmbeddedParts::replace_tetrahedra(const Parts& refined, Index first_point) {
  Parts merged;
  merged.first.push_back(0);
  const auto take = [&](const Parts& from, std::size_t i, Index offset) {
    merged.elements.push_back(from.elements[i]);
    merged.moments.push_back(from.moments[i]);
    for (Index t = from.first[i]; t < from.first[i + 1]; ++t) {
      auto corners = from.tetrahedra[t];
      for (Index& p : corners) p += offset;
      merged.tetrahedra.push_back(corners);
      merged.cells.push_back(Index{from.cells[t]});
    }
    merged.first.push_back(static_cast<Index>(merged.tetrahedra.size()));
  };
  std::size_t next = 0;
  for (std::size_t i = 0; i < refined.elements.size(); ++i) {
    const Index element = refined.elements[i];
    for (; next < parts_.elements.size() && parts_.elements[next] < element; ++next)
      take(parts_, next, 0);
    if (next < parts_.elements.size() && parts_.elements[next] == element) ++next;
    take(refined, i, first_point);
  }
  for (; next < parts_.elements.size(); ++next) take(parts_, next, 0);
  parts_.elements = std::move(merged.elements);
  parts_.moments = std::move(merged.moments);
  parts_.tetrahedra = std::move(merged.tetrahedra);
  parts_.cells = std::move(merged.cells);
  parts_.first = std::move(merged.first);
}

void EmbeddedParts::coarsen(const CellComplex& complex, std::span<const Index> elements,
                            std::size_t most) {
  if (lattice_.empty()) return;  // no blade divides this body
  std::vector<Index> fine;
  for (const Index e : elements) {
    const std::size_t i = position_in(parts_.elements, e);
    if (i < parts_.elements.size() && parts_.first[i + 1] - parts_.first[i] > most)
      fine.push_back(e);
  }
  if (fine.empty()) return;
  cut_of_triangle_.resize(parts_.triangles.size(), none);
  is_current_ = false;
  coarsen_parts(parts_, cut_of_triangle_, complex, {lattice_, lattice_origin_}, fine);
}

LipTriangle EmbeddedParts::triangle(std::size_t t) const {
  const auto& [a, b, c] = parts_.triangles[t];
  return LipTriangle({parts_.points[a].at, parts_.points[b].at, parts_.points[c].at});
}

/// The triangles of lips from `first_triangle` on are of this cut, except those of copies that lie
/// on lips of their origins, which ascend. O(triangles).
void EmbeddedParts::inherit_cuts(std::size_t first_triangle, Index first_copy,
                                 std::span<const Index> origins, Index cut) {
  cut_of_triangle_.resize(parts_.triangles.size(), none);
  const auto element = [&](std::size_t t) { return parts_.points[parts_.triangles[t][0]].element; };
  std::vector<bool> is_origin(origins.empty() ? 0 : origins.back() + std::size_t{1});
  for (const Index e : origins) is_origin[e] = true;
  std::vector<std::pair<Index, Index>> lips;  // origin, triangle
  for (std::size_t t = 0; t < first_triangle; ++t)
    if (parts_.is_cut[t] != 0 && element(t) < is_origin.size() && is_origin[element(t)])
      lips.emplace_back(element(t), static_cast<Index>(t));
  std::ranges::sort(lips);
  for (std::size_t t = first_triangle; t < parts_.triangles.size(); ++t) {
    if (parts_.is_cut[t] == 0) continue;
    cut_of_triangle_[t] = cut;
    if (element(t) < first_copy) continue;
    const Index origin = origins[element(t) - first_copy];
    const auto first = std::ranges::lower_bound(lips, std::pair(origin, Index{0})),
               last = std::ranges::lower_bound(lips, std::pair(origin + 1, Index{0}));
    if (first == last) continue;
    const LipTriangle of_copy = triangle(t);
    const auto lip = std::find_if(
        first, last, [&](const auto& pair) { return triangle(pair.second).covers(of_copy); });
    if (lip != last && cut_of_triangle_[lip->second] != none)
      cut_of_triangle_[t] = Index{cut_of_triangle_[lip->second]};
  }
}

void EmbeddedParts::inherit_sides(Index first, std::span<const Index> origins) {
  if (cut_of_side_.empty()) return;
  for (Index i = 0; i < origins.size(); ++i)
    for (int f = 0; f < hexahedron::faces; ++f)
      if (const auto known = cut_of_side_.find(face_dart(origins[i], f));
          known != cut_of_side_.end())
        cut_of_side_[face_dart(first + i, f)] = Index{known->second};
}

std::vector<Index> EmbeddedParts::cuts(const CellComplex& complex) {
  std::vector<Index> cuts;
  const Index first_side = static_cast<Index>(parts_.triangles.size());
  for (const Index source : embedding(complex).triangle_source) {
    const auto side = cut_of_side_.find(source < first_side ? none : 4 * (source - first_side));
    cuts.push_back(side != cut_of_side_.end()         ? side->second
                   : source < cut_of_triangle_.size() ? cut_of_triangle_[source]
                                                      : none);
  }
  return cuts;
}

void EmbeddedParts::join(std::span<const Seam> seams) {
  if (seams.empty()) return;
  std::vector<Dart> sides;
  for (const auto& [one, other] : seams) sides.insert(sides.end(), {face_of(one), face_of(other)});
  close(std::move(sides));
  append(FaceContacts(parts_).uncovered(seams), {});
}

/// Forgets what is open on these sides of elements.
void EmbeddedParts::close(std::vector<Dart> closed) {
  std::ranges::sort(closed);
  parts_.is_cut.resize(parts_.triangles.size(), 0);  // before the first cut, both lists are empty
  cut_of_triangle_.resize(parts_.triangles.size(), none);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < parts_.triangles.size(); ++t) {
    const auto& [a, b, c] = parts_.triangles[t];
    const auto at = [&](Index p) { return sides_at(parts_.points[p].at); };
    const unsigned on = parts_.is_cut[t] != 0 ? at(a) & at(b) & at(c) : 0;
    bool is_closed = false;
    for (unsigned s = 0; s < cube_sides.size() && on != 0; ++s) {
      const Dart side = face_dart(parts_.points[a].element, cube_sides[s].face());
      is_closed = is_closed || ((on >> s & 1) != 0 && std::ranges::binary_search(closed, side));
    }
    if (is_closed) continue;
    parts_.triangles[kept] = parts_.triangles[t];
    cut_of_triangle_[kept] = cut_of_triangle_[t];
    parts_.is_cut[kept++] = std::uint8_t{parts_.is_cut[t]};
  }
  parts_.triangles.resize(kept);
  cut_of_triangle_.resize(kept);
  parts_.is_cut.resize(kept);
}

void EmbeddedParts::state(Archive& archive) {
  if (!archive.has_cells()) return;
  std::vector<std::array<Index, 2>> sides;
  for (const auto& [side, cut] : cut_of_side_) sides.push_back({side, cut});
  std::ranges::sort(sides);
  archive("cut of side", sides);
  if (archive.loads()) {
    is_current_ = false;
    cut_of_side_.clear();
    for (const auto& [side, cut] : sides) cut_of_side_[side] = cut;
  }
  archive("has grown", has_grown_);
  if (!has_grown_) return;
  archive("elements", parts_.elements);
  archive.rows<double>("moments", parts_.moments);
  archive.member("point element", parts_.points, &EmbeddedPoint::element);
  archive.member("point at", parts_.points, &EmbeddedPoint::at);
  archive("tetrahedra", parts_.tetrahedra);
  archive("first", parts_.first);
  archive("cells", parts_.cells);
  archive("lattice origin", lattice_origin_);
  archive("triangles", parts_.triangles);
  archive("is cut", parts_.is_cut);
  archive("outer sides", parts_.outer_sides);
  archive("cut of triangle", cut_of_triangle_);
}

}  // namespace suture
