// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/centroids.hpp"
#include "kernel/geometry/tissue_blocks.hpp"

namespace suture {

/// The position of a moving blade at a time: the points of a polyline, m.
struct BladeKey {
  double time;  ///< s
  std::vector<Vec3> points;
};

/// A segment or polyline that moves along straight lines from key to key. It exists from the first
/// key to the last; with a single key it is stationary from that time on. A carried blade has no
/// keys: something else moves it.
///
/// A step cuts what the blade sweeps relative to the tissue. Each link near the blade sees it in
/// its own frame: let a, b be the link at the end of the step and a0, b0 at its start, d = b - a
/// and m the midpoint; then the blade's point p0 at the start is seen at
///
///    p0' = m + F (p0 - m0),   F = 1 + (d - d0) d0^T / |d0|^2
///
/// the affine map that takes the old link to the new one and moves everything else least. Between
/// p0' and p1 of the step's end it sweeps, per segment, two triangles (p0', q0', q1) and (p0', q1,
/// p1), which cut by the rule of SurfaceBlade. For stationary tissue p0' = p0 exactly; a stationary
/// blade past which tissue is pushed cuts like a blade that moves the other way. The side of the
/// blade on which a link lies does not change between two steps (F preserves orientation), so that
/// no link slips through.
///
/// Once the links of an element have been checked, they are not checked again until the blade may
/// have reached one. Suppose that the blade was then at least g away from all of them, and that
/// tissue and blade have since moved by at most s (in each step the largest motion of any point of
/// each, summed over the steps; no velocity is assumed: every position is read). In a step in which
/// the tissue moves by u, F moves a point p of the blade by at most
///
///    D = u + 2 u |p - m0| / |d0|
///
/// and both triangles lie within D of the hull of the blade at the start and end of the step, which
/// is no closer than g - s: no link is cut unless g - s <= D.
class MovingBlade {
 public:
  /// Throws InputError if there is no key, if a key has fewer than 2 points or a different number
  /// of points from the first key, if values are not finite, if times do not increase, or if all
  /// points coincide. Scope::all checks all elements in every step, as a reference.
  enum class Scope { near, all };
  explicit MovingBlade(std::vector<BladeKey> keys, Scope scope = Scope::near);
  /// A blade that carry_to() moves, at these points at time 0. The same errors.
  static MovingBlade carried(std::vector<Vec3> points, Scope scope = Scope::near);

  double begin() const { return keys_.front().time; }
  double end() const;  ///< s; infinite for one key
  /// The polyline at a time between begin() and end().
  std::vector<Vec3> at(double time) const;
  /// The bounding box of everything that the blade sweeps.
  Box box() const;

  /// Call before advance() with the same time: the points of a carried blade have moved there along
  /// straight lines.
  void carry_to(double time, std::vector<Vec3> points);
  /// The faces cut since the last call, in the form of SurfaceBlade::faces_cut. The first call, and
  /// the first after reset(), only stores the positions of the tissue: make it at the start of a
  /// run. Throws InputError if `time` is earlier than in the last call. Stores the positions of all
  /// vertices, 50 B each, and 8 B per element (tissue_blocks.hpp). Nothing is computed before the
  /// step in which the blade appears (the tissue counts as stationary during that step) or after
  /// the last key. Cost: 2 ns per vertex, plus the elements that the blade may have reached;
  /// nothing while there is no blade.
  std::vector<Dart> advance(const CellComplex& complex, const Places& places, double time,
                            const Workers* workers = nullptr);
  /// Call after an operation that moves no vertex, with the resulting `complex`: vertices that
  /// separated have the previous positions of those that they separated from. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change) {
    tissue_.follow(complex, change);
  }
  /// Forgets the positions of the tissue; call it when elements were moved other than by a step.
  void reset();
  /// The stored state, between two calls of advance(). It is not part of a motion: call reset()
  /// after a rollback. Must be loaded into a blade with the same keys, after the map.
  void state(Archive& archive);

 private:
  struct Step;
  /// A fully checked block of elements, and the motion since then.
  struct Clearance {
    double reach = 0;        ///< m, bound on the distance from its links to any blade point
    double shortest = 0;     ///< m, the shortest of its links
    double tissue = 0;       ///< m, motion of the tissue
    double moved = 0;        ///< m, motion of tissue and blade together
    std::uint64_t step = 0;  ///< the step up to which these are summed
  };
  /// Positions of the blade during a step: at its ends and at the keys in between.
  std::vector<BladeKey> path(double from, double to) const;
  Step step_between(double last) const;
  std::vector<Index> elements_to_check(const CellComplex& complex, const Step& step);
  bool may_skip(Index block, const Step& step, double& needed);
  /// The result of checking an element's links, as in Clearance.
  struct CheckResult {
    double gap, reach, shortest;
  };
  CheckResult check(const CellComplex& complex, const Step& step, Index element,
                    std::vector<Dart>& cut) const;
  void record(Index element, const CheckResult& found);

  std::vector<BladeKey> keys_;
  bool is_carried_ = false;  ///< keys_: its places in the last step
  Box swept_ = no_box;       ///< by a carried blade, in earlier steps
  Scope scope_;
  bool started_ = false;
  double time_ = 0;
  TissueBlocks tissue_;
  std::uint64_t step_ = 0;
  std::vector<Clearance> clearances_;  ///< per block
  /// Per element: the value of Clearance::moved up to which its links need not be checked again.
  std::vector<double> gaps_;
};

}  // namespace suture
