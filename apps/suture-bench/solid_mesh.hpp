// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "kernel/mesh/mesh.hpp"

namespace suture::bench {

/// Hexahedra with 8 or 20 nodes in CalculiX's order: corners, then the middles of the edges below,
/// above and between. Nodes at corners come first and have the numbers of the mesh.
struct SolidMesh {
  /// Halfway between two corners; at a corner, the same one twice.
  struct Node {
    Index first, second;
    bool is_corner() const { return first == second; }
  };
  std::vector<Vec3> points;
  std::vector<Node> nodes;
  std::vector<std::vector<Index>> elements;
  bool quadratic = false;
};

SolidMesh solid_mesh(const Mesh& mesh, bool quadratic);

/// The mesh after cutting the faces between pairs of elements: the elements around a node share it
/// as long as uncut faces connect them.
Mesh with_slit(Mesh mesh, std::span<const std::pair<Index, Index>> cut);

/// Forces at nodes equivalent to a uniform traction of 1 Pa on the sides that belong to one element
/// only and whose corners are all selected, m^2.
std::vector<std::pair<Index, double>> loaded_nodes(
    const SolidMesh& mesh, const std::function<bool(Index corner)>& is_selected);

}  // namespace suture::bench
