// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// St Venant-Kirchhoff solid on hexahedra; equations in README.md.
struct TmFaure : suture::continuum<TmFaure> {
  static constexpr const char* id = "tm-faure";
  static constexpr const char* doc = "Tensor-mass: St Venant-Kirchhoff solid on hexahedra";
  static constexpr const char* formula =
      "E = (F'F - I)/2, W = lambda/2 (tr E)^2 + mu tr(E^2), "
      "S = lambda tr(E) I + 2 mu E, f_j = - integral of F S grad(N_j) dX";
  static constexpr const char* citation =
      "X. Faure, F. Zara, F. Jaillet, J.-M. Moreau: An Implicit Tensor-Mass solver on the GPU "
      "for soft bodies simulation. VRIPHYS 2012";

  /// The element of the paper.
  static constexpr auto default_element = suture::element_type::trilinear;

  enum { young, poisson, rho, quadrature, geometry };
  static constexpr const char* quadratures[] = {"gauss2", "exact"};
  static constexpr const char* geometries[] = {"stored", "recomputed"};
  static constexpr suture::parameter parameters[] = {
      suture::number("E", "Pa", "Young's modulus").above(0).per_element(),
      suture::number("nu", "1", "Poisson's ratio; above 0.45 trilinear elements lock")
          .above(-1)
          .below(0.5)
          .per_element(),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0).per_element(),
      suture::choice("quadrature",
                     "gauss2: 2x2x2 points; exact: 3x3x3 points, which on boxes equals the "
                     "symbolic integration of the paper, at 3 times the cost",
                     quadratures),
      suture::choice("geometry",
                     "geometry of elements that are not parallelepipeds, with gauss2; stored: up "
                     "to a quarter faster, 640 B per element",
                     geometries)};

  template <class R>
  using Constants = suture::lame_of<R>;
  static void prepare(const suture::setup& p, suture::lame& c) {
    c = suture::lame_constants(p[young], p[poisson]);
  }

  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }
  static int points(const suture::values& p) { return p[quadrature] == 1 ? 3 : 2; }
  static bool stores(const suture::values& p) { return p[geometry] == 0; }

  /// The law of `formula`, in suture/saint_venant_kirchhoff.hpp.
  template <class R>
  static suture::lame_of<R> saint_venant_kirchhoff(const suture::lame_of<R>& c) {
    return c;
  }
};

SUTURE_PLUGIN("tm-faure", "0.1.0", "MIT", "Tensor-mass model of Faure et al. on hexahedra", TmFaure)
