// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/merging.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/attributes/policies.hpp"

namespace suture {
namespace {

/// The fraction of the second of two masses; one half if both are zero.
double part(double first, double second) {
  return first + second > 0 ? second / (first + second) : 0.5;
}

bool needs_weights(const Table& table) {
  return std::ranges::any_of(table.columns, [](const Column& column) {
    return column.spec().policy == SUTURE_COPY && !column.is_constant();
  });
}

void combine(Column& column, Index kept, Index gone, double share) {
  switch (column.spec().policy) {
    case SUTURE_COPY:
      column.mix_row(kept, gone, share);
      return;
    case SUTURE_ZERO:
    case SUTURE_SHARE:
      column.add_row(kept, gone);
      return;
    case SUTURE_FROM_VOLUMES:
      return;  // summed again
  }
}

/// Visits the cells of one dimension (0..2) of an element.
template <class Visit>
void for_each_cell(const CellComplex& complex, int dimension, Index element, Visit visit) {
  if (dimension == 0)
    for (const Index cell : complex.vertices_of(element)) visit(cell);
  else if (dimension == 1)
    for (const Index cell : complex.edges_of(element)) visit(cell);
  else
    for (const Index cell : complex.faces_of(element)) visit(cell);
}

}  // namespace

void MergePolicies::weigh(Table& table, const CellSet& region, const RestPlaces& rest) {
  if (!SplitPolicies::weighs(table) || table.dimension == 3) return;
  table.volumes.assign(table.cells.size(), 0);
  for (Index e = 0; e < rest.complex().element_count(); ++e) {
    if (!region.contains(e)) continue;
    const double volume = rest.volume(e);
    for_each_cell(rest.complex(), table.dimension, e,
                  [&](Index cell) { table.volumes[table.cells.row(cell)] += volume; });
  }
}

void MergePolicies::apply(Table& table, const RestPlaces& rest, const TouchedElements& touched,
                          std::span<const MergeWeight> vertex_weights,
                          std::span<const RowSplit> new_rows, const TopologyChange& change,
                          std::size_t first_column) {
  const auto dimension = static_cast<std::size_t>(table.dimension);
  const bool merges = dimension < 3 && !change.merges[dimension].empty();
  const bool weighs = merges && dimension != 0 && needs_weights(table);
  if (weighs || !table.volumes.empty()) find_volumes(rest, touched);
  if (merges) {
    weights_.clear();
    if (weighs) weigh_merges(dimension, touched, change);
    merge(table, change.merges[dimension], dimension == 0 ? vertex_weights : weights_,
          first_column);
  }
  if (!change.removed[3].empty()) drop(table, touched, change);
  if (!table.volumes.empty()) keep_shares(table, touched, new_rows, change);
}

void MergePolicies::find_volumes(const RestPlaces& rest, const TouchedElements& touched) {
  volumes_.clear();
  for (const Index e : touched.members()) volumes_.push_back(rest.volume(e));
}

double MergePolicies::volume(std::span<const Dart> star, const TouchedElements& touched) const {
  double sum = 0;
  for (const Dart dart : star) {
    const Index slot = touched.slot(dart / hexahedron::darts);
    if (slot != none) sum += volumes_[slot];
  }
  return sum;
}

/// The previous share of the kept cell is its present one without those of the others.
void MergePolicies::weigh_merges(std::size_t dimension, const TouchedElements& touched,
                                 const TopologyChange& change) {
  const std::span<const Merge> merges = change.merges[dimension];
  const Stars &stars = change.stars[dimension], &gone = change.gone[dimension];
  weights_.resize(merges.size());
  for (std::size_t begin = 0, end = 0; begin < merges.size(); begin = end) {
    const Index cell = merges[begin].kept;
    const auto star = std::ranges::lower_bound(stars.cells, cell) - stars.cells.begin();
    double kept = volume(stars[static_cast<std::size_t>(star)], touched);
    for (; end < merges.size() && merges[end].kept == cell; ++end) {
      weights_[end].gone = volume(gone[end], touched);
      kept -= weights_[end].gone;
    }
    for (std::size_t i = begin; i < end; ++i) weights_[i].kept = kept;
  }
}

// Rows of two cells that become one, in the table of a region (#):
//
//     #  c   d  #          #  c  #     both have a row: c's has both values, d's dies
//     #  c   d  .   sew    #  c  .     d has none: nothing happens
//     .  c   d  #  ----->  .  c  #     c has none: d's row becomes c's
void MergePolicies::merge(Table& table, std::span<const Merge> merges,
                          std::span<const MergeWeight> weights, std::size_t first_column) {
  CellSet& cells = table.cells;
  double weight = 0;  // of what is in the row of the cell that is kept
  for (std::size_t i = 0; i < merges.size(); ++i) {
    const auto [kept, gone] = merges[i];
    const MergeWeight w = weights.empty() ? MergeWeight{1, 1} : weights[i];
    if (i == 0 || merges[i - 1].kept != kept) weight = w.kept;
    if (!cells.contains(gone)) continue;
    if (!cells.contains(kept)) {
      cells.rename(gone, kept);
      weight = w.gone;
      continue;
    }
    const double share = part(weight, w.gone);
    for (std::size_t c = first_column; c < table.columns.size(); ++c)
      combine(table.columns[c], cells.row(kept), cells.row(gone), share);
    weight += w.gone;
    cells.remove(gone);
  }
}

/// Removes the cells that no longer exist from the table, and those that have no element of the
/// region left.
void MergePolicies::drop(Table& table, const TouchedElements& touched,
                         const TopologyChange& change) {
  const auto dimension = static_cast<std::size_t>(table.dimension);
  for (const Index cell : change.removed[dimension])
    if (table.cells.contains(cell)) table.cells.remove(cell);
  if (dimension == 3 || table.cells.is_all()) return;
  const Stars& stars = change.stars[dimension];
  for (std::size_t i = 0; i < stars.size(); ++i) {
    if (!table.cells.contains(stars.cells[i])) continue;
    const bool has_member = std::ranges::any_of(
        stars[i], [&](Dart dart) { return touched.slot(dart / hexahedron::darts) != none; });
    if (!has_member) table.cells.remove(stars.cells[i]);
  }
}

/// The parts of a cell that lost elements hold all that it had: they keep what belongs
/// to the volume that is left. (Volumes of parts that resulted from a split are summed over
/// them, as the value was divided among them.)
void MergePolicies::keep_shares(Table& table, const TouchedElements& touched,
                                std::span<const RowSplit> new_rows, const TopologyChange& change) {
  const Stars& stars = change.stars[static_cast<std::size_t>(table.dimension)];
  const auto old_rows = static_cast<Index>(table.cells.size() - new_rows.size());
  const auto origin = [&](Index row) {
    return row < old_rows ? row : new_rows[row - old_rows].old_row;
  };
  const auto for_each_row = [&](auto visit) {
    for (std::size_t i = 0; i < stars.size(); ++i)
      if (table.cells.contains(stars.cells[i])) visit(table.cells.row(stars.cells[i]), stars[i]);
  };
  table.volumes.resize(table.cells.size());
  totals_.resize(std::max<std::size_t>(totals_.size(), table.cells.size()));
  std::vector<double> after;
  for_each_row([&](Index row, std::span<const Dart> star) {
    after.push_back(volume(star, touched));
    totals_[origin(row)] += after.back();
  });
  if (!change.removed[3].empty())
    for_each_row([&](Index row, std::span<const Dart>) {
      const double before = table.volumes[origin(row)];
      const double left = before == 0 ? 0 : totals_[origin(row)] / before;
      for (Column& column : table.columns)
        if (column.spec().policy == SUTURE_SHARE) column.scale_row(row, left);
    });
  std::size_t i = 0;
  for_each_row([&](Index row, std::span<const Dart>) {
    totals_[origin(row)] = 0;
    table.volumes[row] = after[i++];
  });
}

// ----------------------------------------------------------- kernel's vertices --

void merge_values(Column& values, const Column& weights, std::span<const Merge> merges) {
  double weight = 0;  // of what is in the row of the vertex that is kept
  for (std::size_t i = 0; i < merges.size(); ++i) {
    const auto [kept, gone] = merges[i];
    if (i == 0 || merges[i - 1].kept != kept) weight = weights.get(kept, 0);
    values.mix_row(kept, gone, part(weight, weights.get(gone, 0)));
    weight += weights.get(gone, 0);
  }
}

namespace {

/// A corner of an element that had a separate rest position before the merge.
struct Corner {
  Index element;
  std::size_t node;
  Vec3 rest;
};

Vec3 row_of(const Column& column, Index vertex) {
  const double* p = column.rows() + std::size_t{vertex} * 4;
  return {p[0], p[1], p[2]};
}

double distance(const Vec3& a, const Vec3& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(sum);
}

double longest_edge(const HexahedronNodes& x) {
  double longest = 0;
  for (const auto& [a, b] : hexahedron::edge_vertices)
    longest = std::max(longest, distance(x[a], x[b]));
  return longest;
}

/// Vertices that become one.
class Group {
 public:
  Group(const VertexMerge& columns, const CellComplex& complex, const TopologyChange& change,
        std::span<const MergeWeight> weights, std::size_t begin, std::size_t end)
      : columns_(columns), change_(change), weights_(weights), begin_(begin), end_(end) {
    kept_ = change.merges[0][begin].kept;
    const Stars& stars = change.stars[0];
    const auto at = std::ranges::lower_bound(stars.cells, kept_) - stars.cells.begin();
    star_ = stars[static_cast<std::size_t>(at)];
    const RestPlaces rest(complex, columns.rest, columns.own, columns.parts);
    near_ = 1e-9 * longest_edge(rest.of(star_[0] / hexahedron::darts));
  }

  void merge(std::vector<Corner>& corners) const {
    const Vec3 before = row_of(columns_.rest, kept_);
    double mass = weights_[begin_].kept;
    for (std::size_t i = begin_; i < end_; ++i) {
      add(gone(i), part(mass, weights_[i].gone));
      mass += weights_[i].gone;
    }
    keep_rest_shapes(before, corners);
  }

 private:
  Index gone(std::size_t i) const { return change_.merges[0][i].gone; }
  int fixed(Index vertex) const { return static_cast<int>(columns_.fixed.get(vertex, 0)); }

  void add(Index other, double share) const {
    const int here = fixed(kept_), there = fixed(other);
    if (distance(row_of(columns_.rest, kept_), row_of(columns_.rest, other)) > near_)
      columns_.rest.mix_row(kept_, other, here != 0 ? 0 : there != 0 ? 1 : share);
    for (Column* column : {&columns_.position, &columns_.velocity})
      for (int c = 0; c < 3; ++c) {
        const double w = (here >> c & 1) != 0 ? 0 : (there >> c & 1) != 0 ? 1 : share;
        column->set(kept_, c, std::lerp(column->get(kept_, c), column->get(other, c), w));
      }
    columns_.fixed.set(kept_, 0, here | there);
  }

  /// Corners of elements that were elsewhere at rest than the vertex is now.
  void keep_rest_shapes(const Vec3& before, std::vector<Corner>& corners) const {
    const Vec3 now = row_of(columns_.rest, kept_);
    std::vector<Dart> of_others;
    for (std::size_t i = begin_; i < end_; ++i) {
      const std::span<const Dart> star = change_.gone[0][i];
      of_others.insert(of_others.end(), star.begin(), star.end());
      const Vec3 rest = row_of(columns_.rest, gone(i));
      if (distance(rest, now) > near_)
        for (const Dart dart : star) corners.push_back(corner(dart, rest));
    }
    if (distance(before, now) <= near_) return;
    std::ranges::sort(of_others);
    for (const Dart dart : star_)
      if (!std::ranges::binary_search(of_others, dart)) corners.push_back(corner(dart, before));
  }

  static Corner corner(Dart dart, const Vec3& rest) {
    return {dart / hexahedron::darts, hexahedron::dart_vertex[dart % hexahedron::darts], rest};
  }

  const VertexMerge& columns_;
  const TopologyChange& change_;
  std::span<const MergeWeight> weights_;
  std::size_t begin_, end_;  ///< of its merges
  Index kept_;
  std::span<const Dart> star_;  ///< of the vertex that is kept, now
  double near_;                 ///< rest positions that are one, m
};

}  // namespace

void VertexMerge::apply(const CellComplex& complex, const TopologyChange& change,
                        std::span<const MergeWeight> weights) const {
  const std::vector<Merge>& merges = change.merges[0];
  std::vector<Corner> corners;
  for (std::size_t begin = 0, end = 0; begin < merges.size(); begin = end) {
    while (end < merges.size() && merges[end].kept == merges[begin].kept) ++end;
    Group(*this, complex, change, weights, begin, end).merge(corners);
  }
  // Elements that had their own rest positions keep them.
  std::erase_if(corners, [&](const Corner& c) { return own.slot(c.element) != none; });
  std::ranges::stable_sort(corners, {}, &Corner::element);
  const RestPlaces places(complex, rest, own, parts);
  for (std::size_t i = 0; i < corners.size();) {
    const Index element = corners[i].element;
    HexahedronNodes x = places.of(element);
    for (; i < corners.size() && corners[i].element == element; ++i)
      x[corners[i].node] = corners[i].rest;
    own.set(element, x, complex.element_count());
  }
}

}  // namespace suture
