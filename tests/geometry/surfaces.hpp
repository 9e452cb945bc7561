// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "kernel/geometry/surface.hpp"

namespace suture::test {

/// 12 triangles, outward.
TriangleSurface box_surface(const Vec3& low, const Vec3& high);
/// An icosahedron whose triangles were split in four `rounds` times, on a sphere.
TriangleSurface sphere_surface(const Vec3& centre, double radius, int rounds);
/// Two surfaces in one.
TriangleSurface joined(const TriangleSurface& a, const TriangleSurface& b);
PolygonSoup soup_of(const TriangleSurface& surface);
/// Solid angle seen from p over 4 pi: 1 inside, 0 outside (van Oosterom & Strackee 1983).
double winding(const TriangleSurface& surface, const Vec3& p);
/// A file of this test's own folder, written.
std::filesystem::path file_with(const std::string& name, const std::string& text);
/// What the call throws; "" if it does not.
template <class Error, class Call>
std::string error_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace suture::test
