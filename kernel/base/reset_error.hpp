// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdint.h>

#include "suture/plugin.h"

namespace suture {

/// Resets the error before a plugin is called: no error, no cell, no proposed step. Static, because
/// the loops are compiled for several instruction sets (forces/loops/loops.hpp).
static inline void reset(suture_error& error) {
  error.size = sizeof(suture_error);
  error.code = 0;
  error.cell = UINT32_MAX;
  error.reserved = 0;
  error.step_factor = 0;
  error.text[0] = 0;
}

}  // namespace suture
