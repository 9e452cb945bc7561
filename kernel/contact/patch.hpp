// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/contact/near_pairs.hpp"

namespace suture {

/// A boundary face as a bilinear surface x(r, s), r and s from 0 to 1, through its corners
/// (counterclockwise from outside). It has no fold along a diagonal, so a vertex that slides over
/// it feels no kink, and the result does not depend on which diagonal was chosen.
struct Patch {
  std::array<Vec3, 4> corners;

  /// The foot of a place on the patch, or on its rim.
  struct Foot {
    std::array<double, 4> weights;  ///< of the corners
    Vec3 normal;                    ///< of the surface there, outward, of length 1
    Vec3 offset;                    ///< from the foot to the place
  };
  Vec3 centre() const;
  /// By Gauss-Newton steps from the middle, which are exact where the face is flat.
  Foot foot(const Vec3& place) const;
  static std::array<double, 4> weights_at(double r, double s);
};

/// `positions`: rows of 4.
Patch patch_of(const BoundarySurface::Corners& corners, const double* positions);

/// The foot of a vertex on a face.
struct FaceFoot {
  double r, s;
  Vec3 normal;      ///< of the surface there, outward, of length 1
  double gap;       ///< along the normal, m
  double distance;  ///< m
  double beside;    ///< the part of the distance at right angles to the normal, m
};

/// By Patch::foot, eight at once, with the same bits. `positions`: rows of 4.
void find_feet(const double* positions, std::span<const BoundarySurface::Corners> corners,
               std::span<const NearPair> pairs, std::vector<FaceFoot>& feet);

/// The mean plane of a face; in one line of the cache.
struct alignas(64) FacePlane {
  Vec3 normal;  ///< outward, of length 1; 0 without area
  Vec3 centre;
  double height;  ///< of the corners above or below the centre, m
  double reach;  ///< squared: no foot of a vertex is on the face that is farther from the axis, m^2
};

/// Eight at once, and vectors of the length of twice the areas, outward, m^2. `depth` and `beside`:
/// how far a vertex may be from its foot, and beside it, m (FaceFoot). The corners are h above and
/// below the plane and r from the centre at most, so that the normal leans by an angle t at most:
///   sin t < 2 h sqrt(1/a^2 + 1/b^2) < 16 h r / |area|    of a rectangle a x b, |area| = 2 a b
void find_planes(const double* positions, std::span<const BoundarySurface::Corners> corners,
                 double depth, double beside, std::vector<FacePlane>& planes,
                 std::vector<Vec3>& areas);

}  // namespace suture
