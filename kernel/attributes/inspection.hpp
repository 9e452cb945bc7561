// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/attributes/instance.hpp"

namespace suture {

/// Whether the functor visits the cell in this row of its dimension's table: depends on the rest
/// shapes of elements, and on whether faces are on the boundary or in the interior.
bool admits(const Instance& instance, const suture_functor& functor, const CellComplex& complex,
            Index row);

/// Runs SUTURE_INSPECT_1 of each functor of the instance that has it and is
/// enabled on the cells that the functor visits, at rest, and passes the findings on.
/// `mass`: the kernel's column. Throws InputError for errors that the model reports.
/// O(cells) for such functors, nothing for others.
void inspect(Instance& instance, const RestPlaces& rest, const Column& mass,
             std::span<const Index> user_element, Diagnostics& diagnostics);

}  // namespace suture
