// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two species that diffuse at different rates, and exchange what one has more of.
#include "suture/diffusion.hpp"
#include "suture/mass.hpp"

struct TwoSpecies : suture::model {
  static constexpr const char *id = "two-species", *doc = "Two species that diffuse",
                              *formula = "c du_i/dt = div(k_i grad u_i) + e (u_j - u_i)",
                              *citation = "none";
  enum { first, second, exchange, density_place };
  static constexpr suture::parameter parameters[] = {
      suture::number("k0", "m^2/s", "Diffusivity of the first").above(0),
      suture::number("k1", "m^2/s", "Diffusivity of the second").above(0),
      suture::number("exchange", "1/s", "Between them").at_least(0).or_else(0),
      suture::number("rho", "kg/m^3", "Density").above(0)};
  static double capacity(const suture::values&) { return 1; }
  static double density(const suture::values& p) { return p[density_place]; }
  static constexpr suture::column<0> species{};
  static constexpr suture::attribute attributes[] = {
      suture::vertex_field("species", "mol/m^3", "Concentrations", 2).at_least(0),
      suture::lumped_capacity<TwoSpecies>("room", "m^3", "Of the nodes"),
      suture::lumped_mass<TwoSpecies>(),
      suture::vertex_attribute("size", "m^3", "Of the nodes")
          .from_volumes(
              suture::contribution<TwoSpecies, suture::detail::capacity_share<TwoSpecies>>)};

  struct Diffusion : suture::on_volumes {
    static constexpr const char *name = "diffusion", *doc = "Of both";
    static constexpr auto reads = SUTURE_READ_REST;
    static constexpr auto rate_of = species;
    static constexpr auto vertex_columns = suture::columns(species);
    template <class Cell>
    static void rate(const Cell& c) {
      suture::diffuse(c, c.parameter(first), 0);
      suture::diffuse(c, c.parameter(second), 1);
    }
  };
  struct Exchange : suture::on_vertices {
    static constexpr const char *name = "exchange", *doc = "Between both";
    static constexpr suture::column<3> size{};
    static constexpr auto reads = 0u;
    static constexpr auto rate_of = species;
    static constexpr auto vertex_columns = suture::columns(species, size);
    template <class Cell>
    static void rate(const Cell& c) {
      const auto flow =
          c.parameter(exchange) * c.vertex_column(size, 0) * (c.field(0, 1) - c.field(0, 0));
      c.rate(0, 0, flow);
      c.rate(0, 1, -flow);
    }
  };
  using functors = suture::list<Diffusion, Exchange>;
};

SUTURE_PLUGIN("two-species", "1.0", "MIT", "Two species that diffuse", TwoSpecies)
