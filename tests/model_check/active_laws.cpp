// SPDX-License-Identifier: GPL-3.0-or-later
//
// Laws that act by themselves, as muscles do: sound ones, and one for each mistake that shows only
// while they act.
#include <cmath>

#include "suture/continuum.hpp"

namespace {

/// 0 until `from`, 1 from `to` on.
template <class T, class P, class At>
SUTURE_INLINE T ramp(const P& p, const At& at, int from, int to) {
  return min(max(T((at.time - p[from]) / (p[to] - p[from])), T(0.0)), T(1.0));
}

/// A neo-Hookean solid whose fibres pull with a tension that grows with time.
template <class Law>
struct muscle_base : suture::continuum<Law> {
  static constexpr const char *doc = "Active fibres", *citation = "none",
                              *formula = "W = mu/2 (F:F - 3) - mu ln J + l/2 ln(J)^2 + T(t) |F f|";
  enum { mu, lambda, tension, from, to, rho, fibre };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "shear modulus").above(0),
      suture::number("lambda", "Pa", "Lame constant").at_least(0),
      suture::number("Ta", "Pa", "active stress").at_least(0),
      suture::number("from", "s", "begin of the activation").or_else(0),
      suture::number("to", "s", "end of its growth").or_else(1),
      suture::number("rho", "kg/m^3", "density").above(0),
      suture::direction("fibre", "direction of the fibres")};
  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }
  template <class T, class P, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p, const At& at) {
    const auto f = F * p.direction(fibre);
    const T ln_j = log(det(F));
    return 0.5 * p[mu] * (dot(F, F) - 3.0) - p[mu] * ln_j + 0.5 * p[lambda] * (ln_j * ln_j) +
           p[tension] * Law::template activation<T>(p, at) * (sqrt(dot(f, f)) - 1.0);
  }
};

struct muscle : muscle_base<muscle> {
  static constexpr const char* id = "active-muscle";
  template <class T, class P, class At>
  static SUTURE_INLINE T activation(const P& p, const At& at) {
    return ramp<T>(p, at, from, to);
  }
};

/// The same, but `to` has no effect.
struct ignores_end : muscle_base<ignores_end> {
  static constexpr const char* id = "active-ignores-end";
  template <class T, class P, class At>
  static SUTURE_INLINE T activation(const P& p, const At& at) {
    return max(T(at.time - p[from]), T(0.0));
  }
};

/// A muscle with a tone: it pulls at all times, so the body has no rest state.
struct tone : muscle_base<tone> {
  static constexpr const char* id = "active-tone";
  static constexpr std::uint32_t flags = SUTURE_CONTINUUM | SUTURE_ACTIVE;
  template <class T, class P, class At>
  static SUTURE_INLINE T activation(const P& p, const At& at) {
    return 0.5 + 0.5 * ramp<T>(p, at, from, to);
  }
};

/// Pulsates; its stress does not turn with the body while it acts.
struct fixed_axis : suture::continuum<fixed_axis> {
  static constexpr const char *id = "active-fixed-axis", *doc = "Pulsates along x",
                              *formula = "P = 2 mu F E + a sin^2(pi f t) e_x e_x",
                              *citation = "none";
  enum { mu, amplitude, frequency, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "shear modulus").above(0),
      suture::number("a", "Pa", "amplitude").at_least(0),
      suture::number("f", "1/s", "frequency").above(0),
      suture::number("rho", "kg/m^3", "density").above(0)};
  static double density(const suture::values& p) { return p[rho]; }
  template <class T, class P, class At>
  static SUTURE_INLINE suture::mat3<T> stress(const suture::mat3<T>& F, const P& p, const At& at) {
    suture::mat3<T> S = F * (2.0 * p[mu] * green_strain(F));
    const double phase = std::sin(3.141592653589793 * double(p[frequency]) * at.time);
    S(0, 0) += T(p[amplitude] * phase * phase);
    return S;
  }
};

}  // namespace

SUTURE_PLUGIN("active-laws", "1.0", "MIT", "Laws that act by themselves", muscle, ignores_end, tone,
              fixed_axis)
