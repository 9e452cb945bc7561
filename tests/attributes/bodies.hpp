// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "kernel/attributes/attributes.hpp"
#include "kernel/mesh/box.hpp"
#include "tests/attributes/fake_models.hpp"

/// Random bodies with fake models, for tests of what follows an operation.
namespace suture {

struct Random : std::mt19937_64 {
  explicit Random(std::uint64_t seed = std::random_device{}())
      : std::mt19937_64(seed), trace(__FILE__, __LINE__, "seed " + std::to_string(seed)) {}
  double number() { return std::uniform_real_distribution<double>(-1, 1)(*this); }
  testing::ScopedTrace trace;
};

/// A box of nx x ny x nz unit cells, its vertices moved at random by `distortion`.
struct FakeBody {
  CellComplex complex;
  std::vector<Vec3> rest;

  explicit FakeBody(std::array<Index, 3> cells, Random* random = nullptr, double distortion = 0.2) {
    BoxOptions box;
    box.cells = cells;
    box.size = {double(cells[0]), double(cells[1]), double(cells[2])};
    Mesh mesh = make_box(box);
    rest = mesh.points;
    if (random)
      for (Vec3& p : rest)
        for (double& x : p) x += distortion * random->number();
    complex = CellComplex(mesh.hexahedra, static_cast<Index>(rest.size()));
  }
};

inline Instance& add(Attributes& attributes, CellComplex& complex, const suture_model& model,
                     std::vector<Index> elements = {}, double rho = 1) {
  Diagnostics diagnostics;
  return attributes.add(std::make_unique<Instance>(model, "body", std::vector{rho}, diagnostics),
                        complex, std::move(elements));
}

inline void initialise(Attributes& attributes, const CellComplex& complex) {
  Diagnostics diagnostics;
  attributes.initialise(complex, diagnostics);
}

inline std::vector<Dart> random_faces(const CellComplex& complex, Random& random, double fraction) {
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
    if (complex.can_cut(d) && (random.number() + 1) / 2 < fraction) faces.push_back(d);
  return faces;
}

inline std::vector<Vec3> rest_of(Attributes& attributes) {
  std::vector<Vec3> rest(attributes.vertex_count());
  for (Index v = 0; v < rest.size(); ++v)
    for (int c = 0; c < 3; ++c) rest[v][static_cast<std::size_t>(c)] = attributes.rest().get(v, c);
  return rest;
}

/// Every row of every from_volumes column, by cell: the same bits in both.
inline void expect_same_sums(const Attributes& a, const Attributes& b) {
  for (Index v = 0; v < a.kernel(0).cells.size(); ++v)
    ASSERT_EQ(a.kernel(0).columns[4].get(v, 0), b.kernel(0).columns[4].get(v, 0)) << "mass " << v;
  for (std::size_t i = 0; i < a.instances().size(); ++i)
    for (int d = 0; d < 4; ++d) {
      const Table &s = a.instances()[i]->table(d), &t = b.instances()[i]->table(d);
      ASSERT_EQ(s.cells.live_count(), t.cells.live_count())
          << "dimension " << d << " of instance " << i << " of " << a.instances().size()
          << ", elements " << a.instances()[i]->table(3).cells.live_count() << " and "
          << b.instances()[i]->table(3).cells.live_count();
      for (Index row = 0; row < s.cells.size(); ++row) {
        if (!s.cells.is_live(row)) continue;
        const Index cell = s.cells.cell(row), other = t.cells.row(cell);
        ASSERT_NE(other, none) << "cell " << cell << " of dimension " << d;
        for (std::size_t k = 0; k < s.columns.size(); ++k) {
          if (s.columns[k].spec().policy != SUTURE_FROM_VOLUMES) continue;
          for (int c = 0; c < s.columns[k].spec().components; ++c)
            ASSERT_EQ(s.columns[k].get(row, c), t.columns[k].get(other, c))
                << s.columns[k].spec().name << " of cell " << cell;
        }
      }
    }
}

inline double total(const Column& column, int component = 0) {
  double sum = 0;
  for (Index row = 0; row < column.size(); ++row) sum += column.get(row, component);
  return sum;
}

}  // namespace suture
