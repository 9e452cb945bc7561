// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

// Laws as books print them: differences of numbers that cancel at rest, but for their rounding.

namespace {

enum { mu, lambda, rho };
constexpr suture::parameter moduli[] = {
    suture::number("mu", "Pa", "Shear modulus").above(0),
    suture::number("lambda", "Pa", "First Lame constant").at_least(0),
    suture::number("rho", "kg/m^3", "Density").above(0)};

template <class Law>
struct naive : suture::continuum<Law> {
  static constexpr const char *doc = "A law that cancels at rest", *citation = "none";
  static constexpr auto& parameters = moduli;
  static double density(const suture::values& p) { return p[rho]; }
};

struct Hyperbolic : naive<Hyperbolic> {
  static constexpr const char *id = "naive-neo-hookean",
                              *formula = "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2";
  template <class T, class P>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p) {
    const T ln_j = log(det(F));
    return 0.5 * p[mu] * (dot(F, F) - 3.0) - p[mu] * ln_j + 0.5 * p[lambda] * ln_j * ln_j;
  }
};

struct Yeoh : naive<Yeoh> {
  static constexpr const char *id = "naive-yeoh",
                              *formula = "W = mu/2 ((I1 - 3) + (I1 - 3)^2) + K/2 (J - 1)^2";
  template <class T, class P>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p) {
    const T J = det(F), excess = dot(F, F) / cbrt(J * J) - 3.0;
    const auto K = p[lambda] + p[mu] * (2.0 / 3.0);
    return 0.5 * p[mu] * (excess + excess * excess) + 0.5 * K * ((J - 1.0) * (J - 1.0));
  }
};

/// The prefactor is 50 times the modulus, and so is the rounding.
struct Fung : naive<Fung> {
  static constexpr const char *id = "naive-fung",
                              *formula =
                                  "W = 50 mu (exp((F:F - 3 - 2 ln J)/100) - 1) + lambda/2 "
                                  "(J - 1)^2";
  template <class T, class P>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p) {
    const T J = det(F), q = dot(F, F) - 3.0 - 2.0 * log(J);
    return 50.0 * p[mu] * (exp(0.01 * q) - 1.0) + 0.5 * p[lambda] * ((J - 1.0) * (J - 1.0));
  }
};

}  // namespace

SUTURE_PLUGIN("naive-laws", "1.0", "MIT", "Laws that cancel at rest", Hyperbolic, Yeoh, Fung)
