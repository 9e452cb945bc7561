// SPDX-License-Identifier: GPL-3.0-or-later
//
// Evaluations around a few cells, against those of the whole body.
#include "kernel/forces/local_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/forces/force_loop.hpp"
#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using spring_model::Body;

BoxOptions box(Index x, Index y, Index z) {
  BoxOptions options;
  options.cells = {x, y, z};
  options.size = {0.1 * x, 0.1 * y, 0.1 * z};
  return options;
}

/// Springs on edges only: the diagonals offer neither energy nor bounds.
std::vector<double> edges_only() {
  auto parameters = spring_model::defaults();
  parameters[spring_model::diagonal_stiffness] = 0;
  parameters[spring_model::edge_damping] = 2;
  return parameters;
}

/// Two regions that overlap, cuts and holes, in a deformed state.
struct Worn {
  Worn() : body(box(6, 5, 4), true) {
    std::vector<Index> region;
    for (Index e = 0; e < 120; e += 2) region.push_back(e);
    body.add(edges_only());
    body.add(edges_only(), region);
    body.initialise();
    loop = std::make_unique<ForceLoop>(*body.attributes, body.mesh.complex, 1);
    body.shake(0.02, 4);
    loop->update(body.mesh.complex, body.cut_random(30, 5));
    pierce({7, 8, 30, 77});
  }
  CellComplex& complex() { return body.mesh.complex; }
  void pierce(std::vector<Index> elements) {
    const TopologyChange change = complex().pierce(elements);
    body.attributes->apply(complex(), change);
    loop->update(complex(), change);
  }
  Body body;
  std::unique_ptr<ForceLoop> loop;
};

TEST(LocalRows, TheEnergyOfAllElementsIsTheEnergy) {
  Worn worn;
  std::vector<Index> all(worn.complex().element_count());
  for (Index e = 0; e < all.size(); ++e) all[e] = e;
  const double energy = worn.loop->energy(0);
  ASSERT_GT(energy, 1e-3);
  EXPECT_NEAR(worn.loop->energy_around(all, 0), energy, 1e-13 * energy);
  EXPECT_EQ(worn.loop->energy_around({}, 0), 0);
}

TEST(LocalRows, AnOperationChangesTheEnergyByTheDifferenceAroundIt) {
  Worn worn;
  for (const Index e : {Index{1}, Index{50}, Index{90}}) {
    const auto& corners = worn.complex().vertices_of(e);
    const auto around = worn.loop->elements_around(corners);
    const double energy = worn.loop->energy(0), part = worn.loop->energy_around(around, 0);
    ASSERT_LT(part, energy);
    worn.pierce({e});
    const double lost = energy - worn.loop->energy(0);
    ASSERT_GT(lost, 1e-6);
    EXPECT_NEAR(part - worn.loop->energy_around(around, 0), lost, 1e-13 * energy);
  }
}

TEST(LocalRows, BoundsAroundVerticesAreTheirsAmongAll) {
  Worn worn;
  const Index vertices = worn.body.attributes->vertex_count();
  worn.body.attributes->fixed().set(0, 0, 7);
  worn.body.attributes->fixed().set(1, 0, 2);
  std::vector<ForceLoop::Bounds> single;
  ForceLoop::Bounds largest;
  for (Index v = 0; v < vertices; ++v) {
    single.push_back(worn.loop->bounds_around({&v, 1}, 0));
    if (single[v].dt < largest.dt) largest = single[v];
  }
  const ForceLoop::Bounds all = worn.loop->bounds(0);
  EXPECT_NEAR(largest.dt, all.dt, 1e-13 * all.dt);
  EXPECT_TRUE(std::isinf(single[0].dt)) << "held";
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<Index> some;
    double dt = std::numeric_limits<double>::infinity();
    for (Index v = 0; v < vertices; ++v)
      if (random() % 16 == 0) some.push_back(v);
    for (const Index v : some) dt = std::min(dt, single[v].dt);
    const auto bounds = worn.loop->bounds_around(some, 0);
    EXPECT_NEAR(bounds.dt, dt, 1e-13 * dt);
    EXPECT_NEAR(single[bounds.vertex].dt, dt, 1e-13 * dt);
  }
}

}  // namespace
