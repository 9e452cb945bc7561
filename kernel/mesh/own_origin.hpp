// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/box.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// The bounding box of the points that hexahedra use, m, relative to the mesh's origin. Zero if
/// there are none or a coordinate is not finite (the import refuses such a mesh).
Box box_of(const Mesh& mesh);

/// Makes the points relative to the lower corner of that box. A mesh whose corner is at 0 keeps all
/// its bits. O(points).
void move_to_own_origin(Mesh& mesh);

}  // namespace suture
