// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/attributes/instance.hpp"

namespace suture {

/// Whether the functor is for the cell of this row of its dimension's table: rest shapes of
/// elements, boundary or interior faces.
bool admits(const Instance& instance, const suture_functor& functor, const CellComplex& complex,
            Index row);

/// Runs SUTURE_INSPECT_1 of each functor of the instance that has it and is
/// enabled over the cells the functor is for, at rest, and hands the findings on.
/// `mass`: the kernel's column. Throws InputError for errors the model reports.
/// O(cells) for such functors, nothing for others.
void inspect(Instance& instance, const RestPlaces& rest, const Column& mass,
             std::span<const Index> user_element, Diagnostics& diagnostics);

}  // namespace suture
