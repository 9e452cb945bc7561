// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Linear_cell_complex_for_combinatorial_map.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

/// What the two baselines on CGAL's linear cell complex share. Included by
/// cgal_cut.cpp and flechon_cut.cpp only: CGAL's headers are heavy.
namespace suture::bench::lcc {

template <class Items>
using Complex = CGAL::Linear_cell_complex_for_combinatorial_map<
    3, 3, CGAL::Linear_cell_complex_traits<3, CGAL::Exact_predicates_inexact_constructions_kernel>,
    Items>;

/// What a cube gives to its vertices and edges: rho V / 8, and k_e of the paper's
/// springs (formulas of plugins/mss-baudet).
struct Share {
  double mass = 0, stiffness = 0, tension = 0;

  explicit Share(double volume = 0) {
    constexpr double E = 400e3, nu = 0.3, rho = 1000;
    const double length = std::cbrt(volume);
    mass = rho * volume / 8;
    stiffness = E * length * (1 + 4 * nu) / (8 * (1 + nu));
    tension = stiffness * length;
  }
};

/// What the paper stores of a particle besides its point.
struct Motion {
  std::array<double, 3> velocity{}, acceleration{}, force{};
};

/// Makes the hexahedra and 3-sews them, matched by their points' numbers. Returns the
/// darts 24 e + 4 f of all faces, f and e as in the kernel: 6 e + f.
template <class Map>
std::vector<typename Map::Dart_handle> build(Map& map, const Mesh& mesh) {
  using Handle = typename Map::Dart_handle;
  using Face = std::array<Index, 4>;
  struct Hash {
    std::size_t operator()(const Face& f) const {
      return (f[0] + std::size_t{f[1]} + f[2] + f[3]) * 0x9E3779B97F4A7C15u;
    }
  };
  std::vector<Handle> faces;
  std::unordered_map<Face, std::pair<Handle, Index>, Hash> open;  // dart, its first point
  for (const Hexahedron& h : mesh.hexahedra) {
    const auto x = [&](int i) {
      const Vec3& p = mesh.points[h[i]];
      return typename Map::Point(p[0], p[1], p[2]);
    };
    std::array<Handle, 6> face;
    face[0] = map.make_hexahedron(x(2), x(0), x(1), x(3), x(7), x(6), x(4), x(5));
    for (int j = 1; j < 4; ++j) face[j] = map.beta(face[j - 1], 1, 1, 2);
    face[4] = map.beta(face[0], 0, 2);
    face[5] = map.beta(face[3], 1, 2);
    for (int f = 0; f < 6; ++f) {
      faces.push_back(face[f]);
      Face points;
      for (int k = 0; k < 4; ++k) points[k] = h[hexahedron::dart_vertex[4 * f + k]];
      const Index first = points[0], second = points[1];
      std::ranges::sort(points);
      const auto [it, fresh] = open.try_emplace(points, face[f], first);
      if (fresh) continue;
      // The dart there that starts where ours ends.
      Handle there = it->second.first;
      const typename Map::Point& end = map.point(map.beta(face[f], 1));
      if (it->second.second != second) do
          there = map.beta(there, 1);
        while (map.point(there) != end);
      map.template sew<3>(face[f], there);
      open.erase(it);
    }
  }
  return faces;
}

template <int Dimension, class Map>
void add_attributes(Map& map) {
  for (auto d = map.darts().begin(); d != map.darts().end(); ++d)
    if (map.template attribute<Dimension>(d) == map.null_handle)
      map.template set_attribute<Dimension>(d, map.template create_attribute<Dimension>());
}

/// The box of an element has edges along the first darts of three faces around X0.
template <class Map>
double volume(Map& map, typename Map::Dart_handle first) {
  const auto edge = [&](typename Map::Dart_handle d) {
    return std::sqrt(
        CGAL::to_double(CGAL::squared_distance(map.point(d), map.point(map.beta(d, 1)))));
  };
  return edge(first) * edge(map.beta(first, 1)) * edge(map.beta(first, 2, 1));
}

/// Mass and stiffness of a cell are sums over its elements; when one cell becomes two,
/// the new one's are summed and the old one keeps the rest. At a vertex an element has
/// three darts, at an edge two.
template <class Map>
struct Sums {
  Map& map;

  template <class Attribute>
  void split_vertex(Attribute& old, Attribute& fresh) const {
    double mass = 0;
    for (auto d = map.template darts_of_cell<0>(fresh.dart()).begin(); d.cont(); ++d)
      mass += map.template info<3>(d).share.mass;
    fresh.info().mass = mass / 3;
    old.info().mass -= mass / 3;
  }

  template <class Attribute>
  void split_edge(Attribute& old, Attribute& fresh) const {
    double stiffness = 0, tension = 0;
    for (auto d = map.template darts_of_cell<1>(fresh.dart()).begin(); d.cont(); ++d) {
      stiffness += map.template info<3>(d).share.stiffness;
      tension += map.template info<3>(d).share.tension;
    }
    fresh.info().stiffness = stiffness / 2;
    fresh.info().tension = tension / 2;
    old.info().stiffness -= stiffness / 2;
    old.info().tension -= tension / 2;
  }

  /// At the start; `faces` as build() returns them.
  void fill(const std::vector<typename Map::Dart_handle>& faces) const {
    for (std::size_t e = 0; e < faces.size() / 6; ++e)
      map.template info<3>(faces[6 * e]).share = Share(volume(map, faces[6 * e]));
    for (auto d = map.darts().begin(); d != map.darts().end(); ++d) {
      const Share& share = map.template info<3>(d).share;
      map.template info<0>(d).mass += share.mass / 3;
      map.template info<1>(d).stiffness += share.stiffness / 2;
      map.template info<1>(d).tension += share.tension / 2;
    }
  }
};

/// Totals of all cells, by which tests and the benchmark see that nothing is lost.
template <class Map>
double total_mass(Map& map) {
  double sum = 0;
  for (auto& attribute : map.template attributes<0>()) sum += attribute.info().mass;
  return sum;
}

}  // namespace suture::bench::lcc
