// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "kernel/base/vec3.hpp"
#include "kernel/build/embedded_parts.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/operations/cut_along.hpp"
#include "kernel/operations/match_faces.hpp"
#include "kernel/operations/reunite.hpp"
#include "kernel/operations/seam_batch.hpp"
#include "kernel/parts/coarse_parts.hpp"
#include "kernel/parts/lattice.hpp"
#include "kernel/topology/islands.hpp"

namespace suture::test {

/// A box of unit cubes that is cut, without attributes.
struct CutBox {
  std::vector<Vec3> rows;
  CellComplex complex;
  EmbeddedParts parts{Parts{}};
  Islands islands;

  std::size_t most = many_tetrahedra;  ///< of a part that stays as it is
  std::vector<Index> origin, point;    ///< of elements and vertices, before all operations

  explicit CutBox(std::array<Index, 3> cells) : complex(imported(cells, rows)), islands(complex) {
    for (Index e = 0; e < complex.element_count(); ++e) origin.push_back(e);
    for (Index v = 0; v < rows.size(); ++v) point.push_back(v);
    complex.require_edges();
    complex.require_faces();
    parts.let_grow(complex);
  }
  static CellComplex imported(std::array<Index, 3> cells, std::vector<Vec3>& rows) {
    BoxOptions box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.cells[a] = cells[a];
      box.size[a] = cells[a];
    }
    Diagnostics diagnostics;
    Imported result = import_mesh(make_box(box), {}, diagnostics);
    rows = std::move(result.rest);
    return std::move(result.complex);
  }

  BladeCut cut(const PlanePatch& patch) { return cut(PlaneBlade(patch)); }
  BladeCut cut(const Blade& blade) {
    BladeCut cut = cut_along(complex, parts.parts(), rows[0].data(), blade, 3);
    if (cut.empty()) return cut;
    const TopologyChange change = complex.clone_volume(cut.cloning);
    parts.refine(cut.refined);
    parts.append(cut.parts, cut.cloning.origins);
    parts.coarsen(complex, cut.parts.elements, most);
    parts.coarsen(complex, cut.refined.parts.elements, most);
    follow(change);
    if (!cut.seams.empty()) sew(cut.seams);
    return cut;
  }
  /// Makes one of all parts of an element that are wanted.
  void sew_parts(const std::vector<std::uint8_t>& is_wanted) {
    const Reunion reunion =
        reunite(complex, parts.parts(), point, divided_groups(complex, origin, is_wanted));
    const TopologyChange change = complex.clone_volume(reunion.cloning);
    parts.append(reunion.parts, reunion.cloning.origins);
    parts.join(reunion.cloning.seams);
    parts.coarsen(complex, reunion.parts.elements, 0);
    follow(change);
    sew(reunion.seams);
  }
  void sew(const std::vector<Seam>& seams) {
    SeamBatch batch(complex);
    for (const Seam& seam : seams) EXPECT_FALSE(batch.add(seam));
    parts.join(batch.seams());
    std::vector<Index> elements;
    for (const auto& [one, other] : batch.seams())
      elements.insert(elements.end(), {element_of(one), element_of(other)});
    parts.coarsen(complex, elements, 0);
    follow(complex.sew(batch.seams()));
  }
  void remove(const std::vector<Index>& elements) { follow(complex.pierce(elements)); }
  void follow(const TopologyChange& change) {
    for (const Split& split : change.splits[0]) {
      rows.push_back(Vec3(rows[split.old_cell]));
      point.push_back(Index{point[split.old_cell]});
    }
    for (const Split& copy : change.copies) origin.push_back(Index{origin[copy.old_cell]});
    islands.update(complex, change);
    parts.follow(complex, change);
  }

  const PartMoments* part(Index element) const {
    const std::size_t place = position_in(parts.parts().elements, element);
    return place < parts.parts().elements.size() ? &parts.parts().moments[place] : nullptr;
  }
  double volume() const {
    double sum = 0;
    for (Index e = 0; e < complex.element_count(); ++e)
      if (complex.exists(3, e)) sum += part(e) ? part(e)->fraction : 1;
    return sum;
  }
  Vec3 place(const Embedding& embedding, Index p) const {
    Vec3 at{};
    for (std::size_t c = 0; c < 3; ++c) at[c] = embedding.points.value(p, rows[0].data(), 3, c);
    return at;
  }
  Vec3 place(const EmbeddedPoint& of) const {
    return place_in(complex.vertices_of(of.element), of.at, rows[0].data(), 3);
  }
};

/// Map and islands.
inline void expect_valid(const CutBox& box) {
  ASSERT_NO_THROW(box.complex.validate());
  ASSERT_NO_THROW(box.islands.validate(box.complex));
}

/// The first side of a triangle that is not that of another one, run in the other direction.
inline std::optional<std::pair<Index, Index>> open_side(const Embedding& embedding) {
  std::map<std::pair<Index, Index>, int> sides;
  for (const auto& t : embedding.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = t[i], b = t[(i + 1) % 3];
      sides[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  const auto open = std::ranges::find_if(sides, [](const auto& side) { return side.second != 0; });
  if (open == sides.end()) return {};
  return open->first;
}

inline void expect_closed(const Embedding& embedding) {
  const auto open = open_side(embedding);
  ASSERT_FALSE(open) << "the side from " << open->first << " to " << open->second << " is open";
}

inline double surface_volume(const CutBox& box, const Embedding& embedding) {
  double sum = 0;
  for (const auto& [a, b, c] : embedding.triangles)
    sum +=
        dot(box.place(embedding, a), cross(box.place(embedding, b), box.place(embedding, c))) / 6;
  return sum;
}

inline double lip_area(const CutBox& box, const Embedding& embedding) {
  double sum = 0;
  for (std::size_t t = 0; t < embedding.triangles.size(); ++t) {
    if (embedding.is_laid_open[t] == 0) continue;
    const auto& [a, b, c] = embedding.triangles[t];
    const Vec3 p = box.place(embedding, a);
    const Vec3 n = cross(minus(box.place(embedding, b), p), minus(box.place(embedding, c), p));
    sum += std::sqrt(dot(n, n)) / 2;
  }
  return sum;
}

}  // namespace suture::test
