// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

namespace suture::bench {

/// A baseline of the cut: a mesh that is cut face by face. Darts are 24 e + 4 f + k
/// in the numbers of the mesh.
class CutBaseline {
 public:
  virtual ~CutBaseline() = default;
  virtual void cut(const std::vector<Dart>& faces) = 0;
  /// Sum over all particles, kg.
  virtual double mass() = 0;
};

/// The paper's model as the paper has it: CGAL's linear cell complex; particles,
/// springs, faces and elements (with their dart[6][4] and inner springs) are attributes
/// of its cells; unsew<3> splits them and calls functors that sum masses and
/// stiffnesses again.
std::unique_ptr<CutBaseline> make_cgal_cut(const Mesh& mesh);

/// The model before it (Flechon 2013, sections 3 and 4.3 of the paper): the same
/// complex, but each spring points to its two particles, inner springs belong to the
/// object and not to elements, and each particle lists its inner springs. After a face
/// is cut the lists of split particles are split and the ends of springs set right.
std::unique_ptr<CutBaseline> make_flechon_cut(const Mesh& mesh);

}  // namespace suture::bench
