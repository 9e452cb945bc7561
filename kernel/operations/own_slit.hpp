// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/operations/blade.hpp"

namespace suture {

/// What a moving blade has divided. One blade leaves one surface: it divides an element once,
/// however often its edge passes. A later pass that is steeper than 45 degrees to the cut of an
/// element, in its reference cube, crosses that cut and divides the element a second and last time.
///
/// Passes are numbered, a stroke each. The heights of the nodes of a divided element above the
/// sheet are kept, and snap others to them: where the sheet bends later, elements that are divided
/// then agree on the faces that they share, and no copy is cut again by a hair.
class OwnSlit {
 public:
  /// `size`: the longest edge of an element at rest, m.
  OwnSlit(const CellComplex& complex, double size);

  /// Of heights (Blade::heights) in a stroke: those that are kept, from this stroke, or from others
  /// where they are nearer than half of `size`.
  std::vector<double> snapped(std::vector<double> heights, Index stroke) const;
  /// As Blade::earlier_cut(), with heights that are snapped.
  Blade::Earlier earlier_cut(Index element, const std::vector<double>& heights, Index stroke) const;
  /// Call after a cut of a stroke, before elements are divided, with its heights. `divided`:
  /// ascending, as often as they have copies.
  void keep(const std::vector<double>& heights, std::span<const Index> divided, Index stroke);
  void follow(const TopologyChange& change);
  void state(Archive& archive);

 private:
  /// How an element was divided first.
  struct Section {
    Vec3 normal;  ///< of length 1, in the reference cube
    Index stroke;
  };
  bool has_heights(Index element, const std::vector<double>& heights) const;
  Vec3 normal_of(Index element, const std::vector<double>& heights) const;

  const CellComplex& complex_;
  double size_;
  /// By vertex, m: NaN without one; and in which stroke they were.
  std::vector<double> kept_;
  std::vector<Index> stroke_of_;
  std::vector<std::uint8_t> times_divided_;  ///< by element; of copies, with their originals
  std::vector<Index> section_of_;            ///< by element, likewise; none: whole
  std::vector<Section> sections_;
};

}  // namespace suture
