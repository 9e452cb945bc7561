// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>
#include <vector>

#include "kernel/mesh/box.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/dart.hpp"

namespace suture {

/// A block that falls apart at random faces, with its points scattered.
struct Soup {
  CellComplex complex;
  std::vector<double> positions;
  std::vector<Index> piece_of;

  explicit Soup(unsigned seed) {
    std::mt19937 random(seed);
    Mesh mesh = make_box({.size = {5, 5, 5}, .cells = {5, 5, 5}});
    complex = CellComplex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
    std::vector<Dart> faces;
    for (Dart d = 0; d < face_dart(complex.element_count(), 0); d += hexahedron::darts_per_face)
      if (complex.can_cut(d) && random() % 4 != 0) faces.push_back(d);
    complex.cut(faces);
    std::uniform_real_distribution<double> scatter(-0.4, 0.4);
    positions.resize(4 * std::size_t{complex.count(0)});
    piece_of.resize(complex.count(0), none);
    const std::vector<Index> islands = complex.islands();
    for (Index e = 0; e < complex.element_count(); ++e)
      for (std::size_t i = 0; i < 8; ++i) {
        const Index v = complex.vertices_of(e)[i];
        piece_of[v] = islands[e];
        for (std::size_t c = 0; c < 3; ++c)
          positions[4 * std::size_t{v} + c] = mesh.points[mesh.hexahedra[e][i]][c];
      }
    for (double& c : positions) c += scatter(random);
  }
};

}  // namespace suture
