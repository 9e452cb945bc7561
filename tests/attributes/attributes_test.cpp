// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/attributes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "kernel/attributes/shape.hpp"
#include "kernel/base/error.hpp"
#include "tests/attributes/bodies.hpp"

namespace suture {
namespace {

TEST(Attributes, MassOfABoxIsDensityTimesVolumeSharedByEighths) {
  FakeBody body({3, 4, 5});
  const fake::Model model(
      {fake::attribute("mass", 0, 1, &fake::box_mass, SUTURE_FROM_VOLUMES, SUTURE_SHARED_MASS)});
  Attributes attributes(body.complex, body.rest);
  add(attributes, body.complex, model.table, {}, 1000);
  initialise(attributes, body.complex);
  EXPECT_NEAR(total(attributes.mass()), 1000 * 60, 1e-9);
  for (Index v = 0; v < attributes.vertex_count(); ++v) {
    double eighths = 1000;
    for (std::size_t c = 0; c < 3; ++c)
      eighths *= body.rest[v][c] == 0 || body.rest[v][c] == 3 + double(c) ? 0.5 : 1;
    EXPECT_NEAR(attributes.mass().get(v, 0), eighths, 1e-9);
  }
  EXPECT_FALSE(body.complex.has_edges());  // nobody asked for them
  EXPECT_FALSE(body.complex.has_faces());
}

TEST(Attributes, SumsAfterRandomCutsHaveTheBitsOfAFreshStart) {
  const fake::Model model(fake::everything());
  for (int round = 0; round < 20; ++round) {
    Random random;
    // Elements of any shape, or identical except for rounding: then one stands for all.
    const double distortion = round % 2 == 0 ? 0.2 : 4e-15;
    FakeBody body({2 + static_cast<Index>(random() % 5), 3, 4}, &random, distortion);
    const Index count = body.complex.element_count();
    // None, one or several regions, overlapping or not, in any order.
    std::vector<std::vector<Index>> regions(1 + random() % 3);
    for (auto& region : regions)
      for (Index e = 0; e < count && regions.size() > 1; ++e)
        if (random() % 3 != 0) region.push_back(e);
    Attributes attributes(body.complex, body.rest);
    for (const auto& region : regions)
      add(attributes, body.complex, model.table, region, random.number() + 2);
    initialise(attributes, body.complex);
    for (int cut = 0; cut < 5; ++cut) {
      const auto faces = random_faces(body.complex, random, 0.25);
      attributes.apply(body.complex, body.complex.cut(faces));
      Attributes fresh(body.complex, rest_of(attributes));
      for (std::size_t i = 0; i < regions.size(); ++i)
        add(fresh, body.complex, model.table, regions[i],
            attributes.instances()[i]->parameters()[0]);
      initialise(fresh, body.complex);
      ASSERT_NO_FATAL_FAILURE(expect_same_sums(attributes, fresh));
    }
  }
}

TEST(Attributes, CutsConserveMassMomentumLoadsAndTheCornersOfElements) {
  const fake::Model model(fake::everything());
  for (const bool halved : {false, true}) {
    Random random;
    FakeBody body({5, 4, 3}, &random);
    std::vector<Index> half(halved ? body.complex.element_count() / 2 : 0);
    std::iota(half.begin(), half.end(), Index{0});
    Attributes attributes(body.complex, body.rest);
    Instance& instance = add(attributes, body.complex, model.table, half);
    ColumnSpec spec;
    spec.name = "load";
    spec.components = 3;
    spec.policy = SUTURE_SHARE;
    Column& load = attributes.kernel(0).add(spec);
    Column& own_load = *instance.column(fake::load);
    initialise(attributes, body.complex);
    for (Column* column : {&load, &own_load, &attributes.velocity(), &attributes.position()})
      for (Index row = 0; row < column->size(); ++row)
        for (int c = 0; c < 3; ++c) column->set(row, c, random.number() + 2);

    const auto momentum = [&](int c) {
      double sum = 0;
      for (Index v = 0; v < attributes.vertex_count(); ++v)
        sum += attributes.mass().get(v, 0) * attributes.velocity().get(v, c);
      return sum;
    };
    std::vector<double> before, corners, corners_after;
    const auto measure = [&](std::vector<double>& out, std::vector<double>& at) {
      out = {total(attributes.mass()), total(*instance.column(fake::edge)),
             total(*instance.column(fake::edge), 1), total(*instance.column(fake::face)),
             total(*instance.column(fake::vertex), 2)};
      for (int c = 0; c < 3; ++c)
        for (const double x : {momentum(c), total(load, c), total(own_load, c)}) out.push_back(x);
      at.clear();
      for (const Hexahedron& h : body.complex.vertices())
        for (const Index v : h)
          for (int c = 0; c < 3; ++c) {
            at.push_back(attributes.position().get(v, c));
            at.push_back(attributes.rest().get(v, c));
            at.push_back(attributes.velocity().get(v, c));
          }
    };
    measure(before, corners);
    for (int cut = 0; cut < 6; ++cut) {
      const double fraction = cut == 5 ? 1 : 0.2;  // at last into single elements
      attributes.apply(body.complex,
                       body.complex.cut(random_faces(body.complex, random, fraction)));
      std::vector<double> after;
      measure(after, corners_after);
      for (std::size_t i = 0; i < before.size(); ++i)
        EXPECT_NEAR(after[i], before[i], 1e-13 * std::abs(before[i])) << "quantity " << i;
      EXPECT_EQ(corners_after, corners);
    }
    EXPECT_EQ(attributes.vertex_count(), 8 * body.complex.element_count());
  }
}

TEST(Attributes, SharesAreInProportionToTheIncidentVolumes) {
  // 1 | 3: two boxes of volumes 1 and 3 side by side, cut apart.
  FakeBody body({2, 1, 1});
  for (Vec3& p : body.rest)
    if (p[0] == 2) p[0] = 4;
  Attributes attributes(body.complex, body.rest);
  ColumnSpec spec;
  spec.name = "load";
  spec.policy = SUTURE_SHARE;
  Column& load = attributes.kernel(0).add(spec);
  initialise(attributes, body.complex);
  for (Index v = 0; v < load.size(); ++v) load.set(v, 0, 8);
  std::vector<Dart> faces{24 * 0 + 4 * 2};  // x = 1 of element 0
  attributes.apply(body.complex, body.complex.cut(faces));
  for (Index e = 0; e < 2; ++e)
    for (std::size_t i = 0; i < 8; ++i) {
      const bool cut = (i & 1) != e;
      EXPECT_DOUBLE_EQ(load.get(body.complex.vertices_of(e)[i], 0), cut ? (e == 0 ? 2 : 6) : 8);
    }
}

TEST(Attributes, TwoInstancesOfABlockAddUpToOne) {
  const fake::Model model(fake::everything());
  Random random;
  FakeBody body({4, 4, 4}, &random);
  std::vector<Index> halves[2];
  for (Index e = 0; e < 64; ++e) halves[random() % 2].push_back(e);
  Attributes one(body.complex, body.rest), two(body.complex, body.rest);
  add(one, body.complex, model.table);
  for (const auto& half : halves) add(two, body.complex, model.table, half);
  initialise(one, body.complex);
  initialise(two, body.complex);
  for (int cut = 0; cut < 4; ++cut) {
    for (const auto attribute : {fake::edge, fake::face, fake::volume, fake::vertex}) {
      const auto dimension = static_cast<int>(model.attributes[attribute].dimension);
      for (Index cell = 0; cell < body.complex.count(dimension); ++cell) {
        double sum = 0;
        for (const auto& instance : two.instances()) {
          const Index row = instance->table(dimension).cells.row(cell);
          if (row != none) sum += instance->column(attribute)->get(row, 0);
        }
        const double whole = one.instances()[0]->column(attribute)->get(cell, 0);
        ASSERT_NEAR(sum, whole, 1e-14 * whole) << "attribute " << attribute << " cell " << cell;
      }
    }
    for (Index v = 0; v < one.vertex_count(); ++v)
      ASSERT_NEAR(one.mass().get(v, 0), two.mass().get(v, 0), 1e-14 * one.mass().get(v, 0));
    const TopologyChange change = body.complex.cut(random_faces(body.complex, random, 0.3));
    one.apply(body.complex, change);
    two.apply(body.complex, change);
  }
}

TEST(Attributes, RowsExistWhereElementsOfTheRegionAre) {
  const fake::Model model(fake::everything());
  for (int round = 0; round < 10; ++round) {
    Random random;
    FakeBody body({3, 3, 3});
    std::vector<Index> region;
    for (Index e = 0; e < 27; ++e)
      if (random() % 2 == 0 || e == 5) region.push_back(e);
    Attributes attributes(body.complex, body.rest);
    Instance& instance = add(attributes, body.complex, model.table, region);
    initialise(attributes, body.complex);
    for (int cut = 0; cut < 4; ++cut) {
      attributes.apply(body.complex, body.complex.cut(random_faces(body.complex, random, 0.3)));
      for (int d = 0; d < 3; ++d)
        for (Index cell = 0; cell < body.complex.count(d); ++cell) {
          std::vector<Dart> star;
          body.complex.star(d, cell, star);
          const bool inside = std::ranges::any_of(
              star, [&](Dart dart) { return instance.table(3).cells.contains(dart / 24); });
          ASSERT_EQ(instance.table(d).cells.contains(cell), inside) << d << " " << cell;
        }
      // COPY, ZERO and the trial copy follow: `plain` is everywhere what it was.
      for (Index row = 0; row < instance.table(1).cells.size(); ++row)
        ASSERT_EQ(instance.column(fake::plain)->get(row, 0), 5);
      ASSERT_TRUE(instance.column(fake::plain)->is_constant());
    }
  }
}

TEST(Attributes, ZeroLeavesTheValueWithThePartThatKeepsTheNumber) {
  const fake::Model model(fake::everything());
  FakeBody body({2, 1, 1});
  Attributes attributes(body.complex, body.rest);
  Column& memory = *add(attributes, body.complex, model.table).column(fake::memory);
  initialise(attributes, body.complex);
  const Index old_count = memory.size();
  const TopologyChange change = body.complex.cut(std::vector<Dart>{8});
  attributes.apply(body.complex, change);
  ASSERT_EQ(memory.size(), old_count + 1);
  EXPECT_EQ(memory.get(change.splits[2][0].old_cell, 1), 7);
  EXPECT_EQ(memory.get(change.splits[2][0].new_cell, 1), 0);
}

TEST(Attributes, ACallbackReplacesThePolicyOfAKernelColumn) {
  FakeBody body({2, 1, 1});
  Attributes attributes(body.complex, body.rest);
  ColumnSpec spec;
  spec.name = "generation";
  spec.on_split = [](Column& column, Index old_row, Index new_row) {
    column.set(new_row, 0, column.get(old_row, 0) + 1);
  };
  Column& generation = attributes.kernel(0).add(spec);
  initialise(attributes, body.complex);
  const TopologyChange change = body.complex.cut(std::vector<Dart>{8});
  attributes.apply(body.complex, change);
  for (const Split& split : change.splits[0]) {
    EXPECT_EQ(generation.get(split.old_cell, 0), 0);
    EXPECT_EQ(generation.get(split.new_cell, 0), 1);
  }
  EXPECT_EQ(change.splits[0].size(), 4u);
}

TEST(Attributes, ColumnsOfCongruentElementsAreStoredOnce) {
  const fake::Model box_model({fake::attribute(
      "own mass", 3, 1, [](const suture_context* context, const suture_batch* batch, double* out) {
        std::array<double, 64> eighths;
        const suture_status status = fake::box_mass(context, batch, eighths.data());
        for (std::size_t lane = 0; lane < 8; ++lane) out[lane] = 8 * eighths[lane];
        return status;
      })});
  FakeBody body({7, 3, 3});
  for (Vec3& p : body.rest)
    for (double& x : p) x *= 0.1;  // edges that differ in their last bits
  Attributes attributes(body.complex, body.rest);
  Column& column = *add(attributes, body.complex, box_model.table).column(0);
  initialise(attributes, body.complex);
  EXPECT_TRUE(column.is_constant());
  EXPECT_NEAR(column.get(62, 0), 1e-3, 1e-16);
}

TEST(Attributes, RestPositionsMustBeOnePerVertex) {
  FakeBody body({1, 1, 1});
  body.rest.pop_back();
  EXPECT_THROW(Attributes(body.complex, body.rest), InputError);
}

TEST(Shape, ParallelepipedsAndVolumes) {
  Random random;
  for (int round = 0; round < 100; ++round) {
    Vec3 origin{random.number(), random.number(), random.number()}, edges[3];
    for (Vec3& e : edges) e = {random.number(), random.number(), random.number()};
    HexahedronNodes x;
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t c = 0; c < 3; ++c) {
        x[n][c] = origin[c];
        for (std::size_t a = 0; a < 3; ++a)
          x[n][c] += static_cast<double>(n >> a & 1) * edges[a][c];
      }
    EXPECT_TRUE(is_parallelepiped(x));
    const double determinant =
        edges[0][0] * (edges[1][1] * edges[2][2] - edges[1][2] * edges[2][1]) +
        edges[0][1] * (edges[1][2] * edges[2][0] - edges[1][0] * edges[2][2]) +
        edges[0][2] * (edges[1][0] * edges[2][1] - edges[1][1] * edges[2][0]);
    EXPECT_NEAR(hexahedron_volume(x), determinant, 1e-14);
    x[random() % 8][random() % 3] += 1e-10;
    EXPECT_FALSE(is_parallelepiped(x));
  }
}

/// det J of the trilinear map is of degree 2 in each coordinate, so 2x2x2 Gauss
/// points integrate it exactly: an independent volume.
TEST(Shape, VolumeOfAGeneralHexahedronIsTheIntegralOfItsJacobian) {
  Random random;
  HexahedronNodes x;
  for (std::size_t n = 0; n < 8; ++n)
    for (std::size_t c = 0; c < 3; ++c)
      x[n][c] = static_cast<double>(n >> c & 1) + 0.3 * random.number();
  double volume = 0;
  for (int point = 0; point < 8; ++point) {
    double j[3][3] = {};
    for (int n = 0; n < 8; ++n)
      for (int a = 0; a < 3; ++a) {
        double slope = (n >> a & 1) ? 1 : -1;
        for (int b = 0; b < 3; ++b) {
          const double xi = 0.5 + ((point >> b & 1) ? 0.5 : -0.5) / std::sqrt(3.0);
          if (b != a) slope *= (n >> b & 1) ? xi : 1 - xi;
        }
        for (std::size_t c = 0; c < 3; ++c) j[a][c] += slope * x[static_cast<std::size_t>(n)][c];
      }
    volume += (j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) +
               j[0][1] * (j[1][2] * j[2][0] - j[1][0] * j[2][2]) +
               j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0])) /
              8;
  }
  EXPECT_NEAR(hexahedron_volume(x), volume, 1e-14);
}

}  // namespace
}  // namespace suture
