// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <functional>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/incidence.hpp"
#include "kernel/topology/marks.hpp"

namespace suture {

using namespace incidence;
using namespace marks;

namespace {

Dart in_element(Index element, Dart dart) { return 24 * element + dart % 24; }

/// The elements that are replaced or absorbed, and the copies of the former.
class Origins {
 public:
  Origins(const Cloning& cloning, Index elements)
      : origins_(cloning.origins), elements_(elements), marks_(elements / std::size_t{64} + 1) {
    for (const Index e : origins_) mark(marks_, e);
    for (const Split& absorbed : cloning.absorbed) mark(marks_, absorbed.old_cell);
  }
  bool contains(Index element) const { return marks_[element / 64] >> element % 64 & 1; }
  /// Calls visit(copy) for each copy of an element.
  template <class Visit>
  void for_copies(Index element, Visit visit) const {
    const auto first = std::ranges::lower_bound(origins_, element);
    for (auto at = first; at != origins_.end() && *at == element; ++at)
      visit(elements_ + static_cast<Index>(at - origins_.begin()));
  }
  /// The dart of which a dart in the new numbers is a copy, or the dart itself.
  Dart origin(Dart dart) const {
    const Index element = dart / 24;
    return element < elements_ ? dart : in_element(origins_[element - elements_], dart);
  }
  Index count_with_copies() const { return elements_ + static_cast<Index>(origins_.size()); }

 private:
  std::span<const Index> origins_;
  Index elements_;
  std::vector<std::uint64_t> marks_;
};

std::string seam_text(const Seam& seam) {
  return "darts " + std::to_string(seam.one) + " and " + std::to_string(seam.other);
}

}  // namespace

std::vector<Split> TopologyChange::successors() const {
  std::vector<Split> all = copies;
  all.insert(all.end(), absorbed.begin(), absorbed.end());
  std::ranges::stable_sort(all, {}, &Split::old_cell);
  return all;
}

/// The cells around which elements are replaced or faces cut, and the elements around each
/// afterwards, ascending.
struct CellComplex::ClonedStars {
  std::vector<Index> cells;
  std::vector<std::size_t> offsets{0};
  std::vector<LocalCell> places;
  std::vector<std::uint8_t> has_lost;  ///< by cell: an element without a copy
};

/*        before                  after, e in two parts, of which one touches g
 *
 *    +-------w-------+             +-------w     w'------+
 *    |       | \     |             |   c   |   / |   d   |      c, d: copies of e, with all its
 *    |   g   |  \ e  |             |   g   |     |       |      vertices each; w' is new
 *    |       |   \   |    ---->    |       |     |       |
 *    +-------u-------+             +-------u     u'------+
 *
 *   beta3 joins g and e            beta3 joins g and c
 *
 * The elements around each cell of e are known before: those of its star, with copies for e. Once
 * the links are those of the copies, a flood fill finds which of them are still connected.
 */
TopologyChange CellComplex::clone_volume(const Cloning& cloning) {
  if (const std::string reason = why_no_cloning(cloning); !reason.empty())
    throw TopologyError(reason);
  const ClonedStars vertices = stars_of_clones<0>(cloning);
  const ClonedStars edges = has_edges() ? stars_of_clones<1>(cloning) : ClonedStars{};
  const ClonedStars faces = has_faces() ? stars_of_clones<2>(cloning) : ClonedStars{};
  has_operated_ = true;
  const Index first_copy = element_count();
  append_copies(cloning.origins);
  relink(cloning);
  TopologyChange change;
  split_clones<0>(vertices, first_copy, change);
  split_clones<1>(edges, first_copy, change);
  split_clones<2>(faces, first_copy, change);
  unmark(element_marks_, change.elements);
  std::ranges::sort(change.elements);
  change.faces_cut = static_cast<Index>(cloning.cut.size());
  for (Index i = 0; i < cloning.origins.size(); ++i)
    change.copies.push_back({cloning.origins[i], first_copy + i});
  change.absorbed = cloning.absorbed;
  remove_origins(cloning, change);
  return change;
}

/// Empty if the cloning is possible.
std::string CellComplex::why_no_cloning(const Cloning& cloning) const {
  const auto& origins = cloning.origins;
  if (element_count() + origins.size() > max_elements)
    return "the map would have " + std::to_string(element_count() + origins.size()) +
           " elements; it can address at most " + std::to_string(max_elements);
  for (const Index e : origins)
    if (e >= element_count() || !exists(3, e))
      return "element " + std::to_string(e) + " does not exist; only an existing one can be copied";
  for (const auto& [element, copy] : cloning.absorbed)
    if (element >= element_count() || !exists(3, element) || copy < element_count() ||
        copy - element_count() >= origins.size() || std::ranges::binary_search(origins, element))
      return "element " + std::to_string(element) + " cannot be absorbed by element " +
             std::to_string(copy) + "; only an existing one that is not copied by a copy can";
  if (!std::ranges::is_sorted(origins)) return "the elements to copy are not in ascending order";
  if (!std::ranges::is_sorted(cloning.absorbed, std::less_equal<>(), &Split::old_cell))
    return "the elements to absorb are not in ascending order";
  const Origins cloned(cloning, element_count());
  std::vector<std::uint8_t> listed(cloned.count_with_copies());  // by element, a bit per face
  const auto list = [&](Dart d) {
    const auto bit = static_cast<std::uint8_t>(1u << d % 24 / 4);
    return (std::exchange(listed[d / 24], listed[d / 24] | bit) & bit) == 0;
  };
  const auto twice = [](Dart d) {
    return "the face of dart " + std::to_string(d & ~3u) + " is listed twice";
  };
  for (const Seam& seam : cloning.seams) {
    const auto may_join = [&](Dart d) {
      return d / 24 < cloned.count_with_copies() &&
             (d / 24 >= element_count() || !cloned.contains(d / 24));
    };
    if (!may_join(seam.one) || !may_join(seam.other) ||
        (seam.one / 24 < element_count() && seam.other / 24 < element_count()) ||
        beta3(cloned.origin(seam.one)) != cloned.origin(seam.other))
      return seam_text(seam) + " join faces that are not joined before the copies are made";
    for (const Dart d : {seam.one, seam.other})
      if (!list(d)) return twice(d);
  }
  for (const Dart d : cloning.cut) {
    if (!can_cut(d) || cloned.contains(d / 24) || cloned.contains(beta3(d) / 24))
      return "dart " + std::to_string(d) + " is not on a face between two elements that stay";
    for (const Dart side : {d, beta3(d)})
      if (!list(side)) return twice(side);
  }
  return {};
}

template <int Dimension>
CellComplex::ClonedStars CellComplex::stars_of_clones(const Cloning& cloning) const {
  ClonedStars stars;
  const Origins cloned(cloning, element_count());
  std::vector<std::uint64_t> marks(count(Dimension) / std::size_t{64} + 1);
  const auto mark_cells = [&](Index e) {
    for (LocalCell i = 0; i < cells<Dimension>; ++i)
      mark(marks, cell(Dimension, dart_at<Dimension>(e << 4 | i)));
  };
  std::ranges::for_each(cloning.origins, mark_cells);
  for (const Split& absorbed : cloning.absorbed) mark_cells(absorbed.old_cell);
  for (const Dart d : cloning.cut)
    for (Dart side = d & ~3u; side < (d & ~3u) + 4; ++side) mark(marks, cell(Dimension, side));
  stars.cells = marked(marks);
  std::vector<Dart> star;
  for (const Index cell : stars.cells) {
    collect_star<Dimension>(first_dart_[Dimension][cell], star);
    const std::size_t first = stars.places.size();
    bool has_lost = false;
    for (const Dart d : star) {
      const LocalCell place = local_cell_of<Dimension>(d);
      const std::size_t before = stars.places.size();
      if (cloned.contains(place >> 4))
        cloned.for_copies(place >> 4,
                          [&](Index copy) { stars.places.push_back(copy << 4 | (place & 15)); });
      else
        stars.places.push_back(place);
      has_lost = has_lost || stars.places.size() == before;
    }
    stars.has_lost.push_back(has_lost ? 1 : 0);
    std::sort(stars.places.begin() + static_cast<std::ptrdiff_t>(first), stars.places.end());
    stars.offsets.push_back(stars.places.size());
  }
  return stars;
}

/// With the cells of their origins, and without neighbours.
void CellComplex::append_copies(std::span<const Index> origins) {
  const std::size_t count = vertices_.size() + origins.size();
  for (const Index e : origins) vertices_.push_back(vertices_[e]);
  for (const Index e : origins)
    if (has_edges()) edges_.push_back(edges_[e]);
  for (const Index e : origins)
    if (has_faces()) faces_.push_back(faces_[e]);
  links_.resize(6 * count, none);
  copies_ += static_cast<Index>(origins.size());
  element_marks_.resize(count / 64 + 1);
  removed_marks_.resize(count / 64 + 1);
}

void CellComplex::relink(const Cloning& cloning) {
  const auto free = [&](std::size_t side) {
    Link& link = links_[side];
    if (link != none) links_[side_of(link)] = none;
    link = none;
  };
  const auto free_all = [&](Index e) {
    for (std::size_t f = 0; f < 6; ++f) free(std::size_t{6} * e + f);
  };
  std::ranges::for_each(cloning.origins, free_all);
  for (const Split& absorbed : cloning.absorbed) free_all(absorbed.old_cell);
  for (const Dart d : cloning.cut) free(d / 4);
  for (const auto& [one, other] : cloning.seams) {
    const Dart turn = one + other;  // beta3(d) = turn - d around the face
    links_[one / 4] = link_of(other / 24, (other % 24 & ~3u) | (turn & 3));
    links_[other / 4] = link_of(one / 24, (one % 24 & ~3u) | (turn & 3));
  }
}

/// Gives each connected part of the elements around a cell a number; the first keeps that of the
/// cell.
template <int Dimension>
void CellComplex::split_clones(const ClonedStars& stars, Index first_copy, TopologyChange& change) {
  auto* const label = rows<Dimension>();
  std::vector<LocalCell> part;
  for (std::size_t i = 0; i < stars.cells.size(); ++i) {
    const auto places =
        std::span(stars.places).subspan(stars.offsets[i], stars.offsets[i + 1] - stars.offsets[i]);
    for (const LocalCell place : places) label[place >> 4][place & 15] = none;
    Index id = stars.cells[i];
    if (places.empty()) {
      change.removed[Dimension].push_back(id);
      first_dart_[Dimension][id] = none;
      ++holes_[Dimension];
    }
    for (const LocalCell first : places) {
      if (label[first >> 4][first & 15] != none) continue;
      part.assign(1, first);
      label[first >> 4][first & 15] = id;
      for (std::size_t next = 0; next < part.size(); ++next) {
        const LocalCell here = part[next];
        for (const Exit exit : exits<Dimension>[here & 15]) {
          const Link link = links_[std::size_t{6} * (here >> 4) + exit.face];
          if (link == none) continue;
          const LocalCell there = link >> 5 << 4 | across<Dimension>[link & 31][exit.position];
          if (label[there >> 4][there & 15] != none) continue;
          label[there >> 4][there & 15] = id;
          part.push_back(there);
        }
      }
      std::ranges::sort(part);
      // A cut face may leave a cell around it as it was.
      if (part.size() == places.size() && part.back() >> 4 < first_copy && stars.has_lost[i] == 0)
        break;
      if (id != stars.cells[i]) {
        first_dart_[Dimension].push_back(none);
        change.splits[Dimension].push_back({stars.cells[i], id});
      }
      Dart* const darts = change.stars[Dimension].append(id, part.size());
      std::ranges::transform(part, darts, dart_at<Dimension>);
      first_dart_[Dimension][id] = darts[0];
      for (const LocalCell place : part)
        if (mark(element_marks_, place >> 4)) change.elements.push_back(place >> 4);
      id = count(Dimension);
    }
  }
}

void CellComplex::remove_origins(const Cloning& cloning, TopologyChange& change) {
  change.removed[3] = cloning.origins;
  for (const Split& absorbed : cloning.absorbed) change.removed[3].push_back(absorbed.old_cell);
  sort_unique(change.removed[3]);
  for (const Index e : change.removed[3]) {
    vertices_[e].fill(none);
    if (has_edges()) edges_[e].fill(none);
    if (has_faces()) faces_[e].fill(none);
    mark(removed_marks_, e);
  }
  holes_[3] += static_cast<Index>(change.removed[3].size());
}

}  // namespace suture
