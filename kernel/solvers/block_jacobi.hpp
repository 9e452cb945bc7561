// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "kernel/solvers/preconditioner.hpp"

namespace suture {

/// The inverses of the 3 x 3 blocks of every vertex on the diagonal. The reference for all other
/// preconditioners, and the best of them for few vertices or a dominant mass. Memory: 72 B per
/// vertex. build(): one visit of the matrices of all cells.
std::unique_ptr<Preconditioner> make_block_jacobi();

}  // namespace suture
