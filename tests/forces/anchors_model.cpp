// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/forces/anchors_model.hpp"

#include "suture/model.hpp"

namespace {

/// Every vertex hangs by a spring from where it was at rest, and is braked by its mass.
struct Anchors : suture::model, suture::on_vertices {
  static constexpr const char *id = "anchors", *doc = "Springs to the ground",
                              *formula = "f = -k w (x - X) - c m v", *citation = "textbook";
  enum { stiffness, drag };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N/m", "stiffness").at_least(0),
      suture::number("c", "1/s", "drag per mass").at_least(0)};

  struct Mass {
    static constexpr int components = 1;
    template <class Cell, class Out>
    static void compute(const Cell& c, const Out& out) {
      const auto l = c.rest(7) - c.rest(0);
      for (int n = 0; n < 8; ++n) out.set(n, 0, abs(l[0] * l[1] * l[2]) * 125.0);
    }
  };
  struct Weight {
    static constexpr int components = 2;
    template <class Cell, class Out>
    static void compute(const Cell&, const Out& out) {
      for (int n = 0; n < 8; ++n) out.set(n, 0, 1.0), out.set(n, 1, 1.0 + n);
    }
  };
  static constexpr suture::attribute attributes[] = {
      suture::vertex_attribute("mass", "kg", "an eighth of every element")
          .from_volumes(suture::contribution<Anchors, Mass>)
          .flag(SUTURE_SHARED_MASS),
      suture::vertex_attribute("weight", "1", "elements around it, and a sum of corners", 2)
          .from_volumes(suture::contribution<Anchors, Weight>),
      suture::vertex_attribute("path", "m", "sum of what it was away at every step, and steps", 3)
          .copy()
          .trial()};
  static constexpr suture::column<1> weight{};
  static constexpr suture::column<2> path{};
  static constexpr auto cell_columns = suture::columns(weight, path);
  static constexpr auto vertex_columns = suture::columns(suture::vertex_mass, weight);
  static constexpr std::uint32_t reads =
      SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;

  static bool enabled(const suture::values& p, std::uint32_t& wanted) {
    if (p[drag] == 0) wanted &= ~std::uint32_t{SUTURE_READ_VELOCITY};
    return true;
  }
  template <class Cell>
  static auto spring(const Cell& c) {
    return c.parameter(stiffness) * (c.column(weight, 0) + c.vertex_column(weight, 0, 1));
  }
  template <class Cell>
  static void force(const Cell& c) {
    const auto away = c.position(0) - c.rest(0);
    const auto brake = c.parameter(drag) * c.vertex_column(suture::vertex_mass, 0);
    c.force(0, away * (-spring(c)) - brake * c.velocity(0));
    c.trial(path, 0, c.column(path, 0) + dot(away, away));
    c.trial(path, 1, c.column(path, 1) + 1.0);
    c.trial(path, 2, c.column(path, 2));
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    const auto away = c.position(0) - c.rest(0);
    return 0.5 * spring(c) * dot(away, away);
  }
};

}  // namespace

const suture_model& anchors_model() {
  static constexpr suture_model table = suture::detail::model_of<Anchors>();
  return table;
}
