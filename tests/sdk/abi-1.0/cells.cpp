// SPDX-License-Identifier: MIT
#include "suture/model.hpp"

/// Springs whose rest lengths are summed from the elements, with a state: an edge that was
/// stretched too far is slack for good.
struct Springs : suture::model, suture::on_edges {
  static constexpr const char *id = "abi-springs", *doc = "Springs on edges that break",
                              *formula = "E = k/2 (l - L)^2 until l/L reaches the limit",
                              *citation = "textbook";
  enum { k, limit };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N/m", "Stiffness of an edge per element").above(0),
      suture::number("limit", "1", "Stretch at which an edge breaks").above(1).or_else(1.5)};

  struct RestLength {
    static constexpr int components = 2;
    template <class Cell, class Out>
    static void compute(const Cell& c, const Out& out) {
      for (int i = 0; i < 12; ++i) {
        const auto& e = suture_hexahedron_edges[i];
        out.set(i, 0, norm(c.rest(e[1]) - c.rest(e[0])));
        out.set(i, 1, 1.0);
      }
    }
  };
  static constexpr suture::attribute attributes[] = {
      suture::edge_attribute("rest", "m", "Sum of rest lengths, and of ones", 2)
          .from_volumes(suture::contribution<Springs, RestLength>),
      suture::edge_attribute("longest", "1", "Largest stretch so far").copy().trial()};
  static constexpr suture::column<0> lengths{};
  static constexpr suture::column<1> longest{};
  static constexpr auto cell_columns = suture::columns(lengths, longest);

  template <class Cell>
  static void force(const Cell& c) {
    const auto d = c.position(1) - c.position(0);
    const auto L = c.column(lengths, 0) / c.column(lengths, 1);
    const auto l = norm(d);
    const auto largest = max(l / L, 0.0 * l + c.column(longest));
    c.trial(longest, 0, largest);
    const auto k_sum = c.parameter(k) * c.column(lengths, 1);
    const auto tension = select(largest < c.parameter(limit), k_sum * (l - L), 0.0 * l);
    c.force(0, d * (tension / l));
    c.force(1, -(d * (tension / l)));
  }
};

/// Surface tension on the boundary.
struct Skin : suture::model, suture::on_faces {
  static constexpr const char *id = "abi-skin", *doc = "Surface tension on the boundary",
                              *formula = "E = gamma A", *citation = "textbook";
  enum { gamma };
  static constexpr suture::parameter parameters[] = {
      suture::number("gamma", "N/m", "Surface tension").at_least(0)};
  static constexpr std::uint32_t faces = SUTURE_BOUNDARY_FACES;
  static constexpr suture_field fields[] = {suture::field("area", "m^2", "Area of the face")};

  template <class Cell>
  static auto twice_the_area(const Cell& c) {
    return cross(c.position(2) - c.position(0), c.position(3) - c.position(1));
  }
  template <class Cell>
  static void force(const Cell& c) {
    const auto a = twice_the_area(c);
    const auto n = a * (0.5 * c.parameter(gamma) / norm(a));
    const auto f2 = cross(n, c.position(3) - c.position(1));
    const auto f3 = cross(c.position(2) - c.position(0), n);
    c.force(2, f2);
    c.force(0, -f2);
    c.force(3, f3);
    c.force(1, -f3);
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    return 0.5 * c.parameter(gamma) * norm(twice_the_area(c));
  }
  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    out.set(0, 0.5 * norm(twice_the_area(c)));
  }
};

/// A drag on the nodes, by their mass.
struct Drag : suture::model, suture::on_vertices {
  static constexpr const char *id = "abi-drag", *doc = "Drag by mass", *formula = "f = -c m v",
                              *citation = "textbook";
  enum { c };
  static constexpr suture::parameter parameters[] = {
      suture::number("c", "1/s", "Drag per mass").at_least(0)};
  static constexpr std::uint32_t reads = SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;
  static constexpr auto vertex_columns = suture::columns(suture::vertex_mass);

  template <class Cell>
  static void force(const Cell& node) {
    const auto m = node.vertex_column(suture::vertex_mass, 0);
    node.force(0, (-node.parameter(c) * m) * node.velocity(0));
  }
};
SUTURE_PLUGIN("abi-cells", "0.1.0", "MIT", "Models on edges, faces and nodes", Springs, Skin, Drag)
