// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "kernel/geometry/surface.hpp"

namespace suture::bench {

/// A body of smooth parts that grow into each other: animals and mushrooms. Lengths
/// in m; z is up, the head looks along +x, y = 0 is the plane of symmetry. A part
/// with length or radius 0 is absent.
///
///                        __ head
///             ear ()____/  )___
///                  |  neck     \ nose
///      ____________/  /
///     (    torso      )
///    / `-|-|------|-|'
///  tail  | | legs | |
///        |_|      |_|
struct BodyParameters {
  Vec3 torso{0.5, 0.2, 0.2};  ///< half axes of an ellipsoid, its centre at the origin

  double leg_length = 0;        ///< from the middle of the torso down
  double leg_radius = 0;        ///< at the foot; 1.3 times that at the hip
  double leg_x = 0, leg_y = 0;  ///< the four hips lie at (+-leg_x, +-leg_y)
  double leg_splay = 0;         ///< how much further out the feet are than the hips

  double neck_length = 0, neck_radius = 0;
  double neck_slope = 0;  ///< rad above the horizontal; starts at the torso's front end
  double head_length = 0, head_radius = 0;
  double nose_length = 0, nose_radius = 0;   ///< an elephant's, hanging down
  double ear_radius = 0, ear_thickness = 0;  ///< flat plates beside the head
  double tail_length = 0, tail_radius = 0;

  double cap_radius = 0, cap_height = 0;  ///< a mushroom's, on top of the torso
  double blend = 0.03;                    ///< radius with which parts merge
};

/// A shape of the paper's Table 1 (Golec et al., WSCG 2015), whose meshes are not public,
/// rebuilt: as many elements when it is voxelized, and a plane that separates
/// as many faces, within 5 %.
struct BodyPreset {
  std::string name;
  BodyParameters parameters;
  std::size_t cells;      ///< hexahedra of the paper's mesh
  std::size_t faces_cut;  ///< faces of the paper's cut
  Vec3 cut_point, cut_normal;
};
std::span<const BodyPreset> body_presets();
/// Throws UsageError naming the nearest for a name that is none.
const BodyPreset& body_preset(std::string_view name);

/// The closed surface of a body, outward, triangles of about `size` m (0: a 60th of
/// its largest extent). Throws InputError for lengths that are negative or not finite, for
/// a torso that is flat, for parts too thin for `size`, which would get lost, and for a `size` that
/// makes more than 50 million triangles, estimated.
/// CGAL's mesher of implicit surfaces: about 20 us per triangle.
TriangleSurface generate_body(const BodyParameters& parameters, double size = 0);

}  // namespace suture::bench
