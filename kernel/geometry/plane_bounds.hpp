// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/centroids.hpp"

namespace suture {

/// What a blade covers of a plane: a disc or a polygon. Which elements lie on which side
/// is the whole plane's rule (events/cut_faces.hpp); of the faces that separate them,
/// those are kept whose link crosses the plane within the bounds.
///
/// The circle itself belongs to the disc. A polygon is taken by the even-odd rule, in
/// the two coordinates in which it is largest; of two polygons that share a side,
/// one has it. Both are decided in double precision, always in the same way.
class PlaneBounds {
 public:
  /// Throws InputError for a radius that is not positive and finite, or a bad plane.
  static PlaneBounds disc(const Vec3& centre, const Vec3& normal, double radius);
  /// The positive side is the one from which the corners are counterclockwise. Throws InputError:
  /// fewer than 3 corners, not finite, all on a line, further than 1e-6 of its size from a plane.
  static PlaneBounds polygon(std::vector<Vec3> corners);

  const Vec3& point() const { return point_; }
  /// Of length 1.
  const Vec3& normal() const { return normal_; }
  Box box() const;

  /// Keeps of `faces`, in their order, those crossed within the bounds. 50 ns per face.
  void keep_within(std::vector<Dart>& faces, const CellComplex& complex,
                   const Places& places) const;
  /// Whether a point of the plane belongs to the blade.
  bool covers(const Vec3& p) const;

 private:
  PlaneBounds() = default;
  Vec3 point_{}, normal_{};
  double radius_ = 0;
  std::vector<Vec3> corners_;
};

}  // namespace suture
