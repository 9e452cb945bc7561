// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>

#include "kernel/base/error.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/incidence.hpp"
#include "kernel/topology/marks.hpp"
#include "kernel/topology/regular_star.hpp"

namespace suture {

using namespace incidence;
using namespace marks;

namespace {

void sort_ascending(std::vector<Index>& values) {
  if (std::ranges::is_sorted(values)) return;
  std::vector<Index> spare;
  radix_sort(values, spare, [](Index value) { return value; });
}

/// Whether what is left of a star is connected. Bit i of `left`: the i-th element
/// above stays, bit n + i: the one below. Also false where this is not as easily decided.
template <int Dimension>
bool is_connected(unsigned left, unsigned n, bool closed);

/// The elements form a prism: a ring above, one below, and the faces between them.
template <>
bool is_connected<0>(unsigned left, unsigned n, bool closed) {
  const unsigned ring = (1u << n) - 1;
  if (std::popcount(left) + 1u == 2 * n) return true;  // one element less parts nothing
  if (!closed) return false;
  const auto beside = [&](unsigned x) {
    return (x << 1 | x >> (n - 1) | x >> 1 | x << (n - 1)) & ring;
  };
  unsigned reached = left & -left;
  for (unsigned before = 0; reached != before;) {
    before = reached;
    const unsigned above = reached & ring, below = reached >> n;
    reached |= (beside(above) | below) | (beside(below) | above) << n;
    reached &= left;
  }
  return reached == left;
}

/// The elements form a path above 1, above 0, below 0, below 1, or a ring.
template <>
bool is_connected<1>(unsigned left, unsigned n, bool closed) {
  if (n == 1) return true;
  const unsigned path = (left >> 1 & 1) | (left & 1) << 1 | (left & 12);
  const auto is_run = [](unsigned x) { return ((x + (x & -x)) & x) == 0; };
  return is_run(path) || (closed && is_run(15 & ~path));
}

}  // namespace

/*        before                             after
 *
 *    +-------v-------+                +-------v - - - +
 *    |   a   |   e   |                |   a   |         .
 *    |       |       |                |       F         .
 *    +-------u-------w   pierce e     +-------u - - - - +
 *    |   b   F'  c   |  --------->    |   b   F'  c     |
 *    |       |       |                |       |         |
 *    +-------+-------+                +-------+---------w
 *
 * The face F between a and e stays, on the boundary. A cell whose last element was e
 * (the corner beyond v and w) is removed. Around every other cell of e the elements
 * left are flooded as in a cut, where e counts as a component that is then forgotten:
 * u stays whole because a, b and c are connected. If b had been removed before, a and
 * c would part at u.
 */
TopologyChange CellComplex::pierce(std::span<const Index> elements) {
  const std::vector<Index> removed = mark_removed(elements);
  has_operated_ = true;
  const std::vector<Link> rim = mark_rim(removed);
  TopologyChange change;
  change.faces_cut = static_cast<Index>(rim.size());
  split_cells<Loss::elements>(rim, change);
  free_rim(rim, change);
  for (const Index e : removed) std::fill_n(links_.data() + std::size_t{6} * e, 6, none);
  remove_cells<0>(removed, change);
  if (has_edges()) remove_cells<1>(removed, change);
  if (has_faces()) remove_cells<2>(removed, change);
  holes_[3] += static_cast<Index>(removed.size());
  change.removed[3] = removed;
  return change;
}

/// Refuses what cannot go, then marks the rest; returns them ascending, each once.
std::vector<Index> CellComplex::mark_removed(std::span<const Index> elements) {
  for (const Index e : elements)
    if (e >= element_count() || !exists(3, e))
      throw TopologyError(
          "element " + std::to_string(e) +
          (e < element_count()
               ? " has already been removed"
               : " does not exist: the map has " + std::to_string(element_count()) + " elements") +
          "; only an existing element can be removed");
  std::vector<Index> removed(elements.begin(), elements.end());
  sort_ascending(removed);
  removed.erase(std::unique(removed.begin(), removed.end()), removed.end());
  if (!removed.empty() && removed.size() == existing(3))
    throw TopologyError("all " + std::to_string(removed.size()) +
                        " remaining elements would be removed; at least one must stay");
  removed_marks_.resize(element_count() / std::size_t{64} + 1);
  for (const Index e : removed) mark(removed_marks_, e);
  return removed;
}

/// Marks the links between elements that go and such that stay; returns the faces as
/// mark_leaving() does.
std::vector<Link> CellComplex::mark_rim(std::span<const Index> removed) {
  std::vector<Link> rim;
  for (const Index e : removed)
    for (unsigned f = 0; f < 6; ++f) {
      Link& link = links_[std::size_t{6} * e + f];
      if (link == none || is_removed(link >> 5)) continue;
      rim.push_back(std::min(link_of(e, 4 * f), link & ~3u));
      links_[side_of(link)] |= leaving;
      link |= leaving;
    }
  std::vector<Link> spare;
  radix_sort(rim, spare, [](Link l) { return l; });
  return rim;
}

/// Unlinks. The face stays with the element that stays.
void CellComplex::free_rim(std::span<const Link> rim, TopologyChange& change) {
  Stars& stars = change.stars[2];
  for (const Link first : rim) {
    const Link second = links_[side_of(first)] & ~(leaving | 3u);
    const bool first_goes = is_removed(first >> 5);
    const Link stays = first_goes ? second : first, goes = first_goes ? first : second;
    links_[side_of(stays)] = none;
    if (mark(element_marks_, stays >> 5)) change.elements.push_back(stays >> 5);
    if (!has_faces()) continue;
    faces_[goes >> 5][(goes & 31) / 4] = none;
    const Index id = faces_[stays >> 5][(stays & 31) / 4];
    first_dart_[2][id] = incidence::dart_of(stays);
    *stars.append(id, 1) = incidence::dart_of(stays);
  }
  unmark(element_marks_, change.elements);
  sort_ascending(change.elements);
}

/// Most stars can be read directly and stay in one piece: drops their removed elements and
/// reports the others. Returns false, without any change, for any other star.
template <int Dimension>
bool CellComplex::lose_elements(Index cell, HalfStars& halves, TopologyChange& change) {
  const std::size_t n = halves.size;
  std::array<LocalCell, 2 * HalfStars::max_size> places;
  unsigned left = 0;
  for (std::size_t i = 0; i < n; ++i) {
    places[i] = halves.above[i];
    places[n + i] = halves.below[i];
  }
  for (std::size_t i = 0; i < 2 * n; ++i) left |= unsigned{!is_removed(places[i] >> 4)} << i;
  if (!is_connected<Dimension>(left, static_cast<unsigned>(n), halves.closed)) return false;
  sort_local_cells(places.data(), places.data() + 2 * n);
  if (std::adjacent_find(places.data(), places.data() + 2 * n) != places.data() + 2 * n)
    return false;
  auto* const label = rows<Dimension>();
  Stars& stars = change.stars[Dimension];
  const std::size_t first = stars.darts.size();
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const LocalCell place = places[i];
    if (is_removed(place >> 4)) {
      label[place >> 4][place & 15] = none;
    } else {
      stars.darts.push_back(dart_at<Dimension>(place));
      if (mark(element_marks_, place >> 4)) change.elements.push_back(place >> 4);
    }
  }
  first_dart_[Dimension][cell] = stars.darts[first];
  stars.cells.push_back(cell);
  stars.offsets.push_back(static_cast<Index>(stars.darts.size()));
  return true;
}

template bool CellComplex::lose_elements<0>(Index, HalfStars&, TopologyChange&);
template bool CellComplex::lose_elements<1>(Index, HalfStars&, TopologyChange&);

/// What still carries a number in an element that goes had no other element.
template <int Dimension>
void CellComplex::remove_cells(std::span<const Index> elements, TopologyChange& change) {
  std::vector<Index>& removed = change.removed[Dimension];
  auto* const label = rows<Dimension>();
  for (const Index e : elements)
    for (Index& id : label[e]) {
      if (id != none && first_dart_[Dimension][id] != none) {
        first_dart_[Dimension][id] = none;
        removed.push_back(id);
      }
      id = none;
    }
  holes_[Dimension] += static_cast<Index>(removed.size());
  sort_ascending(removed);
}

}  // namespace suture
