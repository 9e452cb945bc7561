// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "suture/parts.h"

namespace suture {

/// Whether a cell column of a functor on parts is one of the kernel: SUTURE_PART_COLUMN, or
/// SUTURE_GENERAL_PART_COLUMN.
constexpr bool is_part_column(std::uint32_t place) {
  return place == SUTURE_PART_COLUMN || place == SUTURE_GENERAL_PART_COLUMN;
}

/// The attribute behind a cell column of a functor: one of the model's, or of the kernel.
const suture_attribute& cell_attribute(const suture_model& model, std::uint32_t place);

/// The extension of the functor for elements of which only a part is material: suture.parts/1, or
/// suture.parts/2 if its shape is SUTURE_GENERAL.
const char* parts_extension(const suture_functor& functor);

/// Whether the functor may run on bodies with such elements.
bool allows_parts(const suture_functor& functor);

/// The functor that computes the same on such elements, in this host's own struct, which is kept;
/// null for functors of other dimensions, and for those that do not offer it. [main]
const suture_functor* functor_on_parts(const suture_functor& functor);

}  // namespace suture
