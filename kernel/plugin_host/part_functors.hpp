// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "suture/parts.h"

namespace suture {

/// The attribute behind a cell column of a functor: one of the model's, or the kernel's column of
/// parts (SUTURE_PART_COLUMN).
const suture_attribute& cell_attribute(const suture_model& model, std::uint32_t place);

/// Whether the functor may run on bodies with elements of which only a part is material
/// (suture.parts/1).
bool allows_parts(const suture_functor& functor);

/// The functor that computes the same on such elements, in this host's own struct, which is kept;
/// null for functors of other dimensions, and for those that do not offer it. [main]
const suture_functor* functor_on_parts(const suture_functor& functor);

}  // namespace suture
