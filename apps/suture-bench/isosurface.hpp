// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "kernel/geometry/surface.hpp"

namespace suture::bench {

/// The zero of a function that is negative inside, within a ball around a centre
/// that lies inside; triangles of about `size`. CGAL's mesher of implicit surfaces, about
/// 20 us per triangle; the same triangles each time.
TriangleSurface isosurface(const std::function<double(const Vec3&)>& value, const Vec3& centre,
                           double radius, double size);

}  // namespace suture::bench
