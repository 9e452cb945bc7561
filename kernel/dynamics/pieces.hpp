// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/attributes/attributes.hpp"

namespace suture {

/// The connected piece (island) that each vertex belongs to, numbered from the largest (in
/// vertices); `none` for vertices without an element. What a model on lips holds together is one
/// piece. O(elements).
std::vector<Index> pieces_of(const CellComplex& complex, const Attributes& attributes);

}  // namespace suture
