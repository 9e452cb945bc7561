// SPDX-License-Identifier: GPL-3.0-or-later
// A whole model: edges that resist being stretched.
#include "suture/model.hpp"

struct Drag : suture::model, suture::on_edges {
  static constexpr const char* id = "outside-drag";
  static constexpr const char* doc = "Edges that resist being stretched";
  static constexpr const char* formula = "f = c ((v_1 - v_0) . u) u, u along the edge";
  static constexpr const char* citation = "textbook";
  enum { c };
  static constexpr suture::parameter parameters[] = {
      suture::number("c", "N s/m", "drag of one edge").at_least(0)};
  static constexpr auto reads = SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;
  template <class Cell>
  static void force(Cell& e) {
    const auto d = e.position(1) - e.position(0);
    const auto f = (e.parameter(c) * dot(e.velocity(1) - e.velocity(0), d) / dot(d, d)) * d;
    e.force(0, f);
    e.force(1, -f);
  }
};
SUTURE_PLUGIN("outside-drag", "1.0", "MIT", "Drag on edges", Drag)
