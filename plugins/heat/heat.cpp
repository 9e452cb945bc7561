// SPDX-License-Identifier: MIT
//
// Conduction of heat, and a solid that expands and softens with it; see README.md.
#include "suture/continuum.hpp"
#include "suture/diffusion.hpp"

namespace {

constexpr double room = 293.15;  // K

constexpr suture::attribute temperature_field() {
  return suture::vertex_field("temperature", "K", "Temperature").starts_at(room).at_least(0);
}

/// The places of its parameters.
enum { conductivity, heat_capacity, heat_density };

template <std::uint32_t Shape>
struct ConductionIn : suture::on_volumes {
  static constexpr const char* doc = "Flow of heat between the nodes of an element";
  static constexpr std::uint32_t shape = Shape, reads = SUTURE_READ_REST;
  static constexpr suture::column<0> temperature{};
  static constexpr auto rate_of = temperature;
  static constexpr auto vertex_columns = suture::columns(temperature);
  static constexpr bool element_parameters = true;
};

/// Parallelepipeds take three quarters of the time of other hexahedra.
template <std::uint32_t Shape>
struct Conduction : ConductionIn<Shape> {
  static constexpr const char* name = Shape == SUTURE_PARALLELEPIPED
                                          ? "conduction in parallelepipeds"
                                          : "conduction in general hexahedra";

  template <class Cell>
  static void rate(const Cell& cell) {
    suture::diffuse(cell, cell.parameter(conductivity));
  }
};

/// Those of which only a part is material.
template <std::uint32_t Shape>
struct ConductionInParts : ConductionIn<Shape> {
  static constexpr const char* name = Shape == SUTURE_PARALLELEPIPED
                                          ? "conduction in parts of parallelepipeds"
                                          : "conduction in parts of general hexahedra";
  static constexpr auto cell_columns = [] {
    if constexpr (Shape == SUTURE_PARALLELEPIPED)
      return suture::columns(suture::element_part);
    else
      return suture::columns(suture::element_general_part);
  }();

  template <class Cell>
  static void rate(const Cell& cell) {
    suture::diffuse_in_part(cell, cell.parameter(conductivity));
  }
};

}  // namespace

template <std::uint32_t Shape>
struct suture::detail::functor_on_parts<Conduction<Shape>> {
  using type = ConductionInParts<Shape>;
};

struct Heat : suture::model {
  static constexpr const char *id = "heat",
                              *doc = "Conduction of heat, isotropic, in the shape at rest",
                              *formula = "c dT/dt = div(k grad T), c = heat capacity per volume",
                              *citation =
                                  "J. Fourier, Theorie analytique de la chaleur, 1822; O. "
                                  "C. Zienkiewicz, R. L. Taylor, The Finite Element "
                                  "Method, vol. 1, 2000, ch. 7";
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "W/(m K)", "Thermal conductivity").above(0).per_element(),
      suture::number("c", "J/(m^3 K)", "Heat capacity per volume: density times specific heat")
          .above(0)
          .per_element(),
      suture::number("rho", "kg/m^3", "Density, if no law on the same elements has one")
          .at_least(0)
          .or_else(0)};
  template <class P>
  static auto capacity(const P& p) {
    return p[heat_capacity];
  }
  template <class P>
  static auto density(const P& p) {
    return p[heat_density];
  }
  static constexpr suture::attribute attributes[] = {
      temperature_field(),
      suture::lumped_capacity<Heat>("heat_capacity", "J/K",
                                    "An eighth of that of every incident element"),
      suture::lumped_mass<Heat>()};
  using functors = suture::list<Conduction<SUTURE_PARALLELEPIPED>, Conduction<SUTURE_GENERAL>>;
};

struct Thermoelastic : suture::continuum<Thermoelastic> {
  static constexpr const char *id = "thermoelastic",
                              *doc = "Neo-Hookean solid that expands and softens with temperature",
                              *formula =
                                  "W = s g^3 W_0(F / g), g = exp(alpha (T - T0)), s = "
                                  "exp(-softening (T - T0)), W_0 = mu/2 (I1 - 3 - 2 ln J) + "
                                  "lambda/2 (ln J)^2",
                              *citation =
                                  "S. C. H. Lu, K. S. Pister, Int. J. Solids Struct. 11, "
                                  "1975, 927";
  enum { mu, lambda, rho, alpha, softening, reference };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus at T0").above(0),
      suture::number("lambda", "Pa", "First Lame constant at T0").at_least(0),
      suture::number("rho", "kg/m^3", "Density").above(0),
      suture::number("alpha", "1/K", "Linear thermal expansion").or_else(0),
      suture::number("softening", "1/K", "Part of the stiffness that is lost per kelvin")
          .at_least(0)
          .or_else(0),
      suture::number("T0", "K", "Temperature without expansion").above(0).or_else(room)};
  static double density(const suture::values& p) { return p[rho]; }

  static constexpr suture::attribute vertex_fields[] = {temperature_field()};

  template <class T, class P, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p, const At& at) {
    const auto warmer = at.field[0] - p[reference];
    // The invariants of F / g by their excess, and ln g; exact near rest.
    const auto ln_growth = p[alpha] * warmer, less = expm1(-2.0 * ln_growth);
    const T excess_I = excess_I1(F) * (1.0 + less) + 3.0 * less;
    const T ln_j = log1p(excess_J(F)) - 3.0 * ln_growth;
    const T stored = 0.5 * p[mu] * (excess_I - 2.0 * ln_j) + 0.5 * p[lambda] * ln_j * ln_j;
    return exp(3.0 * ln_growth - p[softening] * warmer) * stored;
  }
};

SUTURE_PLUGIN("heat", "1.0", "MIT", "Conduction of heat, and a solid that feels it", Heat,
              Thermoelastic)
