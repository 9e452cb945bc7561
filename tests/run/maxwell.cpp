// SPDX-License-Identifier: GPL-3.0-or-later
#include "suture/model.hpp"

/// A spring and a dashpot in series on every edge: the strain q of the dashpot is a state, advanced
/// by implicit Euler within the step, so that the force depends on dt.
struct Maxwell : suture::model, suture::on_edges {
  static constexpr const char *id = "maxwell", *doc = "Springs and dashpots in series",
                              *formula = "f = k e u, e = l/L - 1 - q, q' = e/tau",
                              *citation = "none";
  enum { stiffness, relaxation };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N", "stiffness").above(0),
      suture::number("tau", "s", "relaxation time").above(0)};
  static constexpr suture::attribute attributes[] = {
      suture::edge_attribute("flow", "1", "q").copy().trial()};
  static constexpr suture::column<0> flow{};
  static constexpr auto cell_columns = suture::columns(flow);
  static constexpr auto reads = SUTURE_READ_POSITION | SUTURE_READ_REST;

  template <class Cell>
  static void force(const Cell& c) {
    const auto rest = c.rest(1) - c.rest(0);
    const auto d = c.position(1) - c.position(0);
    const auto inverse = rsqrt(dot(d, d));
    const auto strain = dot(d, d) * inverse * rsqrt(dot(rest, rest)) - 1.0;
    const auto elastic = (strain - c.column(flow)) * (1 / (1 + c.dt() / c.parameter(relaxation)));
    c.trial(flow, 0, strain - elastic);
    const auto pull = (c.parameter(stiffness) * elastic * inverse) * d;
    c.force(0, pull);
    c.force(1, -pull);
  }
};
SUTURE_PLUGIN("maxwell", "1.0", "GPL-3.0-or-later", "Springs and dashpots in series", Maxwell)
