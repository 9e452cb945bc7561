// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernel/dynamics/body.hpp"
#include "kernel/operations/element_stretch.hpp"
#include "kernel/scene/event.hpp"

namespace suture {

/// Finds faces that a criterion tears; CellComplex::cut() then cuts them.
///
/// Every element has a value for one of its three pairs of opposite faces, or for each of them; a
/// face tears if the mean of the values of its two elements exceeds the threshold:
///
///   principal-strain  The largest eigenvalue of E = (F^T F - 1)/2 at the element's
///                     centre, for the pair of faces across which it is strained the
///                     most. Of two elements the one with the larger value says
///                     whether their face is of that pair.
///
///                         <- +---+---+ ->       the vertical faces tear,
///                         <- +---+---+ ->       the horizontal ones stay
///
///   elongation        l/L - 1 of an edge, L its length at rest: for each direction
///                     the largest of four, for the pair of faces at the ends of
///                     these edges. (To open the faces around an edge would leave it
///                     as long as it is.)
///   field             A number that a model declares (suture.output/1). On edges
///                     like the elongation; on elements like the principal strain,
///                     which still says which pair of faces. Of two elements only one
///                     of which has a value (the other is of another model) that
///                     one's counts.
///                     A field on vertices (SUTURE_FIELD), such as a phase field: an element tears
///                     whose mean exceeds the threshold, at one of its two faces of that pair, the
///                     one with the larger mean. So a crack that is smeared over several layers
///                     of elements opens once.
///
/// F = sum_a A_a x G_a, with A_a the mean of the four edge vectors of direction a and G_a the
/// reciprocal of those at rest: exact for parallelepipeds.
///
/// Cost: a pass over the chosen elements in batches of 8 with a bound that excludes most elements,
/// then exact values for the others; a field costs its evaluation by the model. Memory: 72 B
/// (strain) or 96 B (elongation) per element, nothing if all are congruent; no list of elements if
/// all are checked and there are no holes.
class TearCheck {
 public:
  /// `elements`: ascending, or empty for all; only faces between two of them tear. `path`: JSON
  /// path of the criterion, for messages.
  TearCheck(const Tear& tear, std::span<const Index> elements, std::string path);

  /// One dart of each face that tears now, ascending. Throws NumericalError if they exceed the
  /// fraction tear.max_fraction of the faces between the elements (a criterion that tears
  /// everything does not describe a crack), PluginError for a field that no model provides. The
  /// result does not depend on the number of threads.
  std::vector<Dart> faces(Body& body, double time);

  /// Call after elements were removed or copied, or rest positions changed.
  void invalidate(std::span<const Split> copies = {});
  /// The metric is rebuilt from the loaded attributes, with the same bits.
  void state(Archive& archive);

 private:
  /// The current state, for the duration of one check.
  struct Snapshot;

  void build(const Snapshot& snapshot);
  Column make_metric(const Snapshot& snapshot) const;
  std::vector<Index> stretched(const Snapshot& snapshot) const;
  std::vector<Dart> find(const Snapshot& snapshot);
  std::vector<Dart> by_principal(const Snapshot& snapshot, const std::vector<double>* values);
  std::vector<Dart> by_vertices(const Snapshot& snapshot, const double* values);
  std::vector<Dart> by_edges(const Snapshot& snapshot, const std::vector<double>* values);
  std::vector<double> field_values(const Snapshot& snapshot, int dimension) const;
  int field_dimension(const Snapshot& snapshot) const;
  void check_share(const CellComplex& complex, std::size_t torn) const;
  bool takes_part(Index element) const {
    return is_chosen_.empty() || (element - first_chosen_ < is_chosen_.size() &&  // or below 0
                                  is_chosen_[element - first_chosen_] != 0);
  }
  void choose(Index element);

  Tear tear_;
  Index first_chosen_ = 0, chosen_count_ = 0;  ///< of the given elements
  std::vector<char> is_chosen_;                ///< from the first to the last; empty: all
  std::string path_;

  bool is_built_ = false;
  std::vector<Index> rows_;  ///< elements to check; empty: all, without holes
  Index row_count_ = 0;
  Column metric_;  ///< per row, see loops::Table::strained and elongated
};

}  // namespace suture
