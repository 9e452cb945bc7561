// SPDX-License-Identifier: MIT
//
// The mass-spring system of Baudet for hexahedra, on the cells of the map: one
// spring per edge, summed over the elements around it, and four inner diagonals
// per element. See README.md for the equations and their sources.
#include <cstdio>
#include <string>

#include "springs.hpp"
#include "suture/model.hpp"

namespace mss_baudet {

/// Parameters and attributes by position in the lists of `MssBaudet`.
enum ParameterIndex { p_young, p_nu, p_rho, p_correction, p_viscosity, p_negative };
enum AttributeIndex {
  a_mass,
  a_stiffness,
  a_rest_tension,
  a_inner_stiffness,
  a_inner_length,
  a_correction,
  a_box
};

inline constexpr const char* negative_words[] = {"clamp", "keep", "refuse"};

inline Material material_of(const suture::values& p) {
  return {p[p_young], p[p_nu], p[p_rho],
          static_cast<NegativeStiffness>(static_cast<int>(p[p_negative]))};
}

/// Position of a node of a cell, at rest or now, as box.hpp asks for it.
template <class Cell>
SUTURE_INLINE auto rest_of(const Cell& c) {
  return [&c](int n) { return c.rest(n); };
}
template <class Cell>
SUTURE_INLINE auto position_of(const Cell& c) {
  return [&c](int n) { return c.position(n); };
}

template <class Cell, class Mask>
[[gnu::cold, gnu::noinline]] void fail_zero_length(const Cell& c, const Mask& good) {
  c.require(good, suture::failure(SUTURE_RETRY,
                                  "the ends of a spring coincide, or their positions are no "
                                  "numbers: its force has no direction; reduce dt or the load"));
}

// ------------------------------------------------------------ contributions --
// What each element gives to its vertices, edges and itself; the host sums.

struct MassShare {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    const auto share = c.parameter(p_rho) * 0.125 * volume(rest_of(c));
    for (int n = 0; n < 8; ++n) out.set(n, 0, share);
  }
};

struct StiffnessShare {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    const auto k = used_springs_of_box(material_of(c.parameters()), box_lengths(rest_of(c)));
    for (int e = 0; e < 12; ++e) out.set(e, 0, k.edge[e / 4]);
  }
};

/// k l with the length of the edge itself: elements around it agree on that,
/// whatever their boxes are.
struct RestTensionShare {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    const auto k = used_springs_of_box(material_of(c.parameters()), box_lengths(rest_of(c)));
    for (int e = 0; e < 12; ++e) {
      const auto* ends = suture_hexahedron_edges[e];
      out.set(e, 0, k.edge[e / 4] * norm(c.rest(ends[1]) - c.rest(ends[0])));
    }
  }
};

struct InnerStiffness {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    out.set(0, 0, springs_of_box(material_of(c.parameters()), box_lengths(rest_of(c))).inner);
  }
};

struct InnerLength {
  static constexpr int components = 4;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    for (int s = 0; s < 4; ++s) out.set(0, s, norm(c.rest(7 - s) - c.rest(s)));
  }
};

/// Zero without correction. Lengths are rounded so that the elements of a grid,
/// which differ by the rounding of their coordinates, agree to the bit although D
/// is a small difference of large terms: a column of equal values is stored once.
struct Correction {
  static constexpr int components = 6;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    using R = typename Cell::real;
    suture::sym3<R> B{R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)};
    if (c.parameter(p_correction) != 0) {
      auto l = box_lengths(rest_of(c));
      for (int a = 0; a < 3; ++a) l[a] = to_40_bits(l[a]);
      B = correction_of_box(material_of(c.parameters()), l);
    }
    for (int i = 0; i < 6; ++i) out.set(0, i, B.c[i]);
  }
};

struct BoxLengths {
  static constexpr int components = 3;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    const auto l = box_lengths(rest_of(c));
    const double on = c.parameter(p_correction);
    for (int a = 0; a < 3; ++a) out.set(0, a, on * l[a]);
  }
};

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
    return (p[p_viscosity] > 0) == with_viscosity;
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
    return (p[p_viscosity] > 0) == with_viscosity && (p[p_correction] != 0) == with_correction;
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
  static void inspect(const Cell& c);
};

// ----------------------------------------------------------------- warnings --

inline std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

/// Lane of the first cell in which `where` holds.
template <class Mask>
int first_of(const Mask& where) {
  int i = 0;
  while (!where[i]) ++i;
  return i;
}

/// Rest shapes outside of the formulas' range, to 1e-6 of the edges' lengths.
template <class Cell>
auto is_no_box(const Cell& c) {
  const auto node = rest_of(c);
  const vec3<typename Cell::real> A[3] = {mean_edge(node, 0), mean_edge(node, 1),
                                          mean_edge(node, 2)};
  auto bad = dot(A[0], A[0]) < 0.0;
  for (int e = 0; e < 12; ++e) {
    const auto* ends = suture_hexahedron_edges[e];
    const auto off = node(ends[1]) - node(ends[0]) - A[e / 4];
    bad = bad | (dot(off, off) > 1e-12 * dot(A[e / 4], A[e / 4]));
  }
  for (int a = 0; a < 3; ++a) {
    const auto& b = A[(a + 1) % 3];
    const auto cosine = dot(A[a], b);
    bad = bad | (cosine * cosine > 1e-12 * dot(A[a], A[a]) * dot(b, b));
  }
  return bad;
}

template <class Cell>
void inspect_shape(const Cell& c) {
  using suture::max;
  using suture::min;
  const auto bad = is_no_box(c);
  if (any(bad))
    c.report(SUTURE_WARNING, bad, "not-a-box",
             "the rest shape is no box, for which the springs are derived; the box of its mean "
             "edges is taken, with the real lengths as rest lengths");
  const auto l = box_lengths(rest_of(c));
  const auto ratio = max(max(l[0], l[1]), l[2]) / min(min(l[0], l[1]), l[2]);
  const auto flat = ratio > 1.2;
  if (any(flat))
    c.report(SUTURE_WARNING, flat, "aspect-ratio",
             "the edges have the ratio " + number(ratio[first_of(flat)]) +
                 ": the three shear moduli then differ by up to its square, as one inner spring "
                 "cannot meet them all; keep below 1.2");
}

template <class Cell>
void inspect_stiffness(const Cell& c) {
  using suture::min;
  const Material m = material_of(c.parameters());
  const auto k = springs_of_box(m, box_lengths(rest_of(c)));
  const auto least = min(min(k.edge[0], k.edge[1]), k.edge[2]);
  const auto negative = least < 0.0;
  if (!any(negative)) return;
  const char* then = m.negative == clamp  ? "; it is set to 0"
                     : m.negative == keep ? "; it is used as it is, and may be unstable"
                                          : "";
  c.report(m.negative == refuse ? SUTURE_ERROR : SUTURE_WARNING, negative, "negative-stiffness",
           "the box is so long that the formula gives an edge the stiffness " +
               number(least[first_of(negative)]) + " N/m" + then +
               " (parameter negative_stiffness); use boxes of edge ratio below 1.2");
}

template <bool with_viscosity, bool with_correction>
template <class Cell>
void InnerSprings<with_viscosity, with_correction>::inspect(const Cell& c) {
  inspect_shape(c);
  inspect_stiffness(c);
}

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
