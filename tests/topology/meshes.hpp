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

/// Each cube with probability `fill`: islands, holes, tunnels and pinched cells.
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
