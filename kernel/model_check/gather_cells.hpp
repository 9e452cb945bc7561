// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/dynamics/body.hpp"
#include "kernel/model_check/cell_batch.hpp"

namespace suture {

/// The first cells (at most 8) of a functor of an instance of the body, in its present state. An
/// independent and slow counterpart of forces/loops/gather.hpp. In a step of 10 ms;
/// velocities that enabled() has cleared are zero.
CellBatch gather_cells(Body& body, Instance& instance, const suture_functor& functor,
                       std::span<const Index> cells);

}  // namespace suture
