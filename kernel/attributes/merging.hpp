// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/own_rest.hpp"
#include "kernel/attributes/table.hpp"
#include "kernel/attributes/touched.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Masses of the two cells before they merge; in any unit, the same for both.
struct MergeWeight {
  double kept, gone;
};

/// Makes the rows and values of one table follow merges and removals of its cells, as
/// specified in suture/plugin.h, after the splits of the same change have been applied
/// (policies.hpp). Sums of SUTURE_FROM_VOLUMES are left to contributions.hpp. Work
/// space, kept between operations.
///
/// The mass of a vertex is the kernel's. For an edge or a face it is the volume of the
/// region's elements around it, because an instance has one set of parameters.
class MergePolicies {
 public:
  /// Computes the incident volumes of all rows if a column of the table is divided by
  /// them; to be called before the first operation. O(elements) for such tables.
  static void weigh(Table& table, const CellSet& region, const RestPlaces& rest);

  /// `vertex_weights`: one per merge of vertices. `new_rows`: the rows that the splits added,
  /// in order. Columns before `first_column` are left alone, but their rows die, too.
  /// O(cells of the dimension in the change).
  void apply(Table& table, const RestPlaces& rest, const TouchedElements& touched,
             std::span<const MergeWeight> vertex_weights, std::span<const RowSplit> new_rows,
             const TopologyChange& change, std::size_t first_column = 0);

 private:
  void find_volumes(const RestPlaces& rest, const TouchedElements& touched);
  double volume(std::span<const Dart> star, const TouchedElements& touched) const;
  void weigh_merges(std::size_t dimension, const TouchedElements& touched,
                    const TopologyChange& change);
  static void merge(Table& table, std::span<const Merge> merges,
                    std::span<const MergeWeight> weights, std::size_t first_column);
  static void drop(Table& table, const TouchedElements& touched, const TopologyChange& change);
  void keep_shares(Table& table, const TouchedElements& touched, std::span<const RowSplit> new_rows,
                   const TopologyChange& change);

  std::vector<double> volumes_;  ///< of the touched elements, by slot
  std::vector<double> totals_;   ///< by row; zero between operations
  std::vector<MergeWeight> weights_;
};

/// The values of vertices that become one: means, weighed by another column.
void merge_values(Column& values, const Column& weights, std::span<const Merge> merges);

/// The kernel's columns of vertices that become one, and the rest shape of the elements
/// around them.
struct VertexMerge {
  Column &rest, &position, &velocity, &fixed;
  OwnRest& own;
  const ElementParts& parts;

  /// Positions and velocities become the mass-weighted means, so that the centre of mass
  /// and the momentum are conserved. Components that are fixed in one of the vertices stay
  /// fixed at its position; if both are fixed, at that of the vertex that is kept. Rest
  /// positions that agree to 1e-9 of an edge become that of the vertex that is kept; others
  /// become the mass-weighted mean, too, so that the potential of gravity is conserved, and
  /// the elements around them keep separate rest shapes. O(elements around them).
  void apply(const CellComplex& complex, const TopologyChange& change,
             std::span<const MergeWeight> weights) const;
};

}  // namespace suture
