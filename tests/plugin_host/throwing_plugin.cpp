// SPDX-License-Identifier: GPL-3.0-or-later
// A plugin whose one exported function throws.
#include <stdexcept>

#include "suture/note.h"

SUTURE_NOTE(TEST_ID, TEST_ID)

extern "C" const suture_plugin* suture_plugin_v1() { throw std::runtime_error("no tables today"); }
