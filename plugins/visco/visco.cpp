// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// Relaxation by a power law of time, as a Prony series; equations in README.md.
struct Visco : suture::continuum<Visco> {
  static constexpr const char* id = "visco";
  static constexpr const char* doc = "Viscoelastic solid whose shear modulus falls as t^-n";
  static constexpr const char* formula =
      "G(t) = K t^-n / Gamma(1-n); W = lambda/2 (ln J)^2 + sum G_k/2 (A_k:C - 3 - ln det(A_k C))";
  static constexpr const char* citation = "Linder, Tkachuk, Miehe, J. Mech. Phys. Solids 59, 2011";
  enum { stiffness, exponent, lambda, rho, shortest };
  static constexpr suture::parameter parameters[] = {
      suture::number("K", "Pa s^n", "Stiffness of the power law").above(0),
      suture::number("n", "1", "Exponent of the power law").above(0).below(1),
      suture::number("lambda", "Pa", "First Lame constant, which does not relax").at_least(0),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0),
      suture::number("tau", "s", "Shortest of 5 relaxation times").above(0).or_else(1e-3)};
  static double density(const suture::values& p) { return p[rho]; }
  static constexpr int terms = 5;
  struct Constants {
    double lambda, instant, modulus[terms], rate[terms];  // Pa, 1/s; `instant` is G(0)
  };
  /// Gamma(n) t^-n is the integral of tau^-n exp(-t/tau) over ln tau: a sum with a term per decade.
  static void prepare(const suture::setup& p, Constants& c) {
    const double n = p[exponent], ratio = std::pow(10, -n);
    double G = std::log(10) * p[stiffness] * std::pow(p[shortest], -n) / std::tgamma(1 - n);
    G /= std::tgamma(n);
    c.lambda = p[lambda], c.instant = G / (1 - ratio);
    for (int k = 0; k < terms; ++k, G *= ratio)
      c.modulus[k] = G, c.rate[k] = std::pow(10, -k) / p[shortest];
  }
  template <class T>
  struct State {
    suture::sym3<T> flow[terms];  // A_k - I
    suture::sym3<T> target;       // C^-1 - I at the end of the last step
  };
  static constexpr suture::attribute states[] = {
      suture::state("flow_1", "1", "A_1 - I", 6),
      suture::state("flow_2", "1", "A_2 - I", 6),
      suture::state("flow_3", "1", "A_3 - I", 6),
      suture::state("flow_4", "1", "A_4 - I", 6),
      suture::state("flow_5", "1", "A_5 - I", 6),
      suture::state("target", "1", "C^-1 - I at the end of the last step", 6)};
  /// Exact for a C^-1 that changes linearly within the step; the weights are positive and sum to 1.
  template <class T, class At>
  static void evolve(const suture::mat3<T>& F, const Constants& c, At& at) {
    const auto now = add_diagonal(inverse(right_cauchy_green(F)), -1.0), before = at.state.target;
    for (int k = 0; k < terms; ++k) {
      const double h = at.dt * c.rate[k], left = std::exp(-h);
      const double mean = h > 0 ? -std::expm1(-h) / h : 1;
      at.state.flow[k] = at.state.flow[k] * left + before * (mean - left) + now * (1 - mean);
    }
    at.state.target = now;
  }
  template <class T, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const Constants& c, const At& at) {
    const T ln_j = log1p(excess_J(F));
    auto pull = at.state.flow[0] * 0.0;
    auto spent = pull.c[0];  // sums that do not depend on F, outside of its gradient
    for (int k = 0; k < terms; ++k) {
      const auto& A = at.state.flow[k];
      const auto det_excess = trace(A) + trace(cofactor(A)) + det(A);  // det(I + A) - 1
      pull += A * c.modulus[k];
      spent += c.modulus[k] * (log1p(det_excess) - trace(A));
    }
    return 0.5 * c.instant * (excess_I1(F) - 2.0 * ln_j) + 0.5 * c.lambda * (ln_j * ln_j) +
           0.5 * (dot(pull, twice_green_strain(F)) - spent);
  }
};
SUTURE_PLUGIN("visco", "0.1.0", "MIT", "Power-law viscoelastic solid", Visco)
