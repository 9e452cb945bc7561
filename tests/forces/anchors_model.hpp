// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "suture/plugin.h"

/// A model of the C++ layer with a functor on vertices: every vertex hangs by a spring from where
/// it was at rest, and is braked by its mass.
const suture_model& anchors_model();
