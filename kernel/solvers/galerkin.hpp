// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/solvers/block_rows.hpp"
#include "kernel/solvers/diagonal_blocks.hpp"
#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

/// P^T A P of the tangent matrix, on its free components, with P an interpolation to the vertices.
/// If `diagonal` is given, it becomes the diagonal blocks of A itself. One visit of the matrices of
/// all cells.
BlockRows<double> project(const TangentMatrix& a, const Interpolation& p,
                          const BlockPattern& pattern, DiagonalBlocks* diagonal = nullptr);

/// P^T A P of a coarse level.
BlockRows<double> project(const BlockRows<double>& a, const Interpolation& p,
                          const BlockPattern& pattern);

/// Sets the rows and columns of components that are held to 0.
void hold(BlockRows<double>& a, const Held& held);

/// Every vertex is its own coarse node: P is the identity.
Interpolation identity(const NodeGraph& graph);

}  // namespace suture
