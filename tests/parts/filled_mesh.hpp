// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "kernel/mesh/mesh.hpp"

namespace suture::test {

/// The edge of the cubes of a mesh that fills a surface.
inline double edge_of(const Mesh& mesh) {
  return mesh.points[mesh.hexahedra[0][1]][0] - mesh.points[mesh.hexahedra[0][0]][0];
}

/// The volume of its material, by the fractions of its elements.
inline double volume_of(const Mesh& mesh) {
  double cubes = double(mesh.hexahedra.size() - mesh.parts.elements.size());
  for (const PartMoments& moments : mesh.parts.moments) cubes += moments.fraction;
  return cubes * std::pow(edge_of(mesh), 3);
}

}  // namespace suture::test
