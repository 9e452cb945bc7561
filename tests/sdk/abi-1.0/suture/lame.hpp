// SPDX-License-Identifier: MIT
//
// suture/lame.hpp - Lame's constants of an isotropic material.
#ifndef SUTURE_LAME_HPP
#define SUTURE_LAME_HPP

namespace suture {

/// Lame's constants, Pa.
template <class R>
struct lame_of {
  R lambda, mu;
};
using lame = lame_of<double>;

/// From Young's modulus, Pa, and Poisson's ratio.
template <class R>
constexpr lame_of<R> lame_constants(const R& young, const R& poisson) {
  return {young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
          young / (2.0 * (1.0 + poisson))};
}

}  // namespace suture

#endif
