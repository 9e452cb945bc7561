// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/solvers/multigrid_levels.hpp"

namespace suture {

/// Finds where coarsening should have ended: where slits are closer to each other than coarse
/// nodes, a coarser level no longer resolves them, and the cycle converges slowly. From the
/// coarsest levels up, a system is solved on every level by the cycle below; a level that takes too
/// many iterations is factored instead, if that is affordable.
///
/// Off grids, coarse functions of small supports are nearly dependent, and systems of coarse levels
/// converge slowly although their corrections are good. There the system is that of the finest
/// level.
class StopTest {
 public:
  /// `coarsest` becomes a factor of the level that is returned, without values. `elements`: of the
  /// body.
  StopTest(MultigridLevels& levels, FactoredRows& coarsest, unsigned smoothing, bool on_grid,
           Index elements)
      : levels_(levels),
        coarsest_(coarsest),
        cycle_(levels, coarsest, smoothing),
        on_grid_(on_grid),
        max_operations_(operations_per_element * elements),
        max_blocks_(blocks_per_element * elements),
        next_(levels.size() - 1) {}

  /// The next level to be the coarsest one, or 0 if no more is. The caller truncates the hierarchy
  /// and factors that level before the next call.
  std::size_t next_direct_level();

 private:
  /// The cost of a factor, about 10 us, and of the matrix, whose analysis takes 1 us per block.
  static constexpr double operations_per_element = 3e4, blocks_per_element = 8;

  bool converges(std::size_t l) const;
  bool make_factor(std::size_t l);
  std::size_t finest_affordable();

  MultigridLevels& levels_;
  FactoredRows& coarsest_;
  VCycle cycle_;
  bool on_grid_;
  double max_operations_, max_blocks_;
  std::size_t next_;
};

}  // namespace suture
