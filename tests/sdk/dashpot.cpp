// SPDX-License-Identifier: MIT
#include "suture/model.hpp"

/// Everything that a functor on edges may declare, in little space: a spring with
/// a dashpot, whose columns are summed from the elements.
struct Dashpot : suture::model, suture::on_edges {
  static constexpr const char *id = "dashpot", *doc = "Kelvin-Voigt springs on edges",
                              *formula = "f = k (L - l) u + c (dv.u) u", *citation = "textbook";
  enum { stiffness, damping, mode };
  static constexpr const char* modes[] = {"linear", "refuse", "throw"};
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N/m", "Stiffness per element").above(0),
      suture::number("c", "N s/m", "Damping").at_least(0).below(1e6).or_else(0.5),
      suture::choice("mode", "linear, or one of two ways to fail", modes)};

  struct RestLength {
    static constexpr int components = 2;
    template <class Cell, class Out>
    static void compute(const Cell& c, const Out& out) {
      for (int k = 0; k < 12; ++k) {
        const auto& e = suture_hexahedron_edges[k];
        out.set(k, 0, norm(c.rest(e[1]) - c.rest(e[0])));
        out.set(k, 1, 1.0);
      }
    }
  };
  static constexpr suture::attribute attributes[] = {
      suture::edge_attribute("rest", "m", "Sum of rest lengths, and of ones", 2)
          .from_volumes(suture::contribution<Dashpot, RestLength>)};
  static constexpr suture::column<0> lengths{};
  static constexpr auto cell_columns = suture::columns(lengths);
  static constexpr auto vertex_columns = suture::columns(suture::vertex_mass);
  static constexpr auto reads = SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;

  struct Constants {
    double twice_k;
  };
  static void prepare(const suture::setup& p, Constants& c) {
    if (p[mode] == 1) p.refuse("refused", "mode refuse was asked for");
    c.twice_k = 2 * p[stiffness];
  }
  static bool enabled(const suture::values& p, std::uint32_t& reads) {
    if (p[damping] == 0) reads &= ~std::uint32_t(SUTURE_READ_VELOCITY);
    return true;
  }

  template <class Cell>
  static void force(const Cell& c) {
    const auto d = c.position(1) - c.position(0);
    const auto inverse_length = rsqrt(dot(d, d));
    const auto u = d * inverse_length;
    const auto length = dot(d, d) * inverse_length;
    if (c.parameter(mode) == 2)
      c.require(length < 2.0, suture::failure(SUTURE_RETRY, "an edge is longer than 2 m"));
    const auto rest = c.column(lengths, 0) / c.column(lengths, 1);
    const auto rate = dot(c.velocity(1) - c.velocity(0), u);
    const auto tension =
        0.5 * c.constants().twice_k * (length - rest) + c.parameter(damping) * rate;
    c.force(0, tension * u);
    c.force(1, -(tension * u));
  }
};
SUTURE_PLUGIN("dashpot", "1.0", "MIT", "Test of the C++ layer", Dashpot)
