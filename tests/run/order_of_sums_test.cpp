// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an element gives does not depend on which others are in its batch: elements apart from a
// body that share batches with it may be removed, and no bit of its forces and of products with its
// tangent changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/dynamics/body.hpp"
#include "kernel/mesh/box.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

constexpr double width = 0.025;  // m; rounds, so that cubes differ in their last bits

/// Boxes, then skewed parallelepipeds, with two elements that are neither. In front of them are
/// some that touch nothing, boxes and skewed ones in turn.
Mesh mixed_block(Index apart) {
  Mesh mesh;
  const auto append = [&](Mesh part) {
    const auto first = static_cast<Index>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), part.points.begin(), part.points.end());
    for (Hexahedron& nodes : part.hexahedra) {
      for (Index& node : nodes) node += first;
      mesh.hexahedra.push_back(nodes);
    }
  };
  for (Index i = 0; i < apart; ++i) {
    Mesh cube = make_box({.origin = {2 * width * i, 1, 0}, .size = {width, width, width}});
    for (Vec3& x : cube.points) x[2] += i % 2 == 1 ? 0.2 * x[1] : 0;
    append(cube);
  }
  Mesh block = make_box({.size = {4 * width, 3 * width, 3 * width}, .cells = {4, 3, 3}});
  for (Vec3& x : block.points) x[1] += 0.3 * std::max(0.0, x[0] - 2 * width);
  for (Vec3& x : block.points)
    if (x[0] < width / 2 && x[1] < width / 2 && x[2] > width / 2 && x[2] < 3 * width / 2)
      x[0] -= 0.004;
  append(block);
  return mesh;
}

struct Sample {
  const char* model;
  std::map<std::string, double> values;
};

struct Products {
  std::vector<double> forces, tangent;
};

/// Those of the block in a deformed state.
Products products_of(const Sample& the, Index apart, bool removes) {
  Diagnostics diagnostics;
  Body body(import_mesh(mixed_block(apart), {.renumber = false}, diagnostics));
  const suture_model& model = tree_plugins().model(the.model);
  std::map<std::string, double> values{{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}};
  values.insert(the.values.begin(), the.values.end());
  body.attributes().add(
      std::make_unique<Instance>(model, "block", parameters(model, values), diagnostics),
      body.complex(), {});
  body.compile(diagnostics, 1);
  Attributes& attributes = body.attributes();
  std::vector<double> direction;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (int c = 0; c < 3; ++c) {
      const double x = attributes.rest().get(v, 0), y = attributes.rest().get(v, 1),
                   z = attributes.rest().get(v, 2);
      attributes.position().set(
          v, c, attributes.rest().get(v, c) + 0.003 * std::sin(97 * x + 61 * y + 43 * z + c));
      attributes.velocity().set(v, c, 0.1 * std::cos(71 * x + 53 * y + 89 * z + c));
      direction.push_back(std::sin(31 * x + 47 * y + 59 * z + c));
    }
  std::vector<Index> gone(removes ? apart : 0);
  std::iota(gone.begin(), gone.end(), 0);
  if (removes) body.pierce(gone);
  body.models().add_forces(0, 1e-5);
  std::vector<double> tangent(direction.size());
  body.models().add_tangent(direction.data(), 1, 0, TangentTime(0, 1e-5), tangent.data());
  const double* rows = attributes.force().rows();
  const std::size_t first = std::size_t{apart} * 8;
  return {{rows + 4 * first, rows + std::size_t{attributes.vertex_count()} * 4},
          {tangent.begin() + static_cast<std::ptrdiff_t>(3 * first), tangent.end()}};
}

class OrderOfSums : public testing::TestWithParam<Sample> {};

TEST_P(OrderOfSums, DoesNotDependOnWhichCellsShareABatch) {
  for (Index apart = 1; apart < 12; ++apart) {
    const Products with = products_of(GetParam(), apart, false),
                   without = products_of(GetParam(), apart, true);
    ASSERT_GT(std::ranges::max(with.forces), 0);
    EXPECT_EQ(with.forces, without.forces) << apart;
    EXPECT_EQ(with.tangent, without.tangent) << apart;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, OrderOfSums,
                         testing::Values(Sample{"tm-faure", {}},
                                         Sample{"tm-faure", {{"element", 1}}},
                                         Sample{"mss-baudet", {{"viscosity", 1}}}));

}  // namespace
}  // namespace suture::test
