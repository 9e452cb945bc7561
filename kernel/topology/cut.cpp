// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {

namespace {

using namespace incidence;

/// In a link during a cut: it goes.
constexpr Link leaving = 0x80000000u;

/// Sets the bit of cell i; true if it was not set.
bool mark(std::vector<std::uint64_t>& marks, Index i) {
  std::uint64_t& word = marks[i / 64];
  const std::uint64_t bit = std::uint64_t{1} << (i % 64);
  const bool fresh = !(word & bit);
  word |= bit;
  return fresh;
}

void unmark(std::vector<std::uint64_t>& marks, const std::vector<Index>& marked) {
  for (const Index i : marked) marks[i / 64] = 0;
}

/// Room for what a cut through regular elements reports; only touched pages take memory.
void reserve(TopologyChange& change, int dimension, std::size_t faces) {
  const std::size_t cells = dimension == 1 ? 5 : 3, darts = dimension == 2 ? 2 : 9;
  change.splits[dimension].reserve(cells * faces / 2 + 8);
  change.stars[dimension].cells.reserve(cells * faces + 16);
  change.stars[dimension].offsets.reserve(cells * faces + 17);
  change.stars[dimension].darts.reserve(darts * faces + 64);
}

void insertion_sort(Place* begin, Place* end) {
  for (Place* i = begin + 1; i < end; ++i) {
    const Place value = *i;
    Place* to = i;
    for (; to > begin && to[-1] > value; --to) *to = to[-1];
    *to = value;
  }
}

}  // namespace

/// The elements around one cell, in components.
struct CellComplex::StarFlood {
  struct Component {
    std::uint32_t begin, end;  ///< in places
  };
  std::vector<Place> places;
  std::vector<Component> components;
  std::vector<Place> beyond;  ///< across links that leave

  /// Components in order of their smallest elements, each ascending.
  void sort() {
    for (const Component& c : components) {
      Place* const first = places.data() + c.begin;
      if (c.end - c.begin < 24)
        insertion_sort(first, places.data() + c.end);
      else
        std::sort(first, places.data() + c.end);
    }
    const auto smallest = [&](const Component& c) { return places[c.begin]; };
    if (components.size() == 2) {
      if (smallest(components[1]) < smallest(components[0]))
        std::swap(components[0], components[1]);
    } else {
      std::ranges::sort(components, {}, smallest);
    }
  }
};

template <>
inline Index& CellComplex::label<0>(Place place) {
  return vertices_[place >> 4][place & 15];
}
template <>
inline Index& CellComplex::label<1>(Place place) {
  return edges_[place >> 4][place & 15];
}

/*        before                            after
 *
 *    v-------w-------v'              v-------w     w'-------v'
 *    |   e   F   g   |               |   e   F     G   g    |
 *    |       |       |               |        \   /         |
 *    |- - - -u- - - -|    cut F      |- - - - - u - - - - - |
 *    |   e'  |   g'  |   -------->   |   e'     |     g'    |
 *    +-------+-------+               +----------+-----------+
 *
 *   beta3 joins F and G              beta3(F) = beta3(G) = none
 *
 * w splits: without F the elements around it form two components. u does not: its
 * elements still hang together below. Only elements around the vertices and edges of
 * the cut faces are looked at.
 */
TopologyChange CellComplex::cut(std::span<const Dart> faces) {
  const std::vector<Dart> cut_faces = mark_leaving(faces);
  TopologyChange change;
  change.faces_cut = static_cast<Index>(cut_faces.size());
  split_cells<0>(cut_faces, change);
  if (has_edges()) split_cells<1>(cut_faces, change);
  split_faces(cut_faces, change);
  return change;
}

/// Marks the links that the cut removes; returns the smallest dart of each cut face,
/// ascending: from here on the order of the request is forgotten.
std::vector<Dart> CellComplex::mark_leaving(std::span<const Dart> faces) {
  for (const Dart d : faces)
    if (!can_cut(d))
      throw TopologyError(d / 24 < element_count()
                              ? "face " + std::to_string(d % 24 / 4) + " of element " +
                                    std::to_string(d / 24) +
                                    " is on the boundary: only a face between two elements can "
                                    "be cut"
                              : "dart " + std::to_string(d) + " does not exist: the map has " +
                                    std::to_string(element_count()) + " elements");
  std::vector<Dart> result;
  result.reserve(faces.size());
  for (const Dart d : faces) {
    const Link link = links_[d / 4];
    if (link & leaving) continue;  // the same face again
    const Dart other = incidence::dart_of(link) & ~3u;
    links_[d / 4] |= leaving;
    links_[other / 4] |= leaving;
    result.push_back(std::min(d & ~3u, other));
  }
  if (!std::ranges::is_sorted(result)) {
    std::vector<Dart> spare;
    radix_sort(result, spare, [](Dart d) { return d; });
  }
  return result;
}

/// Splits the vertices (dimension 0) or edges (1) of the cut faces where their
/// elements no longer hang together.
template <int Dimension>
void CellComplex::split_cells(std::span<const Dart> cut_faces, TopologyChange& change) {
  reserve(change, Dimension, cut_faces.size());
  Stars& stars = change.stars[Dimension];
  const Index old_count = count(Dimension);
  cell_marks_.resize(std::max(cell_marks_.size(), old_count / std::size_t{64} + 1));
  StarFlood flood;
  std::vector<Index> touched;
  touched.reserve(2 * cut_faces.size() + 16);
  for (const Dart face : cut_faces)
    for (Dart d = face; d < face + 4; ++d) {
      const Place start = place_of<Dimension>(d);
      const Index cell = label<Dimension>(start);
      if (cell >= old_count || !mark(cell_marks_, cell)) continue;  // done at another face
      touched.push_back(cell);
      flood_star<Dimension>(start, cell, flood);
      if (flood.components.size() == 1) {
        for (const Place place : flood.places) label<Dimension>(place) = cell;
        continue;
      }
      flood.sort();
      Index id = cell;
      for (const StarFlood::Component& component : flood.components) {
        if (id != cell) {
          some_dart_[Dimension].push_back(dart_at<Dimension>(flood.places[component.begin]));
          change.splits[Dimension].push_back({cell, id});
        }
        stars.cells.push_back(id);
        for (std::uint32_t i = component.begin; i < component.end; ++i) {
          const Place place = flood.places[i];
          label<Dimension>(place) = id;
          stars.darts.push_back(dart_at<Dimension>(place));
          if (mark(element_marks_, place >> 4)) change.elements.push_back(place >> 4);
        }
        stars.offsets.push_back(static_cast<Index>(stars.darts.size()));
        id = count(Dimension);
      }
    }
  unmark(cell_marks_, touched);
}

/// Finds all elements around the cell as it was before the cut, through links that
/// stay as one component, across links that leave into further ones. What has been
/// reached carries the label `none`.
template <int Dimension>
void CellComplex::flood_star(Place start, Index cell, StarFlood& flood) {
  flood.places.clear();
  flood.components.clear();
  flood.beyond.clear();
  flood.beyond.push_back(start);
  std::uint32_t next = 0;
  while (!flood.beyond.empty()) {
    const Place first = flood.beyond.back();
    flood.beyond.pop_back();
    if (label<Dimension>(first) != cell) continue;
    label<Dimension>(first) = none;
    flood.places.push_back(first);
    const std::uint32_t begin = next;
    for (; next < flood.places.size(); ++next) {
      const Place here = flood.places[next];
      const Link* const links = links_.data() + std::size_t{6} * (here >> 4);
      for (const Exit exit : exits<Dimension>[here & 15]) {
        const Link link = links[exit.face];
        if (link == none) continue;
        const Place there =
            (link & ~leaving) >> 5 << 4 | across<Dimension>[link & 31][exit.position];
        if (label<Dimension>(there) != cell) continue;
        if (link & leaving) {
          flood.beyond.push_back(there);
        } else {
          label<Dimension>(there) = none;
          flood.places.push_back(there);
        }
      }
    }
    flood.components.push_back({begin, next});
  }
}

/// Unlinks. A cut face becomes two faces; that of the smallest dart keeps the number.
void CellComplex::split_faces(std::span<const Dart> cut_faces, TopologyChange& change) {
  if (has_faces()) reserve(change, 2, cut_faces.size());
  for (const Dart first : cut_faces) {
    const Link link = links_[first / 4] & ~(leaving | 3u);
    const Dart second = incidence::dart_of(link);
    links_[first / 4] = links_[second / 4] = none;
    for (const Index e : {first / 24, link >> 5})
      if (mark(element_marks_, e)) change.elements.push_back(e);
    if (!has_faces()) continue;
    const Index old_id = face(first), new_id = count(2);
    some_dart_[2].push_back(second);
    faces_[link >> 5][(link & 31) / 4] = new_id;
    change.splits[2].push_back({old_id, new_id});
    Stars& stars = change.stars[2];
    for (const auto [id, dart] : {std::pair{old_id, first}, std::pair{new_id, second}}) {
      stars.cells.push_back(id);
      stars.darts.push_back(dart);
      stars.offsets.push_back(static_cast<Index>(stars.darts.size()));
    }
  }
  unmark(element_marks_, change.elements);
  std::vector<Index> spare;
  radix_sort(change.elements, spare, [](Index e) { return e; });
}

}  // namespace suture
