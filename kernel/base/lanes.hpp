// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/types.hpp"
#include "suture/plugin.h"

namespace suture {

/// Cells of a batch of doubles.
inline constexpr Index lanes = SUTURE_LANES;

}  // namespace suture
