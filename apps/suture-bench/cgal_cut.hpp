// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

namespace suture::bench {

/// The base line of the cut: the same hexahedra in CGAL's linear cell complex with
/// attributes on vertices, edges and faces (as many as the map of ours has ids), cut
/// face by face with unsew<3>, which splits them. CGAL stays in one translation unit.
class CgalCut {
 public:
  explicit CgalCut(const Mesh& mesh);
  ~CgalCut();
  /// Unsews these faces (darts 24 e + 4 f + k).
  void cut(const std::vector<Dart>& faces);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture::bench
