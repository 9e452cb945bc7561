// SPDX-License-Identifier: GPL-3.0-or-later
#include "suture/model.hpp"

#ifndef MEMORY_WIDTH
#define MEMORY_WIDTH 1
#endif
#ifndef MEMORY_VERSION
#define MEMORY_VERSION "1.0"
#endif

/// Edges that creep: the creep strain is a state that steps advance and rollbacks restore.
struct Memory : suture::model, suture::on_edges {
  static constexpr const char *id = "memory", *doc = "Springs that creep",
                              *formula = "f = k (l/L - 1 - q) u, q' = r (l/L - 1 - q)",
                              *citation = "none";
  enum { stiffness, rate };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N", "stiffness").above(0),
      suture::number("r", "1/s", "rate of the flow").at_least(0)};
  static constexpr suture::attribute attributes[] = {
      suture::edge_attribute("flow", "1", "q", MEMORY_WIDTH).copy().trial()};
  static constexpr suture::column<0> flow{};
  static constexpr auto cell_columns = suture::columns(flow);
  static constexpr auto reads = SUTURE_READ_POSITION | SUTURE_READ_REST;

  template <class Cell>
  static void force(const Cell& c) {
    const auto rest = c.rest(1) - c.rest(0);
    const auto d = c.position(1) - c.position(0);
    const auto inverse = rsqrt(dot(d, d));
    const auto strain = dot(d, d) * inverse * rsqrt(dot(rest, rest)) - 1.0 - c.column(flow);
    c.trial(flow, 0, c.column(flow) + c.dt() * c.parameter(rate) * strain);
    const auto pull = (c.parameter(stiffness) * strain * inverse) * d;
    c.force(0, pull);
    c.force(1, -pull);
  }
};
SUTURE_PLUGIN("memory", MEMORY_VERSION, "GPL-3.0-or-later", "Springs that creep", Memory)
