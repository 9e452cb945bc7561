// SPDX-License-Identifier: MIT
//
// suture/lips.hpp - the base of functors between two regions of a body: ties, adhesives.
#ifndef SUTURE_LIPS_HPP
#define SUTURE_LIPS_HPP

#include "suture/lips.h"
#include "suture/model.hpp"

namespace suture {

/// Pairs of faces, opposite each other: nodes 0..3 of the first region, with the normal towards the
/// second, and 4..7 of the second, node 4 + i opposite node i. Columns are attributes of faces.
struct on_lips : functor_defaults {
  static constexpr std::uint32_t dimension = 2, cell_type = SUTURE_LIPS;
  static constexpr int nodes = 8;
};

}  // namespace suture

#endif
