// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/geometry/dyadic.hpp"

#include <stdexcept>

#include "kernel/mesh/box.hpp"

namespace suture::test {
namespace {

__extension__ using Wide = __int128;
using Whole = std::array<Wide, 3>;

// Centroids are multiples of 2^-13.
Whole whole(const Vec3& p) {
  Whole result;
  for (int a = 0; a < 3; ++a) {
    const double scaled = p[a] * 8192;
    const auto integer = static_cast<long long>(scaled);
    if (static_cast<double>(integer) != scaled) throw std::logic_error("no multiple of 2^-13");
    result[a] = integer;
  }
  return result;
}

Whole minus(const Whole& a, const Whole& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// Sign of (q - p) x (r - p) . (s - p).
int side(const Whole& p, const Whole& q, const Whole& r, const Whole& s) {
  const Whole u = minus(q, p), v = minus(r, p), w = minus(s, p);
  const Wide det = (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
                   (u[0] * v[1] - u[1] * v[0]) * w[2];
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

}  // namespace

Block block_of(Index nx, Index ny, Index nz) {
  std::mt19937 random(0);
  return jittered_block(nx, ny, nz, 0, random);
}

Block jittered_block(Index nx, Index ny, Index nz, double amplitude, std::mt19937& random) {
  const Mesh mesh = make_box({.size = {double(nx), double(ny), double(nz)}, .cells = {nx, ny, nz}});
  const int reach = static_cast<int>(amplitude * 1024);
  std::uniform_int_distribution<int> step(-reach, reach);
  Block block{CellComplex(mesh.hexahedra, static_cast<Index>(mesh.points.size())), {}};
  for (const Vec3& p : mesh.points) {
    for (const double x : p) block.rows.push_back(x + step(random) / 1024.0);
    block.rows.push_back(0);
  }
  return block;
}

TriangleSurface random_surface(Index points, Index triangles, double unit, std::mt19937& random) {
  TriangleSurface surface{"random", {}, {}};
  std::uniform_int_distribution<int> coordinate(0, static_cast<int>(7 / unit));
  std::uniform_int_distribution<Index> corner(0, points - 1);
  for (Index i = 0; i < points; ++i) {
    Vec3& p = surface.points.emplace_back();
    for (double& x : p) x = -1 + unit * coordinate(random);
  }
  for (Index i = 0; i < triangles; ++i)
    surface.triangles.push_back({corner(random), corner(random), corner(random)});
  return surface;
}

bool crosses_exactly(const std::array<Vec3, 3>& triangle, const Vec3& from, const Vec3& to) {
  const Whole p = whole(triangle[0]), q = whole(triangle[1]), r = whole(triangle[2]);
  const Whole a = whole(from), b = whole(to);
  if ((side(p, q, r, a) >= 0) == (side(p, q, r, b) >= 0)) return false;
  const int s[3] = {side(a, b, p, q), side(a, b, q, r), side(a, b, r, p)};
  const bool all_left = s[0] >= 0 && s[1] >= 0 && s[2] >= 0;
  const bool all_right = s[0] <= 0 && s[1] <= 0 && s[2] <= 0;
  return all_left || all_right;
}

std::vector<Dart> every_face_against_every_triangle(const TriangleSurface& surface,
                                                    const Block& block) {
  std::vector<Dart> faces;
  for (Index e = 0; e < block.complex.element_count(); ++e)
    for (int f = 0; f < 6; ++f) {
      const Index n = block.complex.neighbour(e, f);
      if (n == none || n < e) continue;
      const Vec3 a = xyz(centroid_of(block.complex.vertices_of(e), block.places()));
      const Vec3 b = xyz(centroid_of(block.complex.vertices_of(n), block.places()));
      for (const Triangle& t : surface.triangles) {
        if (!crosses_exactly({surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]}, a,
                             b))
          continue;
        faces.push_back(24 * e + 4 * f);
        break;
      }
    }
  return faces;
}

}  // namespace suture::test
