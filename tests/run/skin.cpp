// SPDX-License-Identifier: GPL-3.0-or-later
#include "suture/model.hpp"

/// Surface tension: E = gamma A on every boundary face, with the vector area of the quadrilateral,
/// A = |a|, a = (x2 - x0) x (x3 - x1) / 2.
struct Skin : suture::model, suture::on_faces {
  static constexpr const char *id = "skin", *doc = "Surface tension on the boundary",
                              *formula = "E = gamma A", *citation = "none";
  enum { gamma };
  static constexpr suture::parameter parameters[] = {
      suture::number("gamma", "N/m", "surface tension").at_least(0)};
  static constexpr std::uint32_t faces = SUTURE_BOUNDARY_FACES;
  static constexpr suture_field fields[] = {suture::field("area", "m^2", "area of the face")};

  template <class Cell>
  static auto twice_the_area(const Cell& c) {
    return cross(c.position(2) - c.position(0), c.position(3) - c.position(1));
  }
  template <class Cell>
  static void force(const Cell& c) {
    const auto a = twice_the_area(c);
    const auto n = a * (0.5 * c.parameter(gamma) / sqrt(dot(a, a)));
    const auto f2 = cross(n, c.position(3) - c.position(1));
    const auto f3 = cross(c.position(2) - c.position(0), n);
    c.force(2, f2);
    c.force(0, -f2);
    c.force(3, f3);
    c.force(1, -f3);
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    const auto a = twice_the_area(c);
    return 0.5 * c.parameter(gamma) * sqrt(dot(a, a));
  }
  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    const auto a = twice_the_area(c);
    out.set(0, 0.5 * sqrt(dot(a, a)));
  }
};

/// The same with a field of that name, but of three components: the vector area.
struct VectorSkin : Skin {
  static constexpr const char* id = "vector-skin";
  static constexpr suture_field fields[] = {suture::field("area", "m^2", "area vector", 3)};

  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    const auto a = twice_the_area(c);
    for (int i = 0; i < 3; ++i) out.set(0, i, 0.5 * a[i]);
  }
};
/// A force across the displacement, which has no energy and no symmetric tangent.
struct Swirl : suture::model, suture::on_vertices {
  static constexpr const char *id = "swirl", *doc = "A force across the displacement",
                              *formula = "f = k z x (x - X)", *citation = "none";
  enum { k };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N/m", "stiffness").at_least(0)};
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION;

  template <class Cell>
  static void force(const Cell& node) {
    const auto u = node.position(0) - node.rest(0);
    node.force(0, node.parameter(k) * cross(suture::vec3<double>{0, 0, 1}, u));
  }
};
SUTURE_PLUGIN("skin", "1.0", "GPL-3.0-or-later", "Forces of tests", Skin, VectorSkin, Swirl)
