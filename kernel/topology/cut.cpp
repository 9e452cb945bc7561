// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {

/// A face as it was before the cut: a is its smallest dart, b = beta3(a).
struct CellComplex::CutFace {
  Dart a, b;

  /// Dart k of side a, or the dart of the same vertex or edge on side b.
  template <int Dimension>
  Dart side(int which, Dart k) const {
    return which == 0 ? a + k : incidence::landing<Dimension>((b & ~3u) | ((b - k) & 3u));
  }
};

template <>
inline Index& CellComplex::label<0>(Dart d) {
  return vertices_[d / 24][hexahedron::dart_vertex[d % 24]];
}
template <>
inline Index& CellComplex::label<1>(Dart d) {
  return edges_[d / 24][hexahedron::dart_edge[d % 24]];
}

/*        before                            after
 *
 *    v-------w-------v'              v-------w1    w2-------v'
 *    |   e   F   g   |               |   e   |F   G|   g    |
 *    |       |       |      cut F    |       |     |        |
 *    |- - - -w'- - - |   -------->   |- - - -w' - - - - - - |
 *    |       |       |               |       |              |
 *    +-------+-------+               +-------+--------------+
 *
 *   beta3 joins F and G              beta3(F) = beta3(G) = none
 *
 * w splits: without F the elements around it form two components. w' does not: they
 * still hang together below. Only the elements around the cut's own vertices and
 * edges are looked at.
 */
TopologyChange CellComplex::cut(std::span<const Dart> faces) {
  const std::vector<CutFace> cut_faces = unlink(faces);
  TopologyChange change;
  change.faces_cut = static_cast<Index>(cut_faces.size());
  split_cells<0>(cut_faces, change);
  if (has_edges()) split_cells<1>(cut_faces, change);
  if (has_faces()) split_faces(cut_faces, change);
  change.elements = elements_of(cut_faces, change.stars);
  return change;
}

/// Relinks, and returns each cut face once, in order of their smallest darts.
std::vector<CellComplex::CutFace> CellComplex::unlink(std::span<const Dart> faces) {
  for (const Dart d : faces)
    if (!can_cut(d))
      throw TopologyError(d / 24 < element_count()
                              ? "face " + std::to_string(d % 24 / 4) + " of element " +
                                    std::to_string(d / 24) +
                                    " is on the boundary: only a face between two elements can "
                                    "be cut"
                              : "dart " + std::to_string(d) + " does not exist: the map has " +
                                    std::to_string(element_count()) + " elements");
  std::vector<CutFace> result;
  result.reserve(faces.size());
  for (const Dart d : faces) {
    const Dart first = d & ~3u, mate = mates_[d / 4];
    if (mate == none) continue;  // the same face again
    const Dart other = mate & ~3u;
    result.push_back(first < other ? CutFace{first, mate} : CutFace{other, mates_[other / 4]});
    mates_[first / 4] = mates_[other / 4] = none;
  }
  const auto smallest = [](const CutFace& f) { return f.a; };
  if (!std::ranges::is_sorted(result, {}, smallest)) {
    std::vector<CutFace> spare;
    radix_sort(result, spare, smallest);
  }
  return result;
}

/// Splits the vertices (dimension 0) or edges (1) of the cut faces where their
/// elements no longer hang together. Every component that the cut has made touches
/// a cut face, so floods from both sides of those find them all; a flooded
/// incidence carries the label `none` until its component has got its number.
template <int Dimension>
void CellComplex::split_cells(std::span<const CutFace> cut_faces, TopologyChange& change) {
  using namespace incidence;
  struct Corner {
    Index cell, at;  // at: 4 * cut face + k
  };
  std::vector<Corner> corners, spare;
  corners.reserve(4 * cut_faces.size());
  for (Index i = 0; i < cut_faces.size(); ++i)
    for (Dart k = 0; k < 4; ++k)
      corners.push_back({label<Dimension>(cut_faces[i].a + k), 4 * i + k});
  radix_sort(corners, spare, [](const Corner& c) { return c.cell; });

  Stars& stars = change.stars[Dimension];
  std::vector<Dart> flooded;  // of all components of one cell
  std::vector<std::span<Dart>> components;
  std::vector<std::size_t> begin;
  for (auto first = corners.begin(); first != corners.end();) {
    const Index cell = first->cell;
    flooded.clear();
    begin.clear();
    auto last = first;
    for (; last != corners.end() && last->cell == cell; ++last)
      for (const int which : {0, 1}) {
        const Dart start = cut_faces[last->at / 4].template side<Dimension>(which, last->at % 4);
        if (label<Dimension>(start) != cell) continue;
        begin.push_back(flooded.size());
        label<Dimension>(start) = none;
        flooded.push_back(canonical<Dimension>(start));
        for (std::size_t next = begin.back(); next < flooded.size(); ++next) {
          const Dart local = flooded[next] % 24, base = flooded[next] - local;
          for (const auto exit : exits<Dimension>(local_cell<Dimension>(static_cast<int>(local)))) {
            const Dart mate = beta3(base + exit);
            if (mate == none) continue;
            const Dart there = landing<Dimension>(mate);
            if (label<Dimension>(there) != cell) continue;
            label<Dimension>(there) = none;
            flooded.push_back(canonical<Dimension>(there));
          }
        }
      }
    first = last;
    if (begin.size() == 1) {
      for (const Dart d : flooded) label<Dimension>(d) = cell;
      continue;
    }
    components.clear();
    begin.push_back(flooded.size());
    for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
      components.emplace_back(flooded.data() + begin[c], flooded.data() + begin[c + 1]);
      std::ranges::sort(components.back());
    }
    std::ranges::sort(components, {}, [](std::span<Dart> s) { return s[0]; });
    for (const std::span<Dart> component : components) {
      Index id = cell;
      if (component.data() != components[0].data()) {
        id = static_cast<Index>(some_dart_[Dimension].size());
        some_dart_[Dimension].push_back(component[0]);
        change.splits[Dimension].push_back({cell, id});
      }
      for (const Dart d : component) label<Dimension>(d) = id;
      stars.append(id, component);
    }
  }
}

/// A cut face becomes two faces; that of the smallest dart keeps the number.
void CellComplex::split_faces(std::span<const CutFace> cut_faces, TopologyChange& change) {
  for (const CutFace& f : cut_faces) {
    const Dart second = f.b & ~3u;
    const Index old_id = face(f.a), new_id = static_cast<Index>(some_dart_[2].size());
    some_dart_[2].push_back(second);
    faces_[second / 24][second % 24 / 4] = new_id;
    change.splits[2].push_back({old_id, new_id});
    change.stars[2].append(old_id, {&f.a, 1});
    change.stars[2].append(new_id, {&second, 1});
  }
}

std::vector<Index> CellComplex::elements_of(std::span<const CutFace> cut_faces,
                                            const std::array<Stars, 3>& stars) {
  std::vector<Index> elements, spare;
  const auto add = [&](Index e) {
    std::uint64_t& word = marks_[e / 64];
    const std::uint64_t bit = std::uint64_t{1} << (e % 64);
    if (word & bit) return;
    word |= bit;
    elements.push_back(e);
  };
  for (const CutFace& f : cut_faces) {
    add(f.a / 24);
    add(f.b / 24);
  }
  for (const Stars& s : stars)
    for (const Dart d : s.darts) add(d / 24);
  for (const Index e : elements) marks_[e / 64] = 0;
  radix_sort(elements, spare, [](Index e) { return e; });
  return elements;
}

}  // namespace suture
