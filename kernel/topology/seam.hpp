// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// True if the face still exists and is on the boundary.
inline bool is_open(const CellComplex& complex, Dart face) {
  return complex.exists(3, element_of(face)) && complex.beta3(face) == none;
}

/// Every edge of the boundary is in two of its darts: the other one.
inline Dart across_edge(const CellComplex& complex, Dart dart) {
  Dart other = CellComplex::beta2(dart);
  for (Dart next = complex.beta3(other); next != none; next = complex.beta3(other))
    other = CellComplex::beta2(next);
  return other;
}

// The corners of two faces that are or will be one: corner k of the first and its partner.
//
//     k = 0        one         other
//       *---->     the face of `one` runs forwards, that of `other` backwards
//       o <----*
inline Index corner_vertex(const CellComplex& complex, Seam seam, Dart k) {
  return complex.origin((seam.one & ~3u) | ((seam.one + k) & 3u));
}
inline Dart partner_dart(Seam seam, Dart k) {
  return CellComplex::beta1((seam.other & ~3u) | ((seam.other - k) & 3u));
}
inline Index partner_vertex(const CellComplex& complex, Seam seam, Dart k) {
  return complex.origin(partner_dart(seam, k));
}

}  // namespace suture
