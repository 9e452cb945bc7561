// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/part_materials.hpp"

#include <algorithm>

#include "kernel/geometry/surface.hpp"
#include "kernel/parts/moments.hpp"

namespace suture {
namespace {

// A place this far outside a tetrahedron is in it; as six times a volume in the reference cube.
constexpr double volume_rounding = 1e-9;

bool contains(const std::array<Vec3, 4>& corners, const Vec3& at) {
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<Vec3, 4> beside = corners;
    beside[i] = at;
    if (six_volumes(beside) < -volume_rounding) return false;
  }
  return true;
}

}  // namespace

bool has_material(const Parts& parts, Index element, const Vec3& at) {
  const std::size_t place = position_in(parts.elements, element);
  if (place == parts.elements.size()) return true;
  const auto at_point = [&](Index p) { return parts.points[p].at; };
  for (Index t = parts.first[place]; t < parts.first[place + 1]; ++t) {
    const auto& [a, b, c, d] = parts.tetrahedra[t];
    if (contains({at_point(a), at_point(b), at_point(c), at_point(d)}, at)) return true;
  }
  return false;
}

void PartMaterials::find_surface(std::span<const Index> elements, Index element_count) {
  if (parts_.triangles.empty()) return;
  std::vector<std::uint8_t> is_wanted(element_count);
  for (const Index e : elements) is_wanted[e] = 1;
  for (Index t = 0; t < parts_.triangles.size(); ++t) {
    const Index e = parts_.points[parts_.triangles[t][0]].element;
    if (is_wanted[e] != 0) triangles_.push_back({e, t});
  }
  std::ranges::sort(triangles_);
}

const Material& PartMaterials::of(Index element, Material& own) const {
  const std::size_t place = position_in(parts_.elements, element);
  if (place == parts_.elements.size()) return Material::full_element();
  own.clear();
  const auto tetrahedra =
      std::span(parts_.tetrahedra)
          .subspan(parts_.first[place], parts_.first[place + 1] - parts_.first[place]);
  Index low = none, high = 0;  // the points of an element are near each other
  for (const auto& t : tetrahedra) {
    low = std::min(low, std::ranges::min(t));
    high = std::max(high, std::ranges::max(t));
  }
  std::vector<Index> number(high - low + std::size_t{1}, none);
  const auto add = [&](Index p) {
    Index& at = number[p - low];
    if (at == none) {
      at = static_cast<Index>(own.points.size());
      own.points.push_back(parts_.points[p].at);
    }
    return at;
  };
  for (const auto& [a, b, c, d] : tetrahedra)
    own.tetrahedra.push_back({add(a), add(b), add(c), add(d)});
  for (Index t = parts_.first[place]; t < parts_.first[place + 1]; ++t)
    own.cells.push_back(parts_.cells.empty() ? t - parts_.first[place] : Index{parts_.cells[t]});
  const auto number_of = [&](Index p) { return p < low || p > high ? none : number[p - low]; };
  for (const auto& [e, t] : triangles_of(element)) {
    const auto& [a, b, c] = parts_.triangles[t];
    const Triangle corners{number_of(a), number_of(b), number_of(c)};
    if (std::ranges::find(corners, none) != corners.end()) continue;
    own.triangles.push_back(corners);
    own.is_cut.push_back(is_cut(t));
  }
  return own;
}

std::span<const std::pair<Index, Index>> PartMaterials::triangles_of(Index element) const {
  const auto first =
      std::lower_bound(triangles_.begin(), triangles_.end(), std::pair(element, Index{0}));
  const auto last = std::lower_bound(first, triangles_.end(), std::pair(element + 1, Index{0}));
  return {first, last};
}

Material PartMaterials::with_surface(Index element, std::vector<Index>& numbers) const {
  Material own;
  Material material = of(element, own);
  material.triangles.clear();
  material.is_cut.clear();
  numbers.clear();
  for (const auto& [e, t] : triangles_of(element)) {
    Triangle corners = parts_.triangles[t];
    for (Index& corner : corners)
      corner = static_cast<Index>(std::ranges::find(material.points, parts_.points[corner].at) -
                                  material.points.begin());
    if (std::ranges::max(corners) == material.points.size()) continue;
    material.triangles.push_back(corners);
    material.is_cut.push_back(is_cut(t));
    numbers.push_back(t);
  }
  return material;
}

}  // namespace suture
