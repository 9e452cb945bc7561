// SPDX-License-Identifier: MIT
//
// suture/detail/spectral_bound.hpp - the largest eigenvalue of the stiffness of each cell, for the
// stable step. Authors need not read it.
#ifndef SUTURE_DETAIL_SPECTRAL_BOUND_HPP
#define SUTURE_DETAIL_SPECTRAL_BOUND_HPP

#include <algorithm>
#include <cmath>

#include "suture/plugin.h"
#include "suture/simd.hpp"

namespace suture::detail {

/// A symmetric tridiagonal matrix per lane.
template <int Size>
struct tridiagonal {
  native diagonal[Size], beside[Size];  ///< beside[k] links k and k + 1

  /// Whether all eigenvalues are below `x`, by the signs of Gauss' pivots.
  auto is_below(const native& x) const {
    native pivot = x - diagonal[0];
    auto below = pivot > 0.0;
    for (int k = 1; k < Size; ++k) {
      pivot = x - diagonal[k] - beside[k - 1] * beside[k - 1] / max(pivot, native(1e-300));
      below = below & (pivot > 0.0);
    }
    return below;
  }
  /// Its largest eigenvalue, too large by at most 2^-9 of Gershgorin's bound; at least 0.
  native largest() const {
    native low(0.0), high(0.0);
    for (int k = 0; k < Size; ++k)
      high = max(high, diagonal[k] + beside[k] + (k > 0 ? beside[k - 1] : native(0.0)));
    for (int i = 0; i < 9; ++i) {
      const native middle = 0.5 * (low + high);
      const auto below = is_below(middle);
      high = select(below, middle, high);
      low = select(below, low, middle);
    }
    return high;
  }
};

/// One pack of vectors with the layout of forces.
template <int Count>
struct pack_vector {
  alignas(SUTURE_ALIGNMENT) double values[Count * SUTURE_LANES];
  int lane;

  SUTURE_INLINE native at(int i) const {
    return native::load(values + i * int(SUTURE_LANES) + lane);
  }
  SUTURE_INLINE void set(int i, const native& x) {
    store(values + i * int(SUTURE_LANES) + lane, x);
  }
  native dot(const pack_vector& other) const {
    native sum(0.0);
    for (int i = 0; i < Count; ++i) sum += at(i) * other.at(i);
    return sum;
  }
};

/// tangent_pack() of a functor: df of the direction (dx, dv), for one pack.
using pack_tangent = void (*)(const suture_context* context, const suture_batch* batch, int lane,
                              double* df, const double* dx, const double* dv);

/// Upper bound of the largest eigenvalue of K, where `tangent` gives df = -K dx or, if `damping`,
/// df = -K dv. Lanczos' method finds the largest of a cluster of eigenvalues, which power iteration
/// passes over; what couples its vectors to the rest of space, beside[last], is added to the last
/// of them, as much as a rest with eigenvalues up to (bound - beside[last]) may add. One function
/// for all functors.
template <int Count>
[[gnu::noinline]] native largest_eigenvalue(const suture_context* context,
                                            const suture_batch* batch, int lane,
                                            pack_tangent tangent, bool damping) {
  alignas(SUTURE_ALIGNMENT) static constexpr double zero[Count * SUTURE_LANES] = {};
  constexpr int steps = std::min(Count, 12);
  tridiagonal<steps> t;
  pack_vector<Count> before{{}, lane}, now{{}, lane}, next{{}, lane};
  // Fractional parts of multiples of the golden ratio: no mode is orthogonal to them.
  for (int i = 0; i < Count; ++i) {
    const double golden = 0.6180339887498949 * (i + 1);
    now.set(i, native(golden - std::floor(golden) - 0.5));
  }
  native length = sqrt(now.dot(now)), link(0.0), largest(0.0);
  for (int k = 0; k < steps; ++k) {
    const native scale = select(length > 0.0, 1.0 / max(length, native(1e-300)), native(0.0));
    for (int i = 0; i < Count; ++i) now.set(i, now.at(i) * scale);
    tangent(context, batch, lane, next.values, damping ? zero : now.values,
            damping ? now.values : zero);
    t.diagonal[k] = -now.dot(next);
    for (int i = 0; i < Count; ++i)
      next.set(i, -next.at(i) - t.diagonal[k] * now.at(i) - link * before.at(i));
    length = sqrt(next.dot(next));
    // All eigenvectors in the first vector are found: what is left is rounding.
    largest = max(largest, abs(t.diagonal[k]) + length);
    const auto ends = length < 1e-6 * largest;
    t.diagonal[k] += select(ends, length, native(0.0));
    t.beside[k] = link = length = select(ends, native(0.0), length);
    std::swap(before, now);
    std::swap(now, next);
  }
  t.diagonal[steps - 1] += t.beside[steps - 1];
  t.beside[steps - 1] = native(0.0);
  return t.largest();
}

}  // namespace suture::detail

#endif
