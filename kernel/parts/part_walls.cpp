// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/part_walls.hpp"

#include <algorithm>
#include <bit>

#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/division.hpp"
#include "kernel/parts/embedding.hpp"
#include "kernel/parts/moments.hpp"

namespace suture {
namespace {

PlaceInMesh place_in_mesh(const Vec3& at, Index lattice_element, const Hexahedron& corners) {
  const std::array<double, 8> weights = trilinear_weights(at);
  const auto used = 8 - std::ranges::count(weights, 0);
  if (used == 8) return {{lattice_element, none, none, none}, {at[0], at[1], at[2], 1}};
  PlaceInMesh place;  // of at most four vertices, ascending
  std::size_t count = 0;
  for (std::size_t n = 0; n < 8 && count < 4; ++n) {
    if (weights[n] == 0) continue;
    std::size_t i = count++;
    for (; i > 0 && place.cells[i - 1] > corners[n]; --i) {
      place.cells[i] = place.cells[i - 1];
      place.numbers[i] = place.numbers[i - 1];
    }
    place.cells[i] = corners[n];
    place.numbers[i] = weights[n];
  }
  return place;
}

/// Which of the six Kuhn tetrahedra a place is in.
unsigned kuhn_tetrahedron(const Vec3& at) {
  return (at[0] > at[1] ? 1u : 0u) | (at[1] > at[2] ? 2u : 0u) | (at[0] > at[2] ? 4u : 0u);
}

}  // namespace

std::size_t HashOfPlace::operator()(const PlaceInMesh& place) const {
  std::uint64_t hash = 0;
  const auto mix = [&](std::uint64_t value) {
    hash = (hash ^ value) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 29;
  };
  for (const Index cell : place.cells) mix(cell);
  for (const double number : place.numbers) mix(std::bit_cast<std::uint64_t>(number));
  return hash;
}

PartWalls::PartWalls(const Parts& parts, const std::vector<Index>& cut_of_triangle,
                     const CellComplex& complex, const LatticePlaces& places,
                     std::span<const Index> elements)
    : parts_(parts), places_(places) {
  find_elements(complex, elements);
  for (Index i = 0; i < elements_.size(); ++i) read_element(i);
  find_walls();
  match_surface(cut_of_triangle);
}

bool PartWalls::is_wanted(const Wall& wall) const {
  return std::ranges::any_of(
      wall.known_sides(), [&](const Side& side) { return elements_[element_of(side)].is_wanted; });
}

bool PartWalls::is_kept(Index low, Index high) const {
  return std::ranges::binary_search(kept_edges_, std::pair(low, high));
}

Index PartWalls::known_number(Index element, const Vec3& at) const {
  const Index e = elements_[element].number;
  return numbers_.at(place_in_mesh(at, places_.element(e), places_.of(e)));
}

/// The wanted elements, and all that share a corner of the mesh with one of them.
void PartWalls::find_elements(const CellComplex& complex, std::span<const Index> wanted) {
  std::vector<bool> is_near;
  const auto mark = [&](Index vertex) {
    if (vertex >= is_near.size()) is_near.resize(vertex + std::size_t{1});
    is_near[vertex] = true;
  };
  std::vector<bool> is_wanted(complex.element_count());
  for (const Index e : wanted) {
    is_wanted[e] = true;
    for (const Index v : places_.of(e)) mark(v);
  }
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const bool meets = std::ranges::any_of(
        places_.of(e), [&](Index v) { return v < is_near.size() && is_near[v]; });
    if (meets) {
      Element& element = elements_.emplace_back();
      element.number = e;
      element.place = position_in(parts_.elements, e);
      element.is_wanted = is_wanted[e];
    }
  }
}

Index PartWalls::number(Index element, const Vec3& at) {
  const Index e = elements_[element].number;
  return numbers_
      .try_emplace(place_in_mesh(at, places_.element(e), places_.of(e)),
                   static_cast<Index>(numbers_.size()))
      .first->second;
}

void PartWalls::read_element(Index i) {
  Element& element = elements_[i];
  const auto first_cell = static_cast<Index>(cells_.size());
  const auto add = [&](const std::array<Vec3, 4>& at, Index cell) {
    if (cells_.size() <= first_cell + std::size_t{cell})
      cells_.resize(first_cell + cell + std::size_t{1});
    Tetrahedron t{{}, i, first_cell + cell};
    for (std::size_t c = 0; c < 4; ++c) {
      t.corners[c] = number(i, at[c]);
      element.points.emplace_back(t.corners[c], at[c]);
    }
    Cell& of = cells_[t.cell];
    of.volume += six_volumes(at);
    of.tetrahedra.push_back(static_cast<Index>(tetrahedra_.size()));
    tetrahedra_.push_back(t);
  };
  if (element.place == parts_.elements.size()) {
    const Material& full = Material::full_element();
    for (std::size_t t = 0; t < full.tetrahedra.size(); ++t) {
      const auto& [a, b, c, d] = full.tetrahedra[t];
      add({full.points[a], full.points[b], full.points[c], full.points[d]}, static_cast<Index>(t));
    }
  } else {
    for (Index t = parts_.first[element.place]; t < parts_.first[element.place + 1]; ++t) {
      const auto& [a, b, c, d] = parts_.tetrahedra[t];
      const auto& p = parts_.points;
      add({p[a].at, p[b].at, p[c].at, p[d].at}, parts_.cells[t]);
    }
  }
  std::ranges::sort(element.points);
  element.points.erase(std::unique(element.points.begin(), element.points.end(),
                                   [](const auto& a, const auto& b) { return a.first == b.first; }),
                       element.points.end());
  for (std::size_t c = first_cell; c < cells_.size(); ++c) {
    cells_[c].element = i;
    Vec3 sum{};
    for (const Index t : cells_[c].tetrahedra)
      for (const Index p : tetrahedra_[t].corners) sum = plus(sum, place(i, p));
    cells_[c].kuhn = kuhn_tetrahedron(sum);
  }
}

const Vec3& PartWalls::place(Index element, Index point) const {
  const auto& points = elements_[element].points;
  return std::ranges::lower_bound(points, point, {}, &std::pair<Index, Vec3>::first)->second;
}
bool PartWalls::has(Index element, Index point) const {
  const auto& points = elements_[element].points;
  const auto at = std::ranges::lower_bound(points, point, {}, &std::pair<Index, Vec3>::first);
  return at != points.end() && at->first == point;
}

Triangle PartWalls::outward(const Face& face) const {
  const auto& corners = tetrahedra_[face.tetrahedron].corners;
  const auto& [a, b, c] = tetrahedron_faces[face.face];
  return {corners[a], corners[b], corners[c]};
}

/// The faces of cells: those of tetrahedra that are not between two of one cell.
void PartWalls::find_walls() {
  std::vector<Face> faces;
  faces.reserve(4 * tetrahedra_.size());
  for (Index t = 0; t < tetrahedra_.size(); ++t)
    for (unsigned f = 0; f < 4; ++f) {
      Face face{{}, t, f};
      face.key = outward(face);
      std::ranges::sort(face.key);
      faces.push_back(face);
    }
  std::ranges::sort(faces, [](const Face& a, const Face& b) {
    return a.key != b.key ? a.key < b.key : a.tetrahedron < b.tetrahedron;
  });
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    while (end < faces.size() && faces[end].key == faces[i].key) ++end;
    const auto cell = [&](std::size_t k) { return tetrahedra_[faces[k].tetrahedron].cell; };
    if (end - i == 2 && cell(i) == cell(i + 1)) continue;
    Wall wall;
    wall.count = static_cast<unsigned>(end - i);
    for (std::size_t k = i; k < std::min(i + 2, end); ++k)
      wall.sides[k - i] = {faces[k].tetrahedron, outward(faces[k]), {}};
    for (std::size_t k = i; k < end; ++k)
      cells_[cell(k)].walls.push_back(static_cast<Index>(walls_.size()));
    keys_.push_back(faces[i].key);
    walls_.push_back(wall);
  }
}

/// Finds the walls that the surface of the body shows. Points and edges of others of its
/// triangles stay.
void PartWalls::match_surface(const std::vector<Index>& cuts) {
  std::unordered_map<Index, Index> position;
  for (Index i = 0; i < elements_.size(); ++i) position[elements_[i].number] = i;
  is_matched_.assign(parts_.triangles.size(), 0);
  is_kept_.assign(numbers_.size(), 0);
  for (std::size_t t = 0; t < parts_.triangles.size(); ++t) {
    const auto& corners = parts_.triangles[t];
    const auto at = position.find(parts_.points[corners[0]].element);
    if (at == position.end()) continue;
    Triangle points;
    for (std::size_t c = 0; c < 3; ++c)
      points[c] = number(at->second, parts_.points[corners[c]].at);
    is_kept_.resize(numbers_.size(), 0);
    if (mark(points, at->second, {parts_.is_cut[t], cuts[t]})) {
      is_matched_[t] = 1;
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      is_kept_[points[c]] = 1;
      kept_edges_.push_back(std::minmax(points[c], points[(c + 1) % 3]));
    }
  }
  sort_unique(kept_edges_);
}
bool PartWalls::mark(const Triangle& points, Index element, const Mark& as) {
  Triangle key = points;
  std::ranges::sort(key);
  const auto found = std::ranges::lower_bound(keys_, key);
  if (found == keys_.end() || *found != key) return false;
  Wall& wall = walls_[static_cast<std::size_t>(found - keys_.begin())];
  for (unsigned s = 0; s < std::min(wall.count, 2u); ++s) {
    Side& side = wall.sides[s];
    if (tetrahedra_[side.tetrahedron].element != element || side.mark.is_cut != hidden) continue;
    const auto& [a, b, c] = side.outward;
    if (points != Triangle{a, b, c} && points != Triangle{b, c, a} && points != Triangle{c, a, b})
      continue;
    side.mark = as;
    return true;
  }
  return false;
}

}  // namespace suture
