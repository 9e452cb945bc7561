// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/suture-bench/work_cases.hpp"

namespace suture::bench {

// Static problems on solids whose references are CalculiX's own finest values, extrapolated
// (work-precision --references), and published ones.

/// A bar twisted by 90 degrees: the torque.
WorkCase twist_case();
/// Cook's membrane, a skew plate in plane strain under a small shear load: its corner.
WorkCase membrane_case();
/// A cantilever with a slit from above to half its height: its tip.
WorkCase slit_case();
/// A kidney of voxels that hangs from one end, each voxel divided into equal cubes: its other end.
WorkCase organ_case();

}  // namespace suture::bench
