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

// ------------------------------------------------------------- edge springs --

/// Two functors, of which a scene runs one: without viscosity neither velocities
/// nor masses are gathered.
template <bool with_viscosity>
struct EdgeSprings : suture::on_edges {
  static constexpr const char* name =
      with_viscosity ? "edge springs with viscosity" : "edge springs";
  static constexpr const char* doc = "One spring along each edge, of all elements around it.";
  static constexpr std::uint32_t reads =
      SUTURE_READ_POSITION | (with_viscosity ? SUTURE_READ_VELOCITY : 0);
  static constexpr auto cell_columns = suture::columns(a_stiffness, a_rest_tension);
  static constexpr auto vertex_columns = [] {
    if constexpr (with_viscosity)
      return suture::columns(suture::vertex_mass);
    else
      return suture::columns();
  }();
  static constexpr int witnesses = 1;

  static bool enabled(const suture::values& p, std::uint32_t&) {
    return (p[p_viscosity] > 0 || p.everything()) == with_viscosity;
  }

  template <class Cell>
  SUTURE_INLINE static auto gamma(const Cell& c) {
    return viscosity(c.parameter(p_viscosity), c.column(0),
                     c.vertex_column(0, 0) + c.vertex_column(0, 1));
  }

  template <class Cell>
  SUTURE_INLINE static void force(Cell& c) {
    const auto d = c.position(1) - c.position(0);
    const auto square = dot(d, d);
    const auto good = is_length_squared(square);
    if (__builtin_expect(!all(good), 0)) fail_zero_length(c, good);
    const auto inverse = rsqrt(square);
    auto scale = elastic(inverse, c.column(0), c.column(1));
    if constexpr (with_viscosity)
      scale += viscous(d, c.velocity(1) - c.velocity(0), inverse, gamma(c));
    const auto f = d * scale;
    c.force(0, f);
    c.force(1, -f);
  }

  /// L/K; 0 where the spring is clamped away.
  template <class Cell>
  static auto rest_length(const Cell& c) {
    const auto K = c.column(0);
    return select(K == 0.0, K, c.column(1) / select(K == 0.0, K + 1.0, K));
  }

  template <class Cell>
  static auto energy(const Cell& c) {
    return spring_energy(norm(c.position(1) - c.position(0)), c.column(0), rest_length(c));
  }

  template <class Cell, class Bounds>
  static void bounds(const Cell& c, Bounds& out) {
    const auto d = c.position(1) - c.position(0);
    const auto inverse = rsqrt(dot(d, d));
    const auto u = d * inverse;
    const auto k = stiffness_bound(u, c.column(0), elastic(inverse, c.column(0), c.column(1)));
    for (int n = 0; n < 2; ++n) out.stiffness(n, k);
    if constexpr (with_viscosity) {
      const auto viscous = damping_bound(u, gamma(c));
      for (int n = 0; n < 2; ++n) out.damping(n, viscous);
    }
  }

  static constexpr suture_field fields[] = {
      suture::field("strain", "1", "elongation of the edge over its rest length"),
      suture::field("tension", "N", "elastic force along the edge, positive if it pulls")};

  template <class Cell, class Results>
  static void output(const Cell& c, Results& out) {
    const auto d = c.position(1) - c.position(0);
    const auto length = norm(d);
    const auto rest = rest_length(c);
    const auto stretch = length - rest;
    out.set(0, select(rest == 0.0, rest, stretch / select(rest == 0.0, rest + 1.0, rest)));
    out.set(1, c.column(0) * stretch);
  }
};

// ------------------------------------------------- inner springs, correction --

/// Four functors, of which a scene runs one.
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
  static constexpr auto cell_columns = [] {
    if constexpr (with_correction)
      return suture::columns(a_inner_stiffness, a_inner_length, a_correction, a_box);
    else
      return suture::columns(a_inner_stiffness, a_inner_length);
  }();
  static constexpr auto vertex_columns = [] {
    if constexpr (with_viscosity)
      return suture::columns(suture::vertex_mass);
    else
      return suture::columns();
  }();
  static constexpr int witnesses = 4;  // springs end at nodes 0..3, the correction at all

  static bool enabled(const suture::values& p, std::uint32_t&) {
    return (p[p_viscosity] > 0 || p.everything()) == with_viscosity &&
           (p[p_correction] != 0 || p.everything()) == with_correction;
  }

  template <class Cell>
  SUTURE_INLINE static auto gamma(const Cell& c, int s) {
    return viscosity(c.parameter(p_viscosity), c.column(0),
                     c.vertex_column(0, s) + c.vertex_column(0, 7 - s));
  }

  template <class Cell>
  SUTURE_INLINE static auto correction(const Cell& c) {
    using T = typename Cell::scalar;
    using R = typename Cell::real;
    const suture::sym3<R> B{c.column(2, 0), c.column(2, 1), c.column(2, 2),
                            c.column(2, 3), c.column(2, 4), c.column(2, 5)};
    return CorrectedBox<T>(position_of(c), B,
                           vec3<R>{c.column(3, 0), c.column(3, 1), c.column(3, 2)});
  }

  template <class Cell>
  SUTURE_INLINE static void force(Cell& c) {
    using T = typename Cell::scalar;
    const auto K = c.column(0);
    vec3<T> f[8];
    auto smallest = T(1e300);
    for (int s = 0; s < 4; ++s) {
      const auto d = c.position(7 - s) - c.position(s);
      const T square = dot(d, d);
      smallest = select(square < smallest, square, smallest);
      const T inverse = rsqrt(square);
      T scale = elastic(inverse, K, K * c.column(1, s));
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
    auto sum = 0.0 * c.column(0);
    for (int s = 0; s < 4; ++s)
      sum += spring_energy(norm(c.position(7 - s) - c.position(s)), c.column(0), c.column(1, s));
    if constexpr (with_correction) sum += correction(c).energy();
    return sum;
  }

  template <class Cell, class Bounds>
  static void bounds(const Cell& c, Bounds& out) {
    using R = typename Cell::real;
    suture::sym3<R> common{R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)};
    if constexpr (with_correction) {
      const suture::sym3<R> B{c.column(2, 0), c.column(2, 1), c.column(2, 2),
                              c.column(2, 3), c.column(2, 4), c.column(2, 5)};
      common = stiffness_bound(correction(c), B);
    }
    for (int s = 0; s < 4; ++s) {
      const auto d = c.position(7 - s) - c.position(s);
      const auto inverse = rsqrt(dot(d, d));
      const auto u = d * inverse;
      const R K = c.column(0);
      const auto k = stiffness_bound(u, K, elastic(inverse, K, K * c.column(1, s))) + common;
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
      suture::number("E", "Pa", "Young's modulus").above(0),
      suture::number("nu", "1", "Poisson's ratio; without correction the lattice has 1/(3+4nu)")
          .above(-0.25)
          .below(0.5),
      suture::number("rho", "kg/m^3", "density").above(0),
      suture::boolean("correction",
                      "forces that make a lattice of boxes show E and nu exactly in small strain",
                      false),
      suture::number("viscosity", "1",
                     "viscosity of the springs: 1 is the paper's (and costs a factor 5 to 7 in "
                     "the stable step), 0 is none")
          .at_least(0)
          .or_else(0),
      suture::choice("negative_stiffness",
                     "edges to which the formula gives a stiffness below 0: set to 0, used as they "
                     "are, or refused",
                     negative_words)};

  template <class C>
  static constexpr suture_contribution_fn sum = suture::contribution<MssBaudet, C>;

  static constexpr suture::attribute attributes[] = {
      suture::on_vertices("mass", "kg", "lumped mass, sum of rho V / 8")
          .from_volumes(sum<MassShare>)
          .flag(SUTURE_SHARED_MASS),
      suture::on_edge_cells("stiffness", "N/m", "sum of k_e over the elements at the edge")
          .from_volumes(sum<StiffnessShare>)
          .output(),
      suture::on_edge_cells("rest_tension", "N", "sum of k_e l_e; over the stiffness: rest length")
          .from_volumes(sum<RestTensionShare>),
      suture::on_volume_cells("inner_stiffness", "N/m", "of each inner diagonal")
          .from_volumes(sum<InnerStiffness>),
      suture::on_volume_cells("inner_length", "m", "rest lengths of the inner diagonals", 4)
          .from_volumes(sum<InnerLength>),
      suture::on_volume_cells("correction_stiffness", "N/m",
                              "B of the correction's energy, XX YY ZZ XY YZ XZ", 6)
          .from_volumes(sum<Correction>),
      suture::on_volume_cells("box", "m", "lengths of the mean edges at rest", 3)
          .from_volumes(sum<BoxLengths>)};

  using functors =
      suture::list<EdgeSprings<false>, EdgeSprings<true>, InnerSprings<false, false>,
                   InnerSprings<true, false>, InnerSprings<false, true>, InnerSprings<true, true>>;

  /// Says what the lattice shows where that is 2 % or more from what was asked for.
  static void prepare(const suture::setup& p, suture::no_constants&) {
    const Material m = material_of(p);
    const double off = lattice_young(m) / m.E - 1;
    if (p[p_correction] != 0 || std::fabs(off) < 0.02) return;
    p.warn("lattice-moduli",
           "without correction a lattice of cubes shows E = " + number(lattice_young(m)) +
               " Pa and nu = " + number(lattice_nu(m)) + " instead of " + number(m.E) + " Pa and " +
               number(m.nu) + " (they agree at nu = 0.25); set \"correction\": true");
  }
};

}  // namespace mss_baudet

SUTURE_PLUGIN("mss-baudet", "1.0.0", "MIT", "Mass-spring system of Baudet on hexahedra",
              mss_baudet::MssBaudet)
