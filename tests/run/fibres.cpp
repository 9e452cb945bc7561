// SPDX-License-Identifier: GPL-3.0-or-later
#include "suture/continuum.hpp"
#include "suture/model.hpp"

/// A neo-Hookean matrix with fibres that resist stretching; the law reads the parameters of each
/// element directly.
struct Fibres : suture::continuum<Fibres> {
  static constexpr const char *id = "fibres-of-test", *doc = "Neo-Hookean matrix with fibres",
                              *formula = "W = mu/2 (F:F - 3) - mu ln J + k/4 (|F a|^2 - 1)^2",
                              *citation = "textbook";
  enum { mu, k, rho, fibre };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus").above(0).per_element(),
      suture::number("k", "Pa", "Stiffness of the fibres").at_least(0).per_element(),
      suture::number("rho", "kg/m^3", "Density").above(0),
      suture::direction("fibre", "Direction of the fibres at rest")};
  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }
  template <class T, class P>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p) {
    const auto a = F * p.direction(fibre);
    const T stretch = dot(a, a) - 1.0;
    return 0.5 * p[mu] * (dot(F, F) - 3) - p[mu] * log(det(F)) + 0.25 * p[k] * (stretch * stretch);
  }
};

/// A bed of springs that an element has per volume, and that wears out: elements contribute their
/// stiffness to the nodes, whose charge and push the scene sets, and wear is a state of elements.
struct Bed : suture::model {
  static constexpr const char *id = "bed-of-test", *doc = "A bed that wears out",
                              *formula = "f = -b u + q p", *citation = "none";
  enum { stiffness, rate };
  static constexpr suture::parameter parameters[] = {
      suture::number("b", "N/m^4", "stiffness per volume").above(0).per_element(),
      suture::number("rate", "1/s", "growth of the wear").at_least(0).per_element()};

  struct Share {
    static constexpr int components = 1;
    template <class Cell, class Out>
    static void compute(const Cell& c, Out out) {
      const auto volume =
          dot(c.rest(1) - c.rest(0), cross(c.rest(2) - c.rest(0), c.rest(4) - c.rest(0)));
      for (int n = 0; n < 8; ++n) out.set(n, 0, c.parameter(stiffness) * 0.125 * volume);
    }
  };
  static constexpr suture::attribute attributes[] = {
      suture::vertex_attribute("bed", "N/m", "stiffness of a node")
          .from_volumes(suture::contribution<Bed, Share>),
      suture::vertex_attribute("charge", "1", "q").copy(),
      suture::vertex_attribute("push", "N", "p", 3).copy(),
      suture::volume_attribute("wear", "1", "grows with time").copy().starts_at(0.5).trial(),
      suture::edge_attribute("flaw", "1", "not used").copy()};
  static constexpr suture::column<0> bed{};
  static constexpr suture::column<1> charge{};
  static constexpr suture::column<2> push{};
  static constexpr suture::column<3> wear{};

  struct Nodes : suture::on_vertices {
    static constexpr const char *name = "nodes", *doc = "Springs to the ground";
    static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
    static constexpr auto vertex_columns = suture::columns(bed, charge, push);
    template <class Cell>
    static void force(Cell& c) {
      const auto q = c.vertex_column(charge, 0);
      const suture::vec3<typename Cell::real> p{
          c.vertex_column(push, 0, 0), c.vertex_column(push, 0, 1), c.vertex_column(push, 0, 2)};
      c.force(0, q * p - c.vertex_column(bed, 0) * (c.position(0) - c.rest(0)));
    }
  };
  struct Wear : suture::on_volumes {
    static constexpr const char *name = "wear", *doc = "Lets the bed wear out";
    static constexpr bool element_parameters = true;
    static constexpr auto reads = 0u;
    static constexpr auto cell_columns = suture::columns(wear);
    template <class Cell>
    static void force(Cell& c) {
      using T = typename Cell::scalar;
      c.trial(wear, 0, c.column(wear) + c.dt() * c.parameter(rate));
      for (int n = 0; n < 8; ++n) c.force(n, suture::vec3<T>{T(0.0), T(0.0), T(0.0)});
    }
  };
  using functors = suture::list<Nodes, Wear>;
};
SUTURE_PLUGIN("fibres-of-test", "1.0", "MIT", "Values from the mesh", Fibres, Bed)
