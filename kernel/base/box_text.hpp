// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/types.hpp"

namespace suture {

/// "[0, 0, 0] to [1, 0.25, 0.25]": two corners of a box, with at least `digits` digits, and more if
/// they are needed to show the size of a small box far from 0.
std::string box_text(const Vec3& low, const Vec3& high, int digits);

}  // namespace suture
