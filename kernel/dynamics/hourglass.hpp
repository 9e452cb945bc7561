// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The alternating (checkerboard) part of a deformation, element by element.
///
/// In an element the residual of the constant gradient F that maps its mean edges at rest
/// to those now,
///   r_n = (x_n - mean x) - F (X_n - mean X)
/// is what no constant strain explains. Smooth bending has it too, but then neighbours
/// agree, so that the residuals of the elements around a vertex cancel there; those of a
/// checkerboard are equal. So the mean over these elements is the alternating part,
///   w_v = mean of r,
/// but for what a residual that varies from element to element leaves of it. The same
/// operation, with w for x, takes that away to second order and keeps a checkerboard; it is
/// done three times. At vertices of fewer than four elements (edges of the body) nothing can
/// cancel: w is 0 there.
///
///   amplitude  a = 2 sqrt(mean |r(w)_n|^2) / V^(1/3)
/// is the strain of the alternating part, and to be compared with
///   strain     |E|, E = (F^T F - 1) / 2, Frobenius
/// Memory: 52 B per vertex and 16 B per element. O(elements).
///
/// The figure is content() = a / |E|. Smooth deformations of both models, from 2 elements
/// across, bent, twisted by 90 degrees, pulled, vibrating: below 0.11; the tip of a cut 0.33;
/// a force on one node 1.2 in 16 elements around it. Lattices of springs that hourglass: 1 to
/// 9, in nearly all elements.
struct Hourglass {
  std::vector<double> amplitude;  ///< of each element; 0 where there is none any more
  std::vector<double> strain;
  double mean_strain = 0;  ///< root of the mean square over the elements
  double noise = 0;        ///< an amplitude that rounding can make

  /// Amplitude over strain, the element's or the body's, whichever is larger; 0 for noise.
  double content(Index element) const;
};

Hourglass measure_hourglass(const CellComplex& complex, Attributes& attributes);

}  // namespace suture
