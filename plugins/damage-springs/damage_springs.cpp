// SPDX-License-Identifier: MIT
#include "lattice.hpp"

/// Springs that weaken for good where they were stretched too far; equations in README.md.
struct DamageSprings : lattice::on_boxes<DamageSprings> {
  static constexpr const char
      *id = "damage-springs",
      *doc = "Springs that weaken with strain",
      *formula =
          "U = (1 - d) U0, U0 = sum k/2 (l - L)^2; d = 1 - (e0/m) exp((e0 - m)/e1), m the "
          "largest of e0 and every e = sqrt(2 U0 / (E V)) so far",
      *citation = "J. C. Simo, J. W. Ju, Int. J. Solids Structures 23, 1987, 821-840";

  enum { young, rho, e0, e1 };
  static constexpr suture::parameter parameters[] = {
      suture::number("E", "Pa", "Young's modulus; Poisson's ratio is 1/4").above(0).per_element(),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0).per_element(),
      suture::number("e0", "1", "Strain at which damage begins").above(0),
      suture::number("e1", "1", "Strain over which the stiffness falls by a factor e").above(0)};
  template <class Cell>
  static auto moduli(const Cell& c) {
    return suture::lame_constants(c.parameter(young), typename Cell::real(0.25));
  }
  static constexpr suture::attribute attributes[] = {
      suture::lumped_mass<DamageSprings>(), stiffness_attribute(), length_attribute(),
      suture::volume_attribute("strain", "1", "Largest strain so far").copy().trial()};
  static constexpr suture::column<3> strain{};
  static constexpr auto cell_columns = suture::columns(stiffness, length, strain);
  static constexpr bool element_parameters = true;

  /// Sets the forces without damage, and returns U0, the largest strain, and 1 - d.
  template <class Cell, class T>
  static std::array<T, 3> stretch(const Cell& c, suture::vec3<T> (&f)[8]) {
    const T U0 = lattice::pull(c, stiffness, length, f), begin = T(c.parameter(e0));
    const T square = 2.0 * U0 / (c.parameter(young) * c.column(length, 0));
    const T largest = max(sqrt(max(square, begin * begin)), T(c.column(strain)));
    return {U0, largest, begin / largest * exp((begin - largest) / c.parameter(e1))};
  }
  template <class Cell>
  static void force(const Cell& c) {
    suture::vec3<typename Cell::scalar> f[8];
    const auto [U0, largest, left] = stretch(c, f);
    c.trial(strain, 0, largest);
    for (int n = 0; n < 8; ++n) c.force(n, f[n] * left);
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    suture::vec3<typename Cell::scalar> f[8];
    const auto [U0, largest, left] = stretch(c, f);
    return U0 * left;
  }
  static constexpr suture_field fields[] = {suture::field("damage", "1", "d, from 0 to 1")};
  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    suture::vec3<typename Cell::scalar> f[8];
    out.set(0, 1.0 - stretch(c, f)[2]);
  }
};

SUTURE_PLUGIN("damage-springs", "0.1.0", "MIT", "Springs with damage", DamageSprings)
