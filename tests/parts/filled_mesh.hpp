// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

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

/// The volume of the material in each element.
inline std::vector<double> volumes_of_elements(const Mesh& mesh) {
  std::vector<double> volumes(mesh.hexahedra.size(), std::pow(edge_of(mesh), 3));
  for (std::size_t p = 0; p < mesh.parts.elements.size(); ++p)
    volumes[mesh.parts.elements[p]] *= mesh.parts.moments[p].fraction;
  return volumes;
}

/// How much of what an element holds belongs to a set, by volume.
inline double share_of(const Mesh& mesh, Index e, const std::string& set) {
  double sum = 0;
  bool is_mixed = false;
  for (const auto& [element, material, fraction] : mesh.mixtures.shares) {
    if (element != e) continue;
    is_mixed = true;
    const std::vector<Index>& materials = mesh.mixtures.materials.at(set);
    if (std::binary_search(materials.begin(), materials.end(), material)) sum += fraction;
  }
  const std::vector<Index>& members = mesh.element_sets.at(set);
  return is_mixed ? sum : std::binary_search(members.begin(), members.end(), e) ? 1 : 0;
}

}  // namespace suture::test
