// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/centroids.hpp"
#include "kernel/geometry/tissue_blocks.hpp"

namespace suture {

/// Where a moving blade is at a time: the points of a polyline, m.
struct BladeKey {
  double time;  ///< s
  std::vector<Vec3> points;
};

/// A segment or polyline that moves along straight lines from key to key. It exists from the
/// first key to the last; with one key alone it stands still from that time on.
///
/// A step cuts what the blade swept relative to the tissue. Each link near it looks
/// at the blade from its own place: with a, b the link at the end of the step and a0, b0 at its
/// start, d = b - a and m the middle, the blade's point p0 at the start is seen at
///
///    p0' = m + F (p0 - m0),   F = 1 + (d - d0) d0^T / |d0|^2
///
/// the affine map that takes the old link to the new one and moves everything else least. Between
/// p0' and p1 of the step's end it sweeps, per segment, two triangles (p0', q0', q1) and (p0', q1,
/// p1), which cut by the rule of SurfaceBlade. For still tissue p0' = p0 to the last bit; a still
/// blade that tissue is pushed past cuts as a blade that moves the other way. Which side of the
/// blade a link is on does not change between two steps (F keeps orientation), so that none slips
/// through from step to step.
class MovingBlade {
 public:
  /// Throws InputError: no key, fewer than 2 points, another number of points than the first
  /// key, values that are not finite, times that do not grow, all points at one place.
  /// `look`: all elements are looked at in every step, to compare with.
  enum class Look { near, all };
  explicit MovingBlade(std::vector<BladeKey> keys, Look look = Look::near);

  double begin() const { return keys_.front().time; }
  double end() const;  ///< s; infinite for one key
  /// The polyline at a time between begin() and end().
  std::vector<Vec3> at(double time) const;
  /// Box of everything the blade sweeps.
  Box box() const;

  /// The faces cut since the last call, as SurfaceBlade::faces_cut gives them. The first call, and
  /// the first after a reset(), only remembers where the tissue is: make it at the start of a run.
  /// Throws InputError if `time` is before the last call's. Remembers where all vertices are,
  /// 50 B each (tissue_blocks.hpp). Nothing is computed before the step in which the blade
  /// appears (the tissue counts as still during that one step) and after the last key. Cost: 2
  /// ns per vertex and 25 ns per element in blocks near the box of what the blade sweeps in the
  /// step; nothing when there is no blade.
  std::vector<Dart> advance(const CellComplex& complex, const Places& places, double time,
                            const Workers* workers = nullptr);
  /// An operation was made that moves no vertex: vertices that split off were where those
  /// were that they left. `complex` as it is afterwards. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change) {
    tissue_.follow(complex, change);
  }
  /// Forgets the tissue, when its elements have been moved otherwise than by a step.
  void reset();

 private:
  struct Step;
  /// An element in a step.
  struct End {
    Row4 before, now;  ///< centroids
    unsigned outside;  ///< sides of the blade's box beyond which both are
  };
  /// Places of the blade during a step: its ends and the keys between them.
  std::vector<BladeKey> path(double from, double to) const;
  Step step_between(const CellComplex& complex, double last, const Workers* workers);
  End look_at(const CellComplex& complex, const Box& box, Index element) const;
  void look_for_crossings(const CellComplex& complex, const Step& step, Index block,
                          std::vector<Dart>& cut) const;

  std::vector<BladeKey> keys_;
  Look look_;
  bool started_ = false;
  double time_ = 0;
  TissueBlocks tissue_;
  std::vector<End> ends_;          ///< scratch: of the elements of the blocks that are near
  std::vector<unsigned> outside_;  ///< the same, End::outside
};

}  // namespace suture
