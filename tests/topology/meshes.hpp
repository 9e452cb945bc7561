// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <random>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/cell_complex.hpp"

/// Tiny named meshes, and random ones, on the unit lattice.
namespace suture::meshes {

using Filled = std::function<bool(int, int, int)>;

/// Unit cubes where `filled`, over shared lattice points, x fastest.
inline Mesh voxels(int nx, int ny, int nz, const Filled& filled) {
  Mesh mesh;
  mesh.source = "voxels";
  std::map<std::array<int, 3>, Index> point;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        if (!filled(x, y, z)) continue;
        Hexahedron h;
        for (int i = 0; i < 8; ++i) {
          const std::array<int, 3> p{x + (i & 1), y + (i >> 1 & 1), z + (i >> 2 & 1)};
          const auto [it, fresh] = point.try_emplace(p, static_cast<Index>(mesh.points.size()));
          if (fresh) mesh.points.push_back({double(p[0]), double(p[1]), double(p[2])});
          h[i] = it->second;
        }
        mesh.hexahedra.push_back(h);
      }
  return mesh;
}

inline Mesh grid(int nx, int ny, int nz) {
  return voxels(nx, ny, nz, [](int, int, int) { return true; });
}

inline Mesh two_cubes() { return grid(2, 1, 1); }

/// Eight cubes around a hole: genus 1.
inline Mesh ring_of_eight() {
  return voxels(3, 3, 1, [](int x, int y, int) { return x != 1 || y != 1; });
}

/// n elements around one axis, each between two half-planes: a fan of any valence,
/// closed to a full turn.
inline Mesh wheel(int n) {
  Mesh mesh;
  mesh.source = "wheel";
  const double turn = 2 * 3.14159265358979323846 / n;
  // Each element's cross-section is the quadrilateral axis, spoke, rim, next spoke.
  for (int z = 0; z < 2; ++z) {
    mesh.points.push_back({0, 0, double(z)});
    for (int i = 0; i < n; ++i) {
      mesh.points.push_back({std::cos(i * turn), std::sin(i * turn), double(z)});
      mesh.points.push_back(
          {1.5 * std::cos((i + .5) * turn), 1.5 * std::sin((i + .5) * turn), double(z)});
    }
  }
  const auto at = [&](int i, int z) { return static_cast<Index>(z * (2 * n + 1) + i); };
  for (int i = 0; i < n; ++i) {
    Hexahedron h;
    for (int z = 0; z < 2; ++z) {
      h[4 * z + 0] = at(0, z);
      h[4 * z + 1] = at(1 + 2 * i, z);
      h[4 * z + 2] = at(1 + 2 * ((i + 1) % n), z);
      h[4 * z + 3] = at(2 + 2 * i, z);
    }
    mesh.hexahedra.push_back(h);
  }
  return mesh;
}

/// Each cube with probability `fill`: islands, holes, tunnels and non-manifold cells.
inline Mesh blob(int n, double fill, std::mt19937& random) {
  std::bernoulli_distribution yes(fill);
  std::vector<bool> filled(static_cast<std::size_t>(n * n * n));
  for (std::size_t i = 0; i < filled.size(); ++i) filled[i] = yes(random);
  filled[0] = true;
  return voxels(n, n, n, [&](int x, int y, int z) { return filled[(z * n + y) * n + x]; });
}

/// The same mesh with its elements and points in random order.
inline Mesh shuffled(const Mesh& mesh, std::mt19937& random) {
  Mesh result = mesh;
  std::vector<Index> place(mesh.points.size());
  std::iota(place.begin(), place.end(), Index{0});
  std::shuffle(place.begin(), place.end(), random);
  for (std::size_t p = 0; p < place.size(); ++p) result.points[place[p]] = mesh.points[p];
  for (Hexahedron& h : result.hexahedra)
    for (Index& v : h) v = place[v];
  std::shuffle(result.hexahedra.begin(), result.hexahedra.end(), random);
  return result;
}

/// Each element numbered from another of its corners, the same way round: neighbours
/// then meet in all of the turns that a foreign mesh may have.
inline Mesh turned(const Mesh& mesh, std::mt19937& random) {
  constexpr std::array<std::array<int, 8>, 2> quarter_turns = {{
      {1, 3, 0, 2, 5, 7, 4, 6},  // about z
      {4, 5, 0, 1, 6, 7, 2, 3},  // about x
  }};
  Mesh result = mesh;
  for (Hexahedron& h : result.hexahedra)
    for (auto turns = random() % 12; turns > 0; --turns) {
      const Hexahedron before = h;
      const auto& turn = quarter_turns[random() % 2];
      for (std::size_t i = 0; i < 8; ++i) h[i] = before[static_cast<std::size_t>(turn[i])];
    }
  return result;
}

/// A cylinder as mesh generators make it: a core of m x m cells in the cross-section,
/// around it layers of cells that go over from the square to the circle; axes where
/// three and where five elements meet. Without the core a pipe, of genus 1.
inline Mesh o_grid(int m, int layers, int height, bool core) {
  Mesh mesh;
  mesh.source = "O-grid";
  std::map<std::array<int, 4>, Index> point;  // ring (0: core), place on it, second, z
  const auto at = [&](std::array<int, 4> key, double x, double y) {
    const auto [it, fresh] = point.try_emplace(key, static_cast<Index>(mesh.points.size()));
    if (fresh) mesh.points.push_back({x, y, double(key[3])});
    return it->second;
  };
  const auto square = [&](int i, int j, int z) {
    return at({0, i, j, z}, 2.0 * i / m - 1, 2.0 * j / m - 1);
  };
  const auto ring = [&](int r, int place, int z) {  // the rim of the square, then outward
    place %= 4 * m;
    const int side = place / m, step = place % m;
    const int i = side == 0 ? step : side == 1 ? m : side == 2 ? m - step : 0;
    const int j = side == 0 ? 0 : side == 1 ? step : side == 2 ? m : m - step;
    if (r == 0) return square(i, j, z);
    const double x = 2.0 * i / m - 1, y = 2.0 * j / m - 1, part = double(r) / layers;
    const double scale = 1 - part + 3 * part / std::hypot(x, y);
    return at({r, place, 0, z}, x * scale, y * scale);
  };
  for (int z = 0; z < height; ++z) {
    const auto add = [&](const auto& corner) {
      mesh.hexahedra.push_back({corner(0, 0, z), corner(1, 0, z), corner(0, 1, z), corner(1, 1, z),
                                corner(0, 0, z + 1), corner(1, 0, z + 1), corner(0, 1, z + 1),
                                corner(1, 1, z + 1)});
    };
    for (int i = 0; core && i < m; ++i)
      for (int j = 0; j < m; ++j)
        add([&](int a, int b, int level) { return square(i + a, j + b, level); });
    for (int r = 0; r < layers; ++r)
      for (int p = 0; p < 4 * m; ++p)
        add([&](int a, int b, int level) { return ring(r + 1 - b, p + a, level); });
  }
  return mesh;
}

inline CellComplex complex_of(const Mesh& mesh) {
  CellComplex complex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
  complex.require_edges();
  complex.require_faces();
  return complex;
}

/// One dart of each face between two elements, ascending.
inline std::vector<Dart> interior_faces(const CellComplex& complex) {
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
    if (complex.beta3(d) != none && d < complex.beta3(d)) faces.push_back(d);
  return faces;
}

}  // namespace suture::meshes
