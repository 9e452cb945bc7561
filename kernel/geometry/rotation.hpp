// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "kernel/base/types.hpp"

namespace suture {

/// The rows of a rotation matrix.
using Rotation = std::array<Vec3, 3>;
constexpr Rotation no_rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

// A rotation vector turns by its length, in rad, about its direction.

/// exp(by) R. The result is orthogonal to rounding even after many turns.
Rotation turned(const Vec3& by, const Rotation& r);
/// The vector, of at most pi, that turns one to the other: log(to from^T).
Vec3 rotation_between(const Rotation& from, const Rotation& to);

}  // namespace suture
