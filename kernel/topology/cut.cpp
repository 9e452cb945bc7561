// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/incidence.hpp"
#include "kernel/topology/marks.hpp"
#include "kernel/topology/regular_star.hpp"

namespace suture {

namespace {

using namespace incidence;
using namespace marks;

/// Room for what a cut through regular elements reports; only touched pages take memory.
void reserve(TopologyChange& change, int dimension, std::size_t faces) {
  const std::size_t cells = dimension == 1 ? 5 : 3, darts = dimension == 2 ? 2 : 9;
  change.splits[dimension].reserve(cells * faces / 2 + 8);
  change.stars[dimension].cells.reserve(cells * faces + 16);
  change.stars[dimension].offsets.reserve(cells * faces + 17);
  change.stars[dimension].darts.reserve(darts * faces + 64);
}

/// As they are, where nothing is to be done.
template <class Values>
Values sorted(Values values) {
  if (std::ranges::is_sorted(values)) return values;
  Values spare;
  radix_sort(values, spare, [](std::uint32_t value) { return value; });
  return values;
}

}  // namespace

/// The elements around one cell, in components.
struct CellComplex::StarFlood {
  struct Component {
    std::uint32_t begin, end;  ///< in places
  };
  std::vector<LocalCell> places = std::vector<LocalCell>(64);  ///< those below `reached` count
  std::uint32_t reached = 0;
  std::vector<Component> components;
  std::vector<LocalCell> beyond;  ///< across links that leave

  /// Forgets the components of elements that go.
  template <class IsRemoved>
  void drop(const IsRemoved& removed) {
    std::erase_if(components, [&](const Component& c) { return removed(places[c.begin] >> 4); });
    reached = 0;
    for (const Component& c : components) reached += c.end - c.begin;
  }

  /// Components in order of their smallest elements, each ascending.
  void sort() {
    for (const Component& c : components) {
      LocalCell* const first = places.data() + c.begin;
      if (c.end - c.begin < 24)
        sort_local_cells(first, places.data() + c.end);
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

/// What split_cells() keeps from cell to cell.
struct CellComplex::StarWork {
  StarFlood flood{};
  HalfStars halves{};
  std::array<Index, 2> old_count;               ///< of vertices, edges
  std::array<std::vector<Index>, 2> touched{};  ///< and marked, but those that split in halves
};

void CellComplex::make_room(Index faces, Index largest) {
  const std::array<Index, 3> cells = cells_of_cut(faces);
  const auto touch = [](auto& items) { suture::make_room(items, items.capacity() - items.size()); };
  TopologyChange change;  // the cut gets its memory, which is kept when it is released
  for (int d = 0; d < 3; ++d) {
    if (count(d) == 0) continue;
    suture::make_room(first_dart_[d], cells[d]);
    reserve(change, d, largest + largest / 8);  // a body that moves is cut in other places
    touch(change.splits[d]);
    touch(change.stars[d].cells);
    touch(change.stars[d].offsets);
    touch(change.stars[d].darts);
  }
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
 * elements are still connected below. Only elements around the vertices and edges of
 * the cut faces are examined.
 */
TopologyChange CellComplex::cut(std::span<const Dart> faces) {
  const BulkVector<Link> cut_faces = mark_leaving(faces);
  has_operated_ = true;
  TopologyChange change;
  change.faces_cut = static_cast<Index>(cut_faces.size());
  split_cells<Loss::links>(cut_faces, change);
  split_faces(cut_faces, change);
  return change;
}

/// Marks the links that the cut removes; returns each cut face as the first dart of
/// its smaller side, ascending: from here on the order of the request is forgotten.
BulkVector<Link> CellComplex::mark_leaving(std::span<const Dart> faces) {
  for (const Dart d : faces)
    if (!can_cut(d))
      throw TopologyError(
          d / 24 < element_count()
              ? "face " + std::to_string(d % 24 / 4) + " of element " + std::to_string(d / 24) +
                    (exists(3, d / 24) ? " is on the boundary"
                                       : " does not exist: its element was removed") +
                    "; only a face between two elements can be cut"
              : "dart " + std::to_string(d) + " does not exist: the map has " +
                    std::to_string(element_count()) + " elements");
  BulkVector<Link> result;
  result.reserve(faces.size());
  for (const Dart d : faces) {
    Link& link = links_[d / 4];
    if (link & leaving) continue;  // the same face again
    const Link here = link_of(d / 24, d % 24 & ~3u), there = link & ~3u;
    link |= leaving;
    links_[side_of(there)] |= leaving;
    result.push_back(std::min(here, there));
  }
  return sorted(std::move(result));
}

/// Splits the vertices and edges of the cut faces where their elements are no longer
/// connected. If elements are removed, they leave their cells, and what is left of these is
/// reported even if it stays in one piece.
template <CellComplex::Loss What>
void CellComplex::split_cells(std::span<const Link> cut_faces, TopologyChange& change) {
  StarWork work;
  work.old_count = {count(0), count(1)};
  for (int d = 0; d < 2; ++d) {
    if (count(d) == 0) continue;
    reserve(change, d, cut_faces.size());
    cell_marks_[d].resize(std::max(cell_marks_[d].size(), count(d) / std::size_t{64} + 1));
  }
  const bool edges = has_edges();
  for (const Link face : cut_faces)
    for (Link dart = face; dart < face + 4; ++dart) {
      split_cell<0, What>(dart, work, change);
      if (edges) split_cell<1, What>(dart, work, change);
    }
  for (int d = 0; d < 2; ++d) {
    unmark(cell_marks_[d], work.touched[d]);
    for (const Split& split : change.splits[d]) cell_marks_[d][split.old_cell / 64] = 0;
  }
}

template void CellComplex::split_cells<CellComplex::Loss::elements>(std::span<const Link>,
                                                                    TopologyChange&);

/// The vertex where the dart begins, or the edge that it is on, unless that has been
/// done at another face.
template <int Dimension, CellComplex::Loss What>
void CellComplex::split_cell(Link dart, StarWork& work, TopologyChange& change) {
  auto* const label = rows<Dimension>();
  const LocalCell start = dart >> 5 << 4 | local_of<Dimension>(static_cast<int>(dart & 31));
  const Index cell = label[start >> 4][start & 15];
  if (cell >= work.old_count[Dimension] || !mark(cell_marks_[Dimension], cell)) return;
  if (What == Loss::links && half_stars<Dimension>(links_.data(), dart, work.halves))
    return split_in_halves<Dimension>(cell, work.halves, change);
  work.touched[Dimension].push_back(cell);
  if (What == Loss::elements &&
      half_stars<Dimension, Surface::any>(links_.data(), dart, work.halves) &&
      lose_elements<Dimension>(cell, work.halves, change))
    return;
  StarFlood& flood = work.flood;
  flood_star<Dimension>(start, cell, flood);
  if constexpr (What == Loss::elements) {
    flood.drop([this](Index e) { return is_removed(e); });
    flood.sort();
    first_dart_[Dimension][cell] = dart_at<Dimension>(flood.places[flood.components.front().begin]);
    name_components<Dimension>(cell, flood, change);
  } else if (flood.components.size() > 1) {
    flood.sort();
    name_components<Dimension>(cell, flood, change);
  } else {
    for (std::uint32_t i = 0; i < flood.reached; ++i)
      label[flood.places[i] >> 4][flood.places[i] & 15] = cell;
  }
}

/// The cell splits in two; the half with the smallest element keeps the number.
template <int Dimension>
void CellComplex::split_in_halves(Index cell, HalfStars& halves, TopologyChange& change) {
  auto* const label = rows<Dimension>();
  const std::size_t size = halves.size;
  LocalCell *kept = halves.above.data(), *leaves = halves.below.data();
  sort_local_cells(kept, kept + size);
  sort_local_cells(leaves, leaves + size);
  if (leaves[0] < kept[0]) std::swap(kept, leaves);
  const Index id = count(Dimension);
  first_dart_[Dimension].push_back(dart_at<Dimension>(leaves[0]));
  change.splits[Dimension].push_back({cell, id});
  for (std::size_t i = 0; i < size; ++i) label[leaves[i] >> 4][leaves[i] & 15] = id;
  Stars& stars = change.stars[Dimension];
  std::transform(kept, kept + size, stars.append(cell, size), dart_at<Dimension>);
  std::transform(leaves, leaves + size, stars.append(id, size), dart_at<Dimension>);
  if (halves.cut_all) return;  // split_faces() finds them
  for (std::size_t i = 0; i < size; ++i)
    for (const LocalCell place : {kept[i], leaves[i]})
      if (mark(element_marks_, place >> 4)) change.elements.push_back(place >> 4);
}

/// Finds all elements around the cell as it was before the cut, through links that
/// stay as one component, across links that leave into further ones. What has been
/// reached carries the label `none`.
template <int Dimension>
void CellComplex::flood_star(LocalCell start, Index cell, StarFlood& flood) {
  auto* const label = rows<Dimension>();
  const Link* const all_links = links_.data();
  flood.components.clear();
  flood.beyond.assign(1, start);
  std::uint32_t next = 0, reached = 0;
  while (!flood.beyond.empty()) {
    const LocalCell first = flood.beyond.back();
    flood.beyond.pop_back();
    Index& id = label[first >> 4][first & 15];
    if (id != cell) continue;
    id = none;
    const std::uint32_t begin = next;
    flood.places[reached++] = first;
    for (; next < reached; ++next) {
      if (reached + 4 > flood.places.size()) flood.places.resize(2 * flood.places.size());
      LocalCell* const places = flood.places.data();
      const LocalCell here = places[next];
      const Link* const links = all_links + std::size_t{6} * (here >> 4);
      for (const Exit exit : exits<Dimension>[here & 15]) {
        const Link link = links[exit.face];
        if (link == none) continue;
        const int cell_there = across<Dimension>[link & 31][exit.position];
        const Index element_there = (link & ~leaving) >> 5;
        const LocalCell there = element_there << 4 | static_cast<LocalCell>(cell_there);
        Index& id_there = label[element_there][cell_there];
        const bool fresh = id_there == cell;
        if (link & leaving) {
          if (fresh) flood.beyond.push_back(there);
          continue;
        }
        // Without a branch: whether a neighbour was reached before is hard to predict.
        id_there = fresh ? none : id_there;
        places[reached] = there;
        reached += fresh;
      }
    }
    flood.components.push_back({begin, next});
  }
  flood.reached = reached;
}

/// The first component keeps the number of the cell, the others get new ones.
template <int Dimension>
void CellComplex::name_components(Index cell, const StarFlood& flood, TopologyChange& change) {
  auto* const label = rows<Dimension>();
  Stars& stars = change.stars[Dimension];
  Index id = cell;
  for (const StarFlood::Component& component : flood.components) {
    if (id != cell) {
      first_dart_[Dimension].push_back(dart_at<Dimension>(flood.places[component.begin]));
      change.splits[Dimension].push_back({cell, id});
    }
    Dart* darts = stars.append(id, component.end - component.begin);
    for (std::uint32_t i = component.begin; i < component.end; ++i) {
      const LocalCell place = flood.places[i];
      label[place >> 4][place & 15] = id;
      *darts++ = dart_at<Dimension>(place);
      if (mark(element_marks_, place >> 4)) change.elements.push_back(place >> 4);
    }
    id = count(Dimension);
  }
}

/// Unlinks. A cut face becomes two faces; that of the smaller side keeps the number.
void CellComplex::split_faces(std::span<const Link> cut_faces, TopologyChange& change) {
  if (has_faces()) reserve(change, 2, cut_faces.size());
  change.elements.reserve(change.elements.size() + cut_faces.size());
  for (const Link first : cut_faces) {
    Link& link = links_[side_of(first)];
    const Link second = link & ~(leaving | 3u);
    link = links_[side_of(second)] = none;
    if (mark(element_marks_, second >> 5)) change.elements.push_back(second >> 5);
    if (!has_faces()) continue;
    const Index old_id = faces_[first >> 5][(first & 31) / 4], new_id = count(2);
    faces_[second >> 5][(second & 31) / 4] = new_id;
    first_dart_[2].push_back(incidence::dart_of(second));
    change.splits[2].push_back({old_id, new_id});
    *change.stars[2].append(old_id, 1) = incidence::dart_of(first);
    *change.stars[2].append(new_id, 1) = incidence::dart_of(second);
  }
  unmark(element_marks_, change.elements);
  add_elements(cut_faces, change.elements);
}

/// The elements there are, in any order, and those of the smaller sides of the faces,
/// which are in order: joined, ascending, each once.
void CellComplex::add_elements(std::span<const Link> cut_faces, std::vector<Index>& elements) {
  const std::vector<Index> others = sorted(std::move(elements));
  elements.clear();
  elements.reserve(cut_faces.size() + others.size());
  auto other = others.begin();
  const auto add = [&](Index e) {
    while (other != others.end() && *other <= e) elements.push_back(*other++);
    if (elements.empty() || elements.back() != e) elements.push_back(e);
  };
  for (const Link face : cut_faces) add(face >> 5);
  elements.insert(elements.end(), other, others.end());
}

}  // namespace suture
