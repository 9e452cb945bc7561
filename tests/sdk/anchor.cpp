// SPDX-License-Identifier: MIT
#include "suture/model.hpp"

struct Anchor : suture::model, suture::on_vertices {
  static constexpr const char *id = "anchor", *doc = "Holds every node at its rest position",
                              *formula = "f = -k (x - X) - c m v", *citation = "textbook";
  enum { k, c };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N/m", "Stiffness of a node").at_least(0),
      suture::number("c", "1/s", "Drag per mass").at_least(0).or_else(0)};
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;
  static constexpr auto vertex_columns = suture::columns(suture::vertex_mass);

  template <class Cell>
  static void force(Cell& node) {
    const auto m = node.vertex_column(suture::vertex_mass, 0);
    const auto u = node.position(0) - node.rest(0);
    node.force(0, -node.parameter(k) * u - (node.parameter(c) * m) * node.velocity(0));
  }
  template <class Cell>
  static auto energy(const Cell& node) {
    const auto u = node.position(0) - node.rest(0);
    return 0.5 * node.parameter(k) * dot(u, u);
  }
};
SUTURE_PLUGIN("anchor", "1.0", "MIT", "Springs to the ground", Anchor)
