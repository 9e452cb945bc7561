// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/solvers/coarsening.hpp"
#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

/// The nodes of cells of link_functor of a matrix, as cells of a graph without places. They are
/// asked about, not computed, where terms allow that.
NodeGraph links_of(const TangentMatrix& a);

/// The coarse nodes of these cells.
NodeGraph coarser_links(const NodeGraph& links, const Interpolation& p, Index coarse_nodes);

}  // namespace suture
