// SPDX-License-Identifier: MIT
//
// What each element gives to its vertices, edges and itself at rest; the host
// sums, at the start and after every cut.
#ifndef MSS_BAUDET_CONTRIBUTIONS_HPP
#define MSS_BAUDET_CONTRIBUTIONS_HPP

#include "box.hpp"
#include "suture/model.hpp"

namespace mss_baudet {

/// Parameters by position in the list of `MssBaudet`, and its columns likewise; 0 is the mass.
enum ParameterIndex { p_young, p_nu, p_rho, p_correction, p_viscosity, p_negative };
inline constexpr suture::column<1> stiffness{};
inline constexpr suture::column<2> rest_tension{};
inline constexpr suture::column<3> inner_stiffness{};
inline constexpr suture::column<4> inner_length{};
inline constexpr suture::column<5> correction_stiffness{};
inline constexpr suture::column<6> rest_box{};

inline constexpr const char* negative_words[] = {"clamp", "keep", "refuse"};

template <class Cell>
Material<typename Cell::real> material_of(const Cell& c) {
  const suture::values p = c.uniform_parameters();
  return {c.parameter(p_young), p[p_nu],
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
    const auto k = used_springs_of_box(material_of(c), box_lengths(rest_of(c)));
    for (int e = 0; e < 12; ++e) out.set(e, 0, k.edge[e / 4]);
  }
};

/// k l with the length of the edge itself: elements around it agree on that,
/// whatever their boxes are.
struct RestTensionShare {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    const auto k = used_springs_of_box(material_of(c), box_lengths(rest_of(c)));
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
    out.set(0, 0, springs_of_box(material_of(c), box_lengths(rest_of(c))).inner);
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
    if (c.uniform_parameters()[p_correction] != 0) {
      auto l = box_lengths(rest_of(c));
      for (int a = 0; a < 3; ++a) l[a] = to_40_bits(l[a]);
      B = correction_of_box(material_of(c), l);
    }
    for (int i = 0; i < 6; ++i) out.set(0, i, B.c[i]);
  }
};

struct BoxLengths {
  static constexpr int components = 3;
  template <class Cell, class Out>
  static void compute(const Cell& c, Out out) {
    const auto l = box_lengths(rest_of(c));
    const double on = c.uniform_parameters()[p_correction];
    for (int a = 0; a < 3; ++a) out.set(0, a, on * l[a]);
  }
};

}  // namespace mss_baudet

#endif
