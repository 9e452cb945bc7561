// SPDX-License-Identifier: GPL-3.0-or-later
//
// Functors on vertices: a model of the C++ layer, and what it gives in closed form.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <numeric>

#include "kernel/dynamics/dynamics.hpp"
#include "tests/forces/anchors_model.hpp"
#include "tests/forces/spring_model.hpp"

namespace vertex_functor_test {
namespace {

using namespace suture;
using Body = spring_model::Body;

/// Anchors on two regions that overlap in a layer of elements.
struct Anchored : Body {
  explicit Anchored(unsigned threads = 1, Index n = 6, bool skip = true)
      : Body(spring_model::box(n, 4, 3)) {
    std::vector<Index> left, right;
    for (Index e = 0; e < complex().element_count(); ++e) {
      const Index column = imported().user_element[e] % n;
      if (column < 4) left.push_back(e);
      if (column >= 3) right.push_back(e);
    }
    for (const auto& region : {left, right})
      instances.push_back(&attributes().add(
          std::make_unique<Instance>(anchors_model(), region == left ? "left" : "right",
                                     std::vector{region == left ? 3.0 : 50.0, 0.7}, diagnostics,
                                     skip),
          complex(), region));
    compile(threads);
  }

  static double k(const Instance& instance, Index vertex) {
    const CellSet& cells = instance.table(0).cells;
    if (cells.row(vertex) == none) return 0;
    const Column& weight = *instance.column(1);
    return instance.parameters()[0] *
           (weight.get(cells.row(vertex), 0) + weight.get(cells.row(vertex), 1));
  }
  double k(Index vertex) const { return k(*instances[0], vertex) + k(*instances[1], vertex); }
  double c(Index vertex) {
    double sum = 0;
    for (const Instance* i : instances)
      if (i->table(0).cells.row(vertex) != none) sum += 0.7 * attributes().mass().get(vertex, 0);
    return sum;
  }
  double away(Index v, int axis) {
    return attributes().position().get(v, axis) - attributes().rest().get(v, axis);
  }
  std::vector<Vec3> reference() {
    std::vector<Vec3> forces(attributes().vertex_count());
    for (Index v = 0; v < forces.size(); ++v)
      for (int a = 0; a < 3; ++a)
        if (complex().exists(0, v))
          forces[v][static_cast<std::size_t>(a)] =
              -k(v) * away(v, a) - c(v) * attributes().velocity().get(v, a);
    return forces;
  }

  std::vector<Instance*> instances;
};

TEST(VertexFunctor, ForcesAreThoseOfEachVertexThroughCutsAndRemovals) {
  for (const bool skip : {true, false}) {
    Anchored body(1, 6, skip);
    for (unsigned seed = 1; seed <= 8; ++seed) {
      body.shake(0.02, seed);
      const auto expected = body.reference();
      EXPECT_LT(
          spring_model::largest_difference(spring_model::forces_of(body, body.models()), expected),
          1e-14)
          << seed;
      body.cut_random(9, seed);
      if (seed % 3 == 0) body.pierce({5 * seed, 5 * seed + 1});
    }
  }
}

// Forces are written for all that is declared; what enabled() clears is zero.
TEST(VertexFunctor, WhatIsNotReadIsZero) {
  Body body(spring_model::box(3, 3, 3));
  body.attributes().add(std::make_unique<Instance>(anchors_model(), "undamped",
                                                   std::vector{3.0, 0.0}, body.diagnostics),
                        body.complex(), {});
  body.compile(1);
  EXPECT_EQ(body.models().summary()[0].reads, unsigned(SUTURE_READ_REST | SUTURE_READ_POSITION));
  body.shake(0.02, 3);
  const auto forces = spring_model::forces_of(body, body.models());
  const Column &x = body.attributes().position(), &X = body.attributes().rest();
  const Column& weight = *body.attributes().instances()[0]->column(1);
  for (Index v = 0; v < x.size(); ++v)
    EXPECT_NEAR(forces[std::size_t{4} * v],
                -3.0 * (weight.get(v, 0) + weight.get(v, 1)) * (x.get(v, 0) - X.get(v, 0)), 1e-13);
  body.models().add_bounds(0, [&](Index, const double* K, const double* C) {
    EXPECT_GT(K[0], 0);
    EXPECT_EQ(C[0], 0);
  });
}

TEST(VertexFunctor, SameBitsForAnyNumberOfThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<double> one;
  for (const unsigned threads : {1u, 3u, 8u}) {
    Anchored body(threads, 40, false);
    EXPECT_EQ(body.models().threads(), threads);
    body.shake(0.02, 3);
    body.cut_random(60, 5);
    const auto forces = spring_model::forces_of(body, body.models());
    if (threads == 1) one = forces;
    EXPECT_EQ(std::memcmp(one.data(), forces.data(), one.size() * sizeof(double)), 0) << threads;
  }
}

TEST(VertexFunctor, EnergyTangentAndBoundsAreExact) {
  Anchored body;
  body.cut_random(20, 1);
  body.shake(0.02, 7);
  const Index count = body.attributes().vertex_count();
  double energy = 0;
  std::vector<double> d(std::size_t{3} * count), df(d.size());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(static_cast<double>(i));
  body.models().add_tangent(d.data(), 2.0, 0.3, 0, df.data());
  std::vector<double> stiffness(count), damping(count);
  body.models().add_bounds(0, [&](Index v, const double* K, const double* C) {
    stiffness[v] += K[0];
    damping[v] += C[2];
    EXPECT_EQ(K[3], 0);
  });
  for (Index v = 0; v < count; ++v) {
    for (int a = 0; a < 3; ++a) {
      const std::size_t i = std::size_t{3} * v + static_cast<std::size_t>(a);
      energy += body.k(v) / 2 * body.away(v, a) * body.away(v, a);
      EXPECT_NEAR(df[i], -(2.0 * body.k(v) + 0.3 * body.c(v)) * d[i], 1e-12 * body.k(v));
    }
    EXPECT_GE(stiffness[v], body.k(v) * (1 - 1e-12));
    EXPECT_LE(stiffness[v], body.k(v) * 1.03);
    EXPECT_GE(damping[v], body.c(v) * (1 - 1e-12));
    EXPECT_LE(damping[v], body.c(v) * 1.03);
  }
  EXPECT_NEAR(body.models().energy(0), energy, 1e-13 * energy);
  EXPECT_TRUE(body.models().dissipates());
}

// Around some vertices: what add_forces_at() and energy_around() see.
TEST(VertexFunctor, LocalSumsAreThoseOfTheWhole) {
  Anchored body;
  body.shake(0.02, 2);
  const std::vector<Index> vertices{0, 3, 17};
  VertexSelection selection;
  selection.select(vertices, body.attributes().vertex_count());
  std::vector<Vec3> forces(vertices.size());
  body.models().add_forces_at(selection, vertices, 0, forces);
  const auto expected = body.reference();
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(forces[selection.slot(vertices[i])][a], expected[vertices[i]][a], 1e-13);
  std::vector<Index> all(body.complex().element_count());
  std::iota(all.begin(), all.end(), Index{0});
  const double energy = body.models().energy(0);
  EXPECT_NEAR(body.models().energy_around(all, 0), energy, 1e-13 * energy);
}

// Free vertices are oscillators of their own: m x'' = -k (x - X) - c v. Symplectic Euler in
// the form of the kernel, step by step; and what the state has counted.
TEST(VertexFunctor, EveryVertexIsAnOscillatorWithAMemory) {
  Anchored body;
  body.shake(0.02, 4);
  const Index count = body.attributes().vertex_count();
  std::vector<double> x, v, sum(count);
  for (Index i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a) {
      x.push_back(body.away(i, a));
      v.push_back(body.attributes().velocity().get(i, a));
    }
  Dynamics dynamics(body, {"symplectic-euler", 0});
  dynamics.start();
  const double dt = 1e-3;
  for (int step = 1; step <= 200; ++step) {
    for (Index i = 0; i < count; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t at = std::size_t{3} * i + a;
        sum[i] += x[at] * x[at];
        v[at] -= dt / body.attributes().mass().get(i, 0) * (body.k(i) * x[at] + body.c(i) * v[at]);
        x[at] += dt * v[at];
      }
    dynamics.step(dt, step * dt);
  }
  const Instance& left = *body.instances[0];
  for (Index i = 0; i < count; ++i) {
    for (int a = 0; a < 3; ++a)
      EXPECT_NEAR(body.away(i, a), x[std::size_t{3} * i + static_cast<std::size_t>(a)], 1e-13);
    const Index row = left.table(0).cells.row(i);
    if (row == none) continue;
    EXPECT_NEAR(left.column(2)->get(row, 0), sum[i], 1e-12);
    EXPECT_EQ(left.column(2)->get(row, 1), 200);
  }
}

TEST(VertexFunctor, SleepersKeepTheirMemoryAndGiveNoForce) {
  Anchored body;
  body.shake(0.02, 4);
  std::vector<Index> all(body.complex().element_count());
  std::iota(all.begin(), all.end(), Index{0});
  body.models().sleep(all);
  EXPECT_EQ(std::ranges::count(spring_model::forces_of(body, body.models()), 0.0),
            static_cast<std::ptrdiff_t>(body.attributes().vertex_count()) * 4);
  body.models().accept();
  const Instance& left = *body.instances[0];
  for (Index row = 0; row < left.table(0).cells.size(); ++row)
    EXPECT_EQ(left.column(2)->get(row, 1), 0);
  body.models().wake_all();
  spring_model::forces_of(body, body.models());
  body.models().accept();
  for (Index row = 0; row < left.table(0).cells.size(); ++row)
    EXPECT_EQ(left.column(2)->get(row, 1), 1);
}

}  // namespace
}  // namespace vertex_functor_test
