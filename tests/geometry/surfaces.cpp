// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/geometry/surfaces.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include "tests/mesh/temporary_folder.hpp"

namespace suture::test {
namespace {

Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

void project(Vec3& p) {
  const double size = std::sqrt(dot(p, p));
  for (double& x : p) x /= size;
}

}  // namespace

TriangleSurface box_surface(const Vec3& low, const Vec3& high) {
  TriangleSurface surface{"box", {}, {}};
  for (unsigned n = 0; n < 8; ++n)
    surface.points.push_back(
        {n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1], n & 4 ? high[2] : low[2]});
  // Corners of each side, counterclockwise from outside.
  constexpr Index sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& s : sides) {
    surface.triangles.push_back({s[0], s[1], s[2]});
    surface.triangles.push_back({s[0], s[2], s[3]});
  }
  return surface;
}

TriangleSurface sphere_surface(const Vec3& centre, double radius, int rounds) {
  const double g = std::numbers::phi;
  TriangleSurface s{
      "sphere",
      {{-1, g, 0},
       {1, g, 0},
       {-1, -g, 0},
       {1, -g, 0},
       {0, -1, g},
       {0, 1, g},
       {0, -1, -g},
       {0, 1, -g},
       {g, 0, -1},
       {g, 0, 1},
       {-g, 0, -1},
       {-g, 0, 1}},
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [at, fresh] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, Index(s.points.size()));
      if (fresh) {
        const Vec3 p = s.points[a], q = s.points[b];
        s.points.push_back({p[0] + q[0], p[1] + q[1], p[2] + q[2]});
      }
      return at->second;
    };
    for (Vec3& p : s.points) project(p);
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : s.triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    s.triangles = std::move(finer);
  }
  for (Vec3& p : s.points) {
    project(p);
    for (int a = 0; a < 3; ++a) p[a] = centre[a] + radius * p[a];
  }
  return s;
}

TriangleSurface joined(const TriangleSurface& a, const TriangleSurface& b) {
  TriangleSurface both = a;
  const auto first = static_cast<Index>(a.points.size());
  both.points.insert(both.points.end(), b.points.begin(), b.points.end());
  for (const Triangle& t : b.triangles)
    both.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return both;
}

PolygonSoup soup_of(const TriangleSurface& surface) {
  PolygonSoup soup{surface.source, surface.points, {}, {0}};
  for (const Triangle& t : surface.triangles) {
    soup.corners.insert(soup.corners.end(), t.begin(), t.end());
    soup.offsets.push_back(static_cast<Index>(soup.corners.size()));
  }
  return soup;
}

double winding(const TriangleSurface& surface, const Vec3& p) {
  double angle = 0;
  for (const Triangle& t : surface.triangles) {
    const Vec3 a = minus(surface.points[t[0]], p), b = minus(surface.points[t[1]], p),
               c = minus(surface.points[t[2]], p);
    const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    angle += 2 * std::atan2(dot(a, cross(b, c)),
                            la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

std::filesystem::path file_with(const std::string& name, const std::string& text) {
  static const TemporaryFolder folder;  // gone when the program ends
  return folder.write(name, text);
}

}  // namespace suture::test
