// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/embedded_parts.hpp"

#include "kernel/base/archive.hpp"

namespace suture {

void EmbeddedParts::let_grow(const CellComplex& complex) {
  if (parts_.first.empty()) parts_.first.push_back(0);
  parts_.is_cut.assign(parts_.triangles.size(), 0);
  if (!parts_.empty()) return;  // its triangles are the surface
  parts_.outer_sides.assign(complex.element_count(), 0);
  for (Index e = 0; e < complex.element_count(); ++e)
    for (int f = 0; f < hexahedron::faces; ++f)
      if (complex.neighbour(e, f) == none)
        parts_.outer_sides[e] |= static_cast<std::uint8_t>(1u << f);
}

void EmbeddedParts::append(const Parts& added, std::span<const Index> origins) {
  has_grown_ = true;
  is_current_ = false;
  const auto first_point = static_cast<Index>(parts_.points.size());
  const auto first_tetrahedron = static_cast<Index>(parts_.tetrahedra.size());
  const auto append = [](auto& list, const auto& more) {
    list.insert(list.end(), more.begin(), more.end());
  };
  append(parts_.elements, added.elements);
  append(parts_.moments, added.moments);
  append(parts_.points, added.points);
  append(parts_.is_cut, added.is_cut);
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
  for (const Index e : origins)
    if (!parts_.outer_sides.empty())
      parts_.outer_sides.push_back(std::uint8_t{parts_.outer_sides[e]});
}

void EmbeddedParts::state(Archive& archive) {
  if (!archive.has_cells()) return;
  archive("has grown", has_grown_);
  if (!has_grown_) return;
  archive("elements", parts_.elements);
  archive.rows<double>("moments", parts_.moments);
  archive.member("point element", parts_.points, &EmbeddedPoint::element);
  archive.member("point at", parts_.points, &EmbeddedPoint::at);
  archive("tetrahedra", parts_.tetrahedra);
  archive("first", parts_.first);
  archive("triangles", parts_.triangles);
  archive("is cut", parts_.is_cut);
  archive("outer sides", parts_.outer_sides);
  is_current_ = false;
}

}  // namespace suture
