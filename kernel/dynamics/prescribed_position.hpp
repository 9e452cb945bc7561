// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/constraints.hpp"

namespace suture {

/// The position at time t (s) that the motion prescribes for a vertex with this rest position, m.
Vec3 prescribed_position(const PrescribedMotion& motion, const Vec3& rest, double t);

}  // namespace suture
