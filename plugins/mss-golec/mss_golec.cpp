// SPDX-License-Identifier: MIT
#include "lattice.hpp"

/// Springs with a volume term, for any Poisson's ratio; equations in README.md.
struct MssGolec : lattice::on_boxes<MssGolec> {
  static constexpr const char* id = "mss-golec";
  static constexpr const char* doc = "Springs with face diagonals and a volume term on boxes";
  static constexpr const char* formula =
      "U = sum k/2 (l - L)^2 + kappa V/2 (J - 1)^2, kappa = lambda - mu, J of the mean edges";
  static constexpr const char* citation =
      "K. Golec, J.-F. Palierne, F. Zara, S. Nicolle, G. Damiand, Visual Computer 36, 2020";

  enum { young, poisson, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("E", "Pa", "Young's modulus").above(0).per_element(),
      suture::number("nu", "1", "Poisson's ratio").above(-1).below(0.5).per_element(),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0).per_element()};

  template <class Cell>
  static auto moduli(const Cell& c) {
    return suture::lame_constants(c.parameter(young), c.parameter(poisson));
  }
  static constexpr suture::attribute attributes[] = {suture::lumped_mass<MssGolec>(),
                                                     stiffness_attribute(), length_attribute()};
  static constexpr auto cell_columns = suture::columns(stiffness, length);

  template <class Cell>
  static void force(const Cell& c) {
    suture::vec3<typename Cell::scalar> f[8];
    lattice::pull(c, stiffness, length, f);
    for (int n = 0; n < 8; ++n) c.force(n, f[n]);
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    suture::vec3<typename Cell::scalar> f[8];
    return lattice::pull(c, stiffness, length, f);
  }
};

SUTURE_PLUGIN("mss-golec", "0.1.0", "MIT", "Springs for any Poisson's ratio", MssGolec)
