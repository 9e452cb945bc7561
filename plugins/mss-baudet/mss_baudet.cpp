// SPDX-License-Identifier: MIT
//
// The mass-spring system of Baudet for hexahedra, on the cells of the map: one
// spring per edge, summed over the elements around it, and four inner diagonals
// per element. See README.md for the equations and their sources.
#include "contributions.hpp"
#include "springs.hpp"
#include "warnings.hpp"

namespace mss_baudet {

template <class Cell, class Mask>
[[gnu::cold, gnu::noinline]] void fail_zero_length(const Cell& c, const Mask& good) {
  c.require(good, suture::failure(SUTURE_RETRY,
                                  "the ends of a spring coincide, or their positions are not "
                                  "finite: its force has no direction"));
}

template <class Cell>
SUTURE_INLINE auto mass(const Cell& c, int node) {
  return c.vertex_column(suture::vertex_mass, node);
}

// ------------------------------------------------------------- edge springs --

/// Two alternatives: without viscosity neither velocities nor masses are gathered.
template <bool with_viscosity>
struct EdgeSprings : suture::on_edges {
  static constexpr const char* name =
      with_viscosity ? "edge springs with viscosity" : "edge springs";
  static constexpr const char* doc =
      "One spring along each edge, shared by all elements around it.";
  static constexpr std::uint32_t reads =
      SUTURE_READ_POSITION | (with_viscosity ? SUTURE_READ_VELOCITY : 0);
  static constexpr std::uint32_t alternative = 1;
  static constexpr bool allows_parts = true;
  static constexpr auto cell_columns = suture::columns(stiffness, rest_tension);
  static constexpr auto vertex_columns = [] {
    if constexpr (with_viscosity)
      return suture::columns(suture::vertex_mass);
    else
      return suture::columns();
  }();

  static bool enabled(const suture::values& p, std::uint32_t&) {
    return with_viscosity || p[p_viscosity] == 0;
  }

  template <class Cell>
  SUTURE_INLINE static auto gamma(const Cell& c) {
    return viscosity(c.parameter(p_viscosity), c.column(stiffness), mass(c, 0) + mass(c, 1));
  }

  template <class Cell>
  SUTURE_INLINE static void force(Cell& c) {
    const auto d = c.position(1) - c.position(0);
    const auto square = dot(d, d);
    const auto good = is_length_squared(square);
    if (__builtin_expect(!all(good), 0)) fail_zero_length(c, good);
    const auto inverse = rsqrt(square);
    auto scale = elastic(inverse, c.column(stiffness), c.column(rest_tension));
    if constexpr (with_viscosity)
      scale += viscous(d, c.velocity(1) - c.velocity(0), inverse, gamma(c));
    const auto f = d * scale;
    c.force(0, f);
    c.force(1, -f);
  }

  /// L/K; 0 where the spring is clamped away.
  template <class Cell>
  static auto rest_length(const Cell& c) {
    const auto K = c.column(stiffness);
    return select(K == 0.0, K, c.column(rest_tension) / select(K == 0.0, K + 1.0, K));
  }

  template <class Cell>
  static auto energy(const Cell& c) {
    return spring_energy(norm(c.position(1) - c.position(0)), c.column(stiffness), rest_length(c));
  }

  template <class Cell, class Bounds>
  static void bounds(const Cell& c, Bounds& out) {
    const auto d = c.position(1) - c.position(0);
    const auto inverse = rsqrt(dot(d, d));
    const auto u = d * inverse;
    const auto k = stiffness_bound(u, c.column(stiffness),
                                   elastic(inverse, c.column(stiffness), c.column(rest_tension)));
    for (int n = 0; n < 2; ++n) out.stiffness(n, k);
    if constexpr (with_viscosity) {
      const auto viscous = damping_bound(u, gamma(c));
      for (int n = 0; n < 2; ++n) out.damping(n, viscous);
    }
  }

  static constexpr suture_field fields[] = {
      suture::field("strain", "1", "elongation of the edge relative to its rest length"),
      suture::field("tension", "N", "elastic force along the edge, positive in tension")};

  template <class Cell, class Results>
  static void output(const Cell& c, Results& out) {
    const auto d = c.position(1) - c.position(0);
    const auto length = norm(d);
    const auto rest = rest_length(c);
    const auto stretch = length - rest;
    out.set(0, select(rest == 0.0, rest, stretch / select(rest == 0.0, rest + 1.0, rest)));
    out.set(1, c.column(stiffness) * stretch);
  }
};

// ------------------------------------------------- inner springs, correction --

/// Four alternatives.
template <bool with_viscosity, bool with_correction>
struct InnerSprings : suture::on_volumes {
  static constexpr const char* name =
      with_viscosity ? (with_correction ? "inner springs with viscosity and correction"
                                        : "inner springs with viscosity")
                     : (with_correction ? "inner springs with correction" : "inner springs");
  static constexpr const char* doc =
      with_correction ? "Four springs along the diagonals of each element, and the forces that "
                        "make the lattice isotropic with the Poisson's ratio given."
                      : "Four springs along the diagonals of each element.";
  static constexpr std::uint32_t reads =
      SUTURE_READ_POSITION | (with_viscosity ? SUTURE_READ_VELOCITY : 0);
  static constexpr std::uint32_t alternative = 2;
  static constexpr bool allows_parts = true;
  static constexpr bool element_parameters = true;  // in inspect()
  static constexpr auto cell_columns = [] {
    if constexpr (with_correction)
      return suture::columns(inner_stiffness, inner_length, correction_stiffness, rest_box);
    else
      return suture::columns(inner_stiffness, inner_length);
  }();
  static constexpr auto vertex_columns = [] {
    if constexpr (with_viscosity)
      return suture::columns(suture::vertex_mass);
    else
      return suture::columns();
  }();

  static bool enabled(const suture::values& p, std::uint32_t&) {
    return (with_viscosity || p[p_viscosity] == 0) && (with_correction || p[p_correction] == 0);
  }

  template <class Cell>
  SUTURE_INLINE static auto gamma(const Cell& c, int s) {
    return viscosity(c.parameter(p_viscosity), c.column(inner_stiffness),
                     mass(c, s) + mass(c, 7 - s));
  }

  template <class Cell>
  SUTURE_INLINE static auto box_stiffness(const Cell& c) {
    suture::sym3<typename Cell::real> B;
    for (int i = 0; i < 6; ++i) B.c[i] = c.column(correction_stiffness, i);
    return B;
  }

  template <class Cell>
  SUTURE_INLINE static auto correction(const Cell& c) {
    using T = typename Cell::scalar;
    using R = typename Cell::real;
    return CorrectedBox<T>(
        position_of(c), box_stiffness(c),
        vec3<R>{c.column(rest_box, 0), c.column(rest_box, 1), c.column(rest_box, 2)});
  }

  template <class Cell>
  SUTURE_INLINE static void force(Cell& c) {
    using T = typename Cell::scalar;
    const auto K = c.column(inner_stiffness);
    vec3<T> f[8];
    auto smallest = T(1e300);
    for (int s = 0; s < 4; ++s) {
      const auto d = c.position(7 - s) - c.position(s);
      const T square = dot(d, d);
      smallest = select(square < smallest, square, smallest);
      const T inverse = rsqrt(square);
      T scale = elastic(inverse, K, K * c.column(inner_length, s));
      if constexpr (with_viscosity)
        scale += viscous(d, c.velocity(7 - s) - c.velocity(s), inverse, gamma(c, s));
      f[s] = d * scale;
      f[7 - s] = -f[s];
    }
    if constexpr (with_correction) correction(c).add_forces(f);
    const auto good = is_length_squared(smallest);
    if (__builtin_expect(!all(good), 0)) fail_zero_length(c, good);
    for (int n = 0; n < 8; ++n) c.force(n, f[n]);
  }

  template <class Cell>
  static auto energy(const Cell& c) {
    const auto K = c.column(inner_stiffness);
    auto sum = 0.0 * K;
    for (int s = 0; s < 4; ++s)
      sum += spring_energy(norm(c.position(7 - s) - c.position(s)), K, c.column(inner_length, s));
    if constexpr (with_correction) sum += correction(c).energy();
    return sum;
  }

  template <class Cell, class Bounds>
  static void bounds(const Cell& c, Bounds& out) {
    using R = typename Cell::real;
    suture::sym3<R> common{R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)};
    if constexpr (with_correction) {
      common = stiffness_bound(correction(c), box_stiffness(c));
    }
    for (int s = 0; s < 4; ++s) {
      const auto d = c.position(7 - s) - c.position(s);
      const auto inverse = rsqrt(dot(d, d));
      const auto u = d * inverse;
      const R K = c.column(inner_stiffness);
      const auto k =
          stiffness_bound(u, K, elastic(inverse, K, K * c.column(inner_length, s))) + common;
      out.stiffness(s, k);
      out.stiffness(7 - s, k);
      if constexpr (with_viscosity) {
        const auto viscous = damping_bound(u, gamma(c, s));
        out.damping(s, viscous);
        out.damping(7 - s, viscous);
      }
    }
  }

  template <class Cell>
  static void inspect(const Cell& c) {
    inspect_shape(c);
    inspect_stiffness(c);
  }
};

// -------------------------------------------------------------------- model --

struct MssBaudet : suture::model {
  static constexpr const char* id = "mss-baudet";
  static constexpr const char* doc =
      "Mass-spring system on hexahedra: a spring per edge, four inner diagonals per element";
  static constexpr const char* formula =
      "f_0 = (K - L/|d|) d + gamma ((v_1 - v_0).u) u, u = d/|d|; K = sum k_e, L = sum k_e l_e over "
      "the elements at the edge; cube of edge l: k_e = E l (1+4nu) / (8 (1+nu)), inner k_d = 3 E l "
      "/ (8 (1+nu)); gamma = viscosity 2 sqrt(K (m_0+m_1)/2); m = sum rho V / 8";
  static constexpr const char* citation =
      "Baudet, Beuve, Jaillet, Shariat, Zara, Integrating Tensile Parameters in Hexahedral "
      "Mass-Spring System for Simulation, WSCG 2009; Golec, Coquet, Zara, Damiand, WSCG 2015";

  static constexpr suture::parameter parameters[] = {
      suture::number("E", "Pa", "Young's modulus").above(0).per_element(),
      suture::number("nu", "1", "Poisson's ratio; without correction the lattice has 1/(3+4nu)")
          .above(-0.25)
          .below(0.5),
      suture::number("rho", "kg/m^3", "density").above(0).per_element(),
      suture::boolean("correction",
                      "forces that give a lattice of boxes exactly E and nu at small strain",
                      false),
      suture::number("viscosity", "1",
                     "viscosity of the springs: 1 is the value of the paper (which reduces the "
                     "stable step by a factor of 5 to 7), 0 is none")
          .at_least(0)
          .or_else(0),
      suture::choice("negative_stiffness",
                     "edges for which the formula gives a negative stiffness: set to 0, used "
                     "unchanged, or refused",
                     negative_words)};

  template <class C>
  static constexpr auto sum = suture::contribution<MssBaudet, C>;

  static constexpr suture::attribute attributes[] = {
      suture::vertex_attribute("mass", "kg", "lumped mass, sum of rho V / 8")
          .from_volumes(sum<MassShare>)
          .flag(SUTURE_SHARED_MASS),
      suture::edge_attribute("stiffness", "N/m", "sum of k_e over the elements at the edge")
          .from_volumes(sum<StiffnessShare>)
          .output(),
      suture::edge_attribute("rest_tension", "N",
                             "sum of k_e l_e; divided by the stiffness, the rest length")
          .from_volumes(sum<RestTensionShare>),
      suture::volume_attribute("inner_stiffness", "N/m", "stiffness of each inner diagonal")
          .from_volumes(sum<InnerStiffness>),
      suture::volume_attribute("inner_length", "m", "rest lengths of the inner diagonals", 4)
          .from_volumes(sum<InnerLength>),
      suture::volume_attribute("correction_stiffness", "N/m",
                               "matrix B of the correction energy, XX YY ZZ XY YZ XZ", 6)
          .from_volumes(sum<Correction>),
      suture::volume_attribute("box", "m", "lengths of the mean edges at rest", 3)
          .from_volumes(sum<BoxLengths>)};

  using functors =
      suture::list<EdgeSprings<false>, EdgeSprings<true>, InnerSprings<false, false>,
                   InnerSprings<true, false>, InnerSprings<false, true>, InnerSprings<true, true>>;

  /// Says what the lattice shows where that is 2 % or more from what was asked for.
  static void prepare(const suture::setup& p, suture::no_constants&) {
    const double ratio = lattice_young(1, p[p_nu]);
    if (p[p_correction] != 0 || std::fabs(ratio - 1) < 0.02) return;
    const double E = p[p_young];  // not a number if it differs from element to element
    const std::string young = std::isfinite(E) ? "E = " + number(ratio * E) + " Pa"
                                               : "E = " + number(ratio) + " times the value given";
    p.warn("lattice-moduli", "without correction, a lattice of cubes has " + young +
                                 " and nu = " + number(lattice_nu(p[p_nu])) + " instead of " +
                                 (std::isfinite(E) ? number(E) + " Pa and " : "") +
                                 number(p[p_nu]) +
                                 " (they agree at nu = 0.25); set \"correction\": true");
  }
};

}  // namespace mss_baudet

SUTURE_PLUGIN("mss-baudet", "1.0.0", "MIT", "Mass-spring system of Baudet on hexahedra",
              mss_baudet::MssBaudet)
