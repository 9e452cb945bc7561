// SPDX-License-Identifier: GPL-3.0-or-later
// A whole model: edges that resist their own motion.
#include "suture/model.hpp"

struct Drag : suture::model, suture::on_edges {
  static constexpr const char* id = "outside-drag";
  static constexpr const char* doc = "Edges that resist their own motion";
  static constexpr const char* formula = "f_n = -c v_n / 2";
  static constexpr const char* citation = "Stokes 1851";
  enum { c };
  static constexpr suture::parameter parameters[] = {
      suture::number("c", "N s/m", "drag of one edge").at_least(0)};
  static constexpr auto reads = SUTURE_READ_VELOCITY;
  template <class Cell>
  static void force(Cell& e) {
    for (int n = 0; n < 2; ++n) e.force(n, -0.5 * e.parameter(c) * e.velocity(n));
  }
};
SUTURE_PLUGIN("outside-drag", "1.0", "MIT", "Drag on edges", Drag)
