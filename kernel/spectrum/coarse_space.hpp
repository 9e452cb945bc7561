// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// A few hundred smooth motions of a body: trilinear functions on a grid of boxes around its rest
/// shape, three components each, with separate nodes for every island (crumbs beyond the limit have
/// none). On request also the same functions on a coarser grid times the checkerboards that
/// lattices of springs do not resist (u_a = s_b s_c, where s = +-1 is the side of a node along an
/// axis of the elements).
///
/// Motions are vectors y = sqrt(m) u, 3 numbers per vertex, 0 for constrained components. Memory:
/// 100 B per vertex and grid.
class CoarseSpace {
 public:
  /// At most `nodes` grid nodes. `scale`: 1/sqrt(m) per component, 0 if constrained.
  CoarseSpace(const CellComplex& complex, Attributes& attributes, const std::vector<double>& scale,
              Index nodes);

  /// Adds the checkerboards, at most `nodes` grid nodes.
  void add_checkerboards(const CellComplex& complex, Attributes& attributes, Index nodes);

  Eigen::Index size() const { return size_; }
  /// y += c_j * (motion j) for all j.
  void prolong(const Eigen::VectorXd& c, double* y) const;
  /// The products of y with all motions.
  Eigen::VectorXd restrict(const double* y) const;

 private:
  /// The grid nodes around each vertex; -1: none.
  struct Grid {
    std::vector<std::array<std::int32_t, 8>> nodes;
    std::vector<std::array<float, 8>> weights;
    std::vector<std::uint8_t> signs;  ///< bit a: the checkerboard of component a is -1
    Eigen::Index first = 0;           ///< index of its first motion
    Eigen::Index count = 0;           ///< number of nodes
  };
  using GridNumbers = std::map<std::array<std::int64_t, 4>, std::int32_t>;  ///< place, piece
  static bool add_vertex(Grid& grid, GridNumbers& numbers, Index vertex, Index piece,
                         const Vec3& place, const Vec3& cells, std::size_t nodes, bool forced);
  Grid make_grid(const CellComplex& complex, Attributes& attributes, Index nodes) const;
  template <class Visit>
  void for_each(Visit visit) const;

  std::vector<double> mass_root_;  ///< sqrt(m) per component, 0 if constrained
  std::vector<Grid> grids_;
  Eigen::Index size_ = 0;
};

}  // namespace suture
