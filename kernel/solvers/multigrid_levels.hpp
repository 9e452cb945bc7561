// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>

#include "kernel/solvers/chebyshev.hpp"
#include "kernel/solvers/factored_rows.hpp"

namespace suture {

/// A level of a multigrid hierarchy. The finest one is that of the vertices.
struct MultigridLevel {
  const Workers* workers = nullptr;  ///< they share loops over its rows
  Interpolation to_finer;            ///< not of the finest level
  Interpolation from_finer;          ///< its transpose
  std::vector<Vec3> places;          ///< NodeGraph::places; not of the finest level
  Held held;                         ///< 3 per node
  std::vector<Index> held_places;    ///< those of `held` in rows of 4
  std::vector<bool> loose;           ///< nodes of pieces that nothing holds
  BlockPattern pattern;              ///< not of the finest level
  BlockRows<float> matrix;           ///< not of the finest and the coarsest level
  SingleProduct multiply;
  Chebyshev smoother;
  SingleVector x, r, correction;  ///< scratch

  std::size_t nodes() const { return held.size() / 3; }
  std::size_t bytes() const;
};
/// Levels do not move.
using MultigridLevels = std::deque<MultigridLevel>;

/// The hierarchy of a body with these free components, without operators: until a level has at most
/// `coarsest_nodes` nodes, or coarsening gains little.
MultigridLevels make_levels(const NodeGraph& vertices, const std::vector<std::uint8_t>& free,
                            Index coarsest_nodes, const Workers* workers);

// Between a level and the next finer one, in rows of 4:
/// fine = P coarse.
void interpolate(const MultigridLevel& level, const float* coarse, float* fine);
/// coarse = P^T fine.
void restrict(const MultigridLevel& level, const float* fine, float* coarse);
/// Sets the components that are held to 0.
void hold(const MultigridLevel& level, float* v);

/// Inverts the diagonal blocks of a level for its smoother, and estimates the spectrum.
void set_smoother(MultigridLevel& level, DiagonalBlocks diagonal);

/// Sets the operator of a coarse level, and its smoother.
void set_operator(MultigridLevel& level, const BlockRows<double>& rows);

/// The V-cycle on levels l, l+1, ...; the last one is solved by `coarsest`.
class VCycle {
 public:
  VCycle(MultigridLevels& levels, const FactoredRows& coarsest, unsigned smoothing)
      : levels_(levels), coarsest_(coarsest), smoothing_(smoothing) {}

  /// x = approximately A^-1 r on level l; destroys r.
  void run(std::size_t l) const;
  /// r of the next coarser level = P^T r.
  void restrict(std::size_t l) const;

 private:
  void solve_coarsest() const;
  void prolong(std::size_t l) const;

  MultigridLevels& levels_;
  const FactoredRows& coarsest_;
  unsigned smoothing_;
};

}  // namespace suture
