// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// Leaves out the elements that import_mesh() refuses because of their shape: those with the same
/// point twice, those with a corner Jacobian <= 0 (with `allow_inverted_rest`, only if the Jacobian
/// at a Gauss point is <= 0, too) and those that are inside out and overlap their neighbours. The
/// other elements keep their numbers and their sets, the points stay, and one warning gives the
/// number of bad elements and the first of them; a second one is issued if the mesh falls into more
/// pieces than before. Throws TopologyError if no element is left. Elements with a point that does
/// not exist or is not finite stay: import_mesh() refuses them.
void drop_bad_elements(Mesh& mesh, bool allow_inverted_rest, Diagnostics& diagnostics);

}  // namespace suture
