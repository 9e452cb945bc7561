// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/topology/cell_complex.hpp"

// Why hourglassing needs a check of its own
// =========================================
//
//   + - + -       A lattice of edges and inner diagonals has motions without energy,
//   - + - +       u_a = (-1)^(b+c). Under load it leaves the smooth state along them and comes to a
//   + - + -       true, stable rest. Neither the residual nor the lowest eigenvalue reveals it.
//
// Amplitude over strain, the largest of all elements; and the number of elements above 0.5 (tip of
// the cantilever, 4 averaging passes):
//
//   load                                  g/100    g/10        g/4         g
//   tm-faure 5x5x20                       0.06, 0  0.06, 0     0.06, 0     0.07, 0
//   mss-baudet, corrected, 5x5x20         0.06, 0  0.06, 0     3.2, 476    3.0, 491
//   the same, 10x10x40                    0.06, 0  7.3, 3918   5.7, 3977   3.0, 3957
//
// Stretching and compressing by 10 % hourglasses the lattice at 12x3x3 and finer, and compressing
// by 1 % at 10x10x40. It gets worse under refinement. With tm-faure, these stay below 0.35: twists
// by 90 and 360 degrees, stretches by 60 %, nu from 0 to 0.499, waves after a sudden load, holes
// and cuts.
//
// The measure needs no neighbours and no orientation of the elements. A single averaging pass
// gives 0.55 at the tip of a cut.

namespace suture {

/// The alternating (checkerboard) part of a deformation, element by element.
///
/// In an element, the residual of the constant gradient F that maps its mean edges at rest to the
/// current ones,
///   r_n = (x_n - mean x) - F (X_n - mean X)
/// is the part that no constant strain explains. Smooth bending has such a residual too, but there
/// the residuals of the elements around a vertex cancel, whereas those of a checkerboard are equal.
/// So the mean over these elements is the alternating part,
///   w_v = mean of r,
/// except for a remainder if the residual varies from element to element. Applying the same
/// operation to w instead of x removes that remainder to second order and preserves a checkerboard;
/// it is applied three times. At vertices with fewer than four elements (edges of the body) nothing
/// can cancel, so w is 0 there.
///
///   amplitude  a = 2 sqrt(mean |r(w)_n|^2) / V^(1/3)
/// is the strain of the alternating part, to be compared with
///   strain     |E|, E = (F^T F - 1) / 2, Frobenius
/// Memory: 52 B per vertex and 16 B per element. O(elements).
///
/// The measure is content() = a / |E|. Smooth deformations of both models with at least 2 elements
/// across (bent, twisted by 90 degrees, stretched, vibrating) give less than 0.11; the tip of a cut
/// 0.33; a force on a single node 1.2 in the 16 elements around it. Lattices of springs that
/// hourglass give 1 to 9 in nearly all elements.
struct Hourglass {
  std::vector<double> amplitude;  ///< per element; 0 for removed ones
  std::vector<double> strain;
  double mean_strain = 0;  ///< root mean square over the elements
  double noise = 0;        ///< the largest amplitude that rounding can cause

  /// Amplitude over the larger of the element's strain and the mean strain; 0 for noise.
  double content(Index element) const;
};

Hourglass measure_hourglass(const CellComplex& complex, Attributes& attributes);

}  // namespace suture
