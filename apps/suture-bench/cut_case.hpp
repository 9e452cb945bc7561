// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

namespace suture::bench {

/// A mesh and the faces of successive cuts, darts 24 e + 4 f in the mesh's numbers; no
/// face is in two cuts.
struct CutCase {
  std::string name;
  Mesh mesh;
  std::vector<std::vector<Dart>> cuts;

  std::size_t faces() const;
};

/// The paper's Fig. 5: n x n x 2 elements of 1 m, all faces between the two layers; or
/// the first `most` of them.
CutCase two_layers(Index n, std::size_t most = ~std::size_t{0});

/// The paper's Table 1: a body (body_presets()) filled with cubes, and its cut.
CutCase body_case(const std::string& name);

/// The paper's Fig. 11: ten planes through the giraffe, one after the other, each
/// across another place or in another direction.
CutCase ten_cuts();

}  // namespace suture::bench
