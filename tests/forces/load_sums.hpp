// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kernel/forces/force_term.hpp"
#include "kernel/forces/term_capabilities.hpp"
#include "tests/forces/spring_model.hpp"

/// Sums that tests of loads check.
namespace spring_model {

/// A block of springs, compiled: ready for terms.
struct Compiled : Body {
  explicit Compiled(const suture::BoxOptions& box) : Body(box) {
    add(defaults());
    compile(1);
  }
};

/// What a term adds, one force per vertex.
inline std::vector<suture::Vec3> forces_of_term(suture::Body& body, suture::ForceTerm& term,
                                                double time) {
  std::vector<double> rows(4 * std::size_t{body.attributes().vertex_count()});
  term.add_forces(time, {}, rows.data());
  std::vector<suture::Vec3> forces;
  for (std::size_t i = 0; i < rows.size(); i += 4)
    forces.push_back({rows[i], rows[i + 1], rows[i + 2]});
  return forces;
}

inline suture::Vec3 sum(const std::vector<suture::Vec3>& forces) {
  suture::Vec3 total{};
  for (const suture::Vec3& f : forces)
    for (std::size_t c = 0; c < 3; ++c) total[c] += f[c];
  return total;
}

/// The same forces, asked for at some vertices in another order.
inline void expect_the_same_at(suture::Body& body, suture::ForceTerm& term, double time) {
  const auto all = forces_of_term(body, term, time);
  std::vector<suture::Index> some;
  for (suture::Index v = body.attributes().vertex_count(); v-- > 0;)
    if (v % 3 != 1) some.push_back(v);
  suture::VertexSelection selection;
  selection.select(some, body.attributes().vertex_count());
  std::vector<suture::Vec3> forces(some.size());
  term.add_forces_at(selection, some, time, forces);
  for (std::size_t i = 0; i < some.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(forces[i][c], all[some[i]][c], 1e-13) << some[i];
}

/// The product of the tangents of cells of `nodes` each with a direction, cell by cell.
inline std::vector<double> product_by_cells(suture::CellTangentTerm& term,
                                            const std::vector<double>& d,
                                            const suture::TangentTime& at, suture::Index nodes) {
  const std::size_t size = 3 * std::size_t{nodes};
  std::vector<double> sum(d.size());
  term.for_each_tangent(1, 0, at, [&](const suture::CellTangents& cells) {
    ASSERT_EQ(cells.nodes, nodes);
    const auto place = [&](std::size_t cell, std::size_t i) {
      return std::size_t{cells.vertices[cell * nodes + i / 3]} * 3 + i % 3;
    };
    for (std::size_t l = 0; l < cells.cells; ++l)
      for (std::size_t j = 0; j < size; ++j)
        for (std::size_t i = 0; i < size; ++i)
          sum[place(l, i)] += cells.values[(j * size + i) * 8 + l] * d[place(l, j)];
  });
  return sum;
}

/// The faces across x = `where` between elements, each from its left side.
inline std::vector<suture::Seam> section(suture::Body& body, double where) {
  std::vector<suture::Seam> seams;
  for (suture::Dart d = 8; d < 24 * body.complex().element_count(); d += 24) {
    const suture::Index v = body.complex().vertices_of(d / 24)[1];
    if (std::abs(body.attributes().rest().get(v, 0) - where) < 1e-9 &&
        body.complex().beta3(d) != suture::none)
      seams.push_back({d, body.complex().beta3(d)});
  }
  return seams;
}

inline std::vector<suture::Dart> left_sides(const std::vector<suture::Seam>& seams) {
  std::vector<suture::Dart> faces;
  for (const suture::Seam& seam : seams) faces.push_back(seam.one);
  return faces;
}

}  // namespace spring_model
