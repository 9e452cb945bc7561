// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/box.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// The box around the points that hexahedra use, m, from the mesh's origin. Zero where
/// there is none, or a coordinate that is not finite (the import refuses such a mesh).
Box box_of(const Mesh& mesh);

/// From now on the points count from the lower corner of that box. A mesh whose corner is
/// at 0 keeps all its bits. O(points).
void move_to_own_origin(Mesh& mesh);

}  // namespace suture
