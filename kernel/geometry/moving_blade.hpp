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
///
/// The links of an element that was looked at are not looked at again until the blade may have
/// come to one. Say that the blade was then at least g from all of them, and that tissue and
/// blade have moved by no more than s since, each the farthest of its points in each step,
/// added up (no velocity is assumed: every position is read). In a step in which the tissue
/// moves by u, F moves a point p of the blade by at most
///
///    D = u + 2 u |p - m0| / |d0|
///
/// and both triangles lie within D of the hull of the blade at the step's start and end, which
/// is no nearer than g - s: without g - s <= D no link is cut.
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
  /// 50 B each, and 8 B per element (tissue_blocks.hpp). Nothing is computed before the step in
  /// which the blade appears (the tissue counts as still during that one step) and after the last
  /// key. Cost: 2 ns per vertex and the elements that the blade may have come to; nothing
  /// when there is no blade.
  std::vector<Dart> advance(const CellComplex& complex, const Places& places, double time,
                            const Workers* workers = nullptr);
  /// An operation was made that moves no vertex: vertices that split off were where those
  /// were that they left. `complex` as it is afterwards. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change) {
    tissue_.follow(complex, change);
  }
  /// Forgets the tissue, when its elements have been moved otherwise than by a step.
  void reset();
  /// What it remembers, between two calls of advance(). Nothing of a motion: who goes back
  /// calls reset(). To be loaded into a blade of the same keys, once the map is loaded.
  void state(Archive& archive);

 private:
  struct Step;
  /// A block of elements that was looked at in whole, and what has moved since.
  struct Clearance {
    double reach = 0;        ///< m, from its links to the farthest point of the blade; at most
    double shortest = 0;     ///< m, of its links
    double tissue = 0;       ///< m, moved
    double moved = 0;        ///< m, tissue and blade together
    std::uint64_t step = 0;  ///< up to which these count
  };
  /// Places of the blade during a step: its ends and the keys between them.
  std::vector<BladeKey> path(double from, double to) const;
  Step step_between(double last) const;
  std::vector<Index> elements_to_look_at(const CellComplex& complex, const Step& step);
  bool may_skip(Index block, const Step& step, double& needed);
  /// What a look at an element's links found, as in Clearance.
  struct Found {
    double gap, reach, shortest;
  };
  Found look_at(const CellComplex& complex, const Step& step, Index element,
                std::vector<Dart>& cut) const;
  void note(Index element, const Found& found);

  std::vector<BladeKey> keys_;
  Look look_;
  bool started_ = false;
  double time_ = 0;
  TissueBlocks tissue_;
  std::uint64_t step_ = 0;
  std::vector<Clearance> clearances_;  ///< per block
  /// Per element: what Clearance::moved may become before its links are looked at again.
  std::vector<double> gaps_;
};

}  // namespace suture
