// SPDX-License-Identifier: GPL-3.0-or-later
//
// Forces, loads, constraints and integrators after elements were removed and faces sewn.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include "kernel/attributes/cell_nodes.hpp"
#include "kernel/dynamics/inversion.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/forces/compiled_functor.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/base/variable.hpp"
#include "tests/dynamics/rig.hpp"

namespace {

using namespace suture;
using namespace rig;
using namespace spring_model;
using spring_model::Body;

constexpr Springs with_diagonals{100, 0, 50};

TopologyChange pierce_random(suture::Body& body, unsigned count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Index> elements;
  while (elements.size() < count) {
    const Index e = random() % body.complex().element_count();
    if (body.complex().can_pierce(e)) elements.push_back(e);
  }
  return body.pierce(elements);
}

/// Faces between the left and the right half, as seams to be.
std::vector<Seam> middle(suture::Body& body) {
  std::vector<Seam> seams;
  const CellComplex& complex = body.complex();
  double length = 0;
  for (Index v = 0; v < complex.count(0); ++v)
    length = std::max(length, body.attributes().rest().get(v, 0));
  const auto is_left = [&](Index e) {
    double x = 0;
    for (const Index v : complex.vertices_of(e)) x += body.attributes().rest().get(v, 0) / 8;
    return x < length / 2;
  };
  std::vector<bool> left;
  for (Index e = 0; e < complex.element_count(); ++e) left.push_back(is_left(e));
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4) {
    const Dart other = complex.beta3(d);
    if (other != none && left[d / 24] && !left[other / 24]) seams.push_back({d, other});
  }
  return seams;
}

TopologyChange cut_open(suture::Body& body, const std::vector<Seam>& seams) {
  std::vector<Dart> faces;
  for (const Seam& s : seams) faces.push_back(s.one);
  return body.cut(faces);
}

/// Positions of vertices that are there, moved at random; others stay.
void shake(suture::Body& body, double amount, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-amount, amount);
  for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
    if (!body.complex().exists(0, v)) continue;
    for (int c = 0; c < 3; ++c) {
      body.attributes().position().set(v, c,
                                       body.attributes().position().get(v, c) + shift(random));
      body.attributes().velocity().set(v, c, shift(random));
    }
  }
}

class RemovalOnIsa : public testing::TestWithParam<const char*> {
 protected:
  const suture::test::Variable isa_{"SUTURE_ISA", GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Sets, RemovalOnIsa, testing::Values("base", "avx2", "avx512"));

TEST_P(RemovalOnIsa, ForcesAndEnergyAreThoseOfTheElementsThatAreThere) {
  for (const bool halved : {false, true}) {
    Body body(box(6, 5, 4), true);
    auto parameters = defaults();
    parameters[edge_damping] = 3;
    std::vector<Index> region;
    // Diagonals report no energy; without them the sum is known.
    if (halved) parameters[diagonal_stiffness] = 0;
    for (Index e = 0; e < 120 && halved; ++e)
      if (e % 3 != 1) region.push_back(e);
    Instance& instance = body.add(parameters, region);
    body.compile(1);
    ForceLoop& loop = body.models();
    const auto seams = middle(body);
    cut_open(body, seams);
    shake(body, 0.01, 1);
    for (unsigned seed = 1; seed <= 10; ++seed) {
      if (seed == 5) {
        std::vector<Seam> left = seams;
        std::erase_if(left, [&](const Seam& s) { return !body.complex().can_sew(s.one, s.other); });
        ASSERT_GT(left.size(), 5u);
        body.sew(left);
      } else if (seed % 2 == 0) {
        body.cut_random(12, seed);
      } else {
        pierce_random(body, 8, seed);
      }
      EXPECT_LT(largest_difference(forces_of(body, loop), reference_forces(body, instance)), 1e-13)
          << "seed " << seed;
      const double energy = reference_energy(body, instance);
      if (halved) {
        EXPECT_NEAR(loop.energy(0), energy, 1e-13 * energy);
      }
    }
  }
}

TEST(Removal, ForcesAreThoseOfAFreshStartOnWhatIsLeft) {
  Body body(box(8, 6, 5), true);
  Instance& instance = body.add(defaults());
  body.compile(1);
  ForceLoop& loop = body.models();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    body.cut_random(20, seed);
    pierce_random(body, 20, seed);
    shake(body, 0.01, seed);
    // Another Attributes and loop on the same complex: without dead rows, in other blocks.
    std::vector<Vec3> rest;
    for (Index v = 0; v < body.attributes().vertex_count(); ++v)
      rest.push_back({body.attributes().rest().get(v, 0), body.attributes().rest().get(v, 1),
                      body.attributes().rest().get(v, 2)});
    Attributes fresh(body.complex(), rest);
    fresh.user_element = body.imported().user_element.list();
    fresh.add(std::make_unique<Instance>(model(), "springs", defaults(), body.diagnostics),
              body.complex(), {});
    fresh.initialise(body.complex(), body.diagnostics);
    ASSERT_LT(fresh.instances()[0]->table(3).cells.size(), instance.table(3).cells.size());
    ForceLoop other(fresh, body.complex(), 1);
    for (Index v = 0; v < rest.size(); ++v)
      for (int c = 0; c < 3; ++c) {
        fresh.position().set(v, c, body.attributes().position().get(v, c));
        fresh.velocity().set(v, c, body.attributes().velocity().get(v, c));
      }
    other.add_forces(0, 0);
    std::vector<Vec3> expected(rest.size());
    for (Index v = 0; v < rest.size(); ++v)
      for (std::size_t c = 0; c < 3; ++c) expected[v][c] = fresh.force().get(v, int(c));
    EXPECT_LT(largest_difference(forces_of(body, loop), expected), 1e-14);
  }
}

TEST(Removal, ACutThatIsSewnAgainGivesTheSameBits) {
  Body body(box(10, 8, 8), true);
  body.add(defaults());
  body.compile(1);
  ForceLoop& loop = body.models();
  shake(body, 0.01, 1);
  const auto before = forces_of(body, loop);
  const auto seams = middle(body);
  cut_open(body, seams);
  const auto open = forces_of(body, loop);
  EXPECT_NE(std::memcmp(before.data(), open.data(), before.size() * sizeof(double)), 0);
  body.sew(seams);
  const auto after = forces_of(body, loop);
  EXPECT_EQ(std::memcmp(before.data(), after.data(), before.size() * sizeof(double)), 0);
  for (std::size_t i = before.size(); i < after.size(); ++i) ASSERT_EQ(after[i], 0);
}

TEST(Removal, SameBitsForAnyNumberOfThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<double> one;
  double energy = 0;
  for (const unsigned threads : test::thread_counts()) {
    Body body(box(24, 20, 20));
    body.add(defaults());
    body.compile();
    const auto seams = middle(body);
    cut_open(body, seams);  // so that chunks are coloured without what will be shared
    ForceLoop loop(body.attributes(), body.complex(), threads);
    body.add_follower(loop);
    shake(body, 0.01, 3);
    pierce_random(body, 300, 5);
    std::vector<Seam> left = seams;
    std::erase_if(left, [&](const Seam& s) { return !body.complex().can_sew(s.one, s.other); });
    body.sew(left);
    body.cut_random(100, 7);
    EXPECT_EQ(loop.threads(), threads);
    const auto forces = forces_of(body, loop);
    if (threads == 1) {
      one = forces;
      energy = loop.energy(0);
    }
    EXPECT_EQ(std::memcmp(one.data(), forces.data(), one.size() * sizeof(double)), 0) << threads;
    EXPECT_EQ(energy, loop.energy(0)) << threads;
  }
}

/// Vertices of a functor's cells that two chunks of one colour share.
int clashes(const Body& body, const CompiledFunctor& functor, int dimension) {
  const CellSet& cells = functor.cells();
  const BatchList& list = functor.list();
  int found = 0;
  for (Index colour = 0; colour < list.colour_count(); ++colour) {
    std::map<Index, Index> chunk_of;
    for (Index chunk = list.chunk_begin(colour); chunk < list.chunk_end(colour); ++chunk)
      for (const loops::Rows& range : list.ranges(chunk))
        for (Index row = range.begin; row < range.end; ++row) {
          if (!cells.is_live(row)) continue;
          std::array<Index, 8> x;
          cell_nodes(body.complex(), dimension, cells.cell(row), x.data());
          for (int n = 0; n < nodes_of_cell(dimension); ++n)
            found += chunk_of.emplace(x[static_cast<std::size_t>(n)], chunk).first->second != chunk;
        }
  }
  return found;
}

/// Pairs of chunks that share a vertex where the later does not wait for the earlier.
int unordered(const Body& body, const CompiledFunctor& functor, int dimension) {
  const CellSet& cells = functor.cells();
  const BatchList& list = functor.list();
  std::vector<std::set<Index>> waits(list.chunk_count());
  std::map<Index, Index> last;  // chunk at each vertex
  int found = 0;
  for (Index chunk = 0; chunk < list.chunk_count(); ++chunk) {
    for (const Index earlier : list.order().before[chunk]) {
      waits[chunk].insert(earlier);
      waits[chunk].insert(waits[earlier].begin(), waits[earlier].end());
    }
    for (const loops::Rows& range : list.ranges(chunk))
      for (Index row = range.begin; row < range.end; ++row) {
        if (!cells.is_live(row)) continue;
        std::array<Index, 8> x;
        cell_nodes(body.complex(), dimension, cells.cell(row), x.data());
        for (int n = 0; n < nodes_of_cell(dimension); ++n) {
          Index& before = last.try_emplace(x[static_cast<std::size_t>(n)], chunk).first->second;
          found += before != chunk && !waits[chunk].contains(before);
          before = chunk;
        }
      }
  }
  return found;
}

/// Chunks of one colour share no vertex, whatever was sewn: faces anywhere on the body.
TEST(Removal, ColoursAndOrderHoldAfterSewing) {
  Body body(box(14, 8, 8));
  Instance& instance = body.add(defaults());
  body.compile();
  CellComplex& complex = body.complex();
  const RestPlaces rest = body.attributes().rest_places(complex);
  RowNodes nodes(instance, instance.model().functors[0], rest);
  CompiledFunctor edges(instance, instance.model().functors[0], &nodes),
      boxes(instance, instance.model().functors[1], nullptr);
  edges.build(complex);
  boxes.build(complex);
  const auto all = [&] { return clashes(body, edges, 1) + clashes(body, boxes, 3); };
  const auto wrong = [&] { return unordered(body, edges, 1) + unordered(body, boxes, 3); };
  std::vector<Dart> boundary;
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
    if (complex.beta3(d) == none) boundary.push_back(d);
  std::mt19937 random(5);
  int before = 0, met = 0;
  for (int sewn = 0; sewn < 40;) {
    const Seam seam{boundary[random() % boundary.size()], boundary[random() % boundary.size()]};
    if (!complex.can_sew(seam.one, seam.other)) continue;
    const TopologyChange change = body.sew({seam});
    ++sewn;
    before += all() != 0;
    met += wrong() != 0;
    nodes.update(rest, change);
    edges.update(complex, change);
    boxes.update(complex, change);
    ASSERT_EQ(all(), 0);
    ASSERT_EQ(wrong(), 0);
  }
  EXPECT_GT(before, 3) << "otherwise this test sees nothing";
  EXPECT_GT(met, 3) << "otherwise this test sees nothing";
}

/// Two halves with a gap at rest, moved together, sewn: no force; deformed: the forces of
/// the body that never had a gap.
TEST(Removal, SeamsOfFacesThatDoNotMatchAtRestStressNothing) {
  for (const bool distorted : {false, true}) {
    Body body(box(6, 4, 4), distorted), whole(box(6, 4, 4), distorted);
    for (Body* b : {&body, &whole}) {
      b->add(defaults());
      b->compile(1);
    }
    Instance& instance = *body.attributes().instances()[0];
    const auto seams = middle(body);
    cut_open(body, seams);
    std::set<Index> right;
    std::vector<Index> queue;
    std::set<Index> seen;
    for (const Seam& s : seams) queue.push_back(s.other / 24);
    while (!queue.empty()) {
      const Index e = queue.back();
      queue.pop_back();
      if (!seen.insert(e).second) continue;
      for (const Index v : body.complex().vertices_of(e)) right.insert(v);
      for (int f = 0; f < 6; ++f)
        if (const Index n = body.complex().neighbour(e, f); n != none) queue.push_back(n);
    }
    for (const Index v : right)  // powers of two: differences keep their bits
      for (int c = 0; c < 3; ++c)
        body.attributes().rest().set(v, c,
                                     body.attributes().rest().get(v, c) + (c == 0 ? 0.5 : -0.25));
    ForceLoop &loop = body.models(), &other = whole.models();
    body.sew(seams);
    ASSERT_FALSE(body.attributes().rest_places(body.complex()).own().empty());
    for (const double f : forces_of(body, loop)) EXPECT_NEAR(f, 0, 1e-13);
    EXPECT_NEAR(loop.energy(0), 0, 1e-24);
    // Numbers are those of before the cut.
    shake(body, 0.01, 3);
    for (Index v = 0; v < whole.attributes().vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) {
        whole.attributes().position().set(v, c, body.attributes().position().get(v, c));
        whole.attributes().velocity().set(v, c, body.attributes().velocity().get(v, c));
      }
    std::vector<Vec3> expected(body.attributes().vertex_count());
    const auto rows = forces_of(whole, other);
    for (std::size_t i = 0; i < rows.size() / 4; ++i)
      expected[i] = {rows[4 * i], rows[4 * i + 1], rows[4 * i + 2]};
    EXPECT_LT(largest_difference(forces_of(body, loop), expected), 1e-13);
    EXPECT_LT(largest_difference(forces_of(body, loop), reference_forces(body, instance)), 1e-13);
    // And after more: edges that lose side 0, faces that open again.
    for (unsigned seed = 1; seed < 5; ++seed) {
      pierce_random(body, 6, seed);
      body.cut_random(6, seed);
      EXPECT_LT(largest_difference(forces_of(body, loop), reference_forces(body, instance)), 1e-13);
    }
  }
}

TEST(Removal, WhatIsGoneIsNotIntegrated) {
  for (const std::string scheme : schemes) {
    Moving m(box(5, 4, 4), {scheme, 0.5, {0, -10, 0}, {}}, with_diagonals);
    suture::Body& body = m.body;
    Dynamics& dynamics = m.dynamics;
    dynamics.start();
    double time = 0;
    const auto go = [&](int steps) {
      for (int i = 0; i < steps; ++i, time += 1e-4) dynamics.step(1e-4, time + 1e-4);
    };
    go(20);
    std::vector<Index> slab;  // a layer: its vertices go, and the body falls in two
    for (Index e = 0; e < body.complex().element_count(); ++e) {
      double x = 0;
      for (const Index v : body.complex().vertices_of(e))
        x += body.attributes().rest().get(v, 0) / 8;
      if (x < 0.2 || std::abs(x - 0.35) < 0.01) slab.push_back(e);
    }
    ASSERT_EQ(slab.size(), 48u);
    const TopologyChange change = body.pierce(slab);
    ASSERT_GT(change.removed[0].size(), 20u);
    const Index gone = change.removed[0][0];
    const double x = body.attributes().position().get(gone, 1);
    double kinetic = 0;
    go(100);
    dynamics.synchronise();
    const Energies energy = energies(dynamics);
    // With Euler the velocities lag half a step behind: (f + m g) / m for that time, damped.
    const double lag = scheme == euler ? 0.5e-4 : 0;
    const double decay = std::exp(-0.5 * lag), gain = -std::expm1(-0.5 * lag) / 0.5;
    double mass = 0;
    for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
      mass += body.attributes().mass().get(v, 0);
      for (int c = 0; c < 3; ++c) {
        const double v_c = body.attributes().velocity().get(v, c);
        ASSERT_TRUE(std::isfinite(v_c) && std::isfinite(body.attributes().position().get(v, c)));
        const double own = body.attributes().mass().get(v, 0);
        if (own == 0) continue;
        const double a = body.attributes().force().get(v, c) / own + (c == 1 ? -10 : 0);
        kinetic += 0.5 * own * std::pow(decay * v_c + gain * a, 2);
      }
    }
    EXPECT_NEAR(mass, 1000 * 0.032, 1e-12);
    EXPECT_NEAR(energy.kinetic, kinetic, 1e-13 * kinetic);
    EXPECT_TRUE(std::isfinite(energy.total()));
    EXPECT_EQ(body.attributes().position().get(gone, 1), x) << "a vertex that is gone stays";
    EXPECT_TRUE(find_inverted(body.complex(), body.attributes()).empty());
    EXPECT_TRUE(std::isfinite(RestSums().evaluate(dynamics.motion()).residual));
  }
}

TEST(Removal, LoadsOfWhatIsRemovedOrSewnEnd) {
  Moving m(box(4, 2, 2), {}, with_diagonals);
  suture::Body& body = m.body;
  const auto seams = middle(body);
  cut_open(body, seams);
  std::vector<Index> all(body.complex().count(0));
  for (Index v = 0; v < all.size(); ++v) all[v] = v;
  std::vector<Dart> opened;
  for (const Seam& s : seams) opened.push_back(s.one);
  m.loads.add_force(body.complex(), all, {0, 16, 0}, {});
  m.loads.add_traction(body.complex(), opened, {0, 0, 100}, {});
  m.pressures.add(body.complex(), opened, 100, {});
  const auto sum = [&] {
    std::vector<double> rows(4 * std::size_t{body.attributes().vertex_count()});
    m.loads.add_forces(0, {}, rows.data());
    m.pressures.add_forces(0, {}, rows.data());
    Vec3 total{};
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (i % 4 < 3) total[i % 4] += rows[i];
    return total;
  };
  const Vec3 before = sum();
  EXPECT_NEAR(before[1], 16, 1e-13);
  EXPECT_NEAR(before[2], 100 * 0.04, 1e-13);
  EXPECT_NEAR(std::abs(before[0]), 100 * 0.04, 1e-13);
  body.sew({seams[0]});
  const Vec3 sewn = sum();
  EXPECT_NEAR(sewn[1], 16, 1e-13) << "a force on vertices stays";
  EXPECT_NEAR(sewn[2], 100 * 0.03, 1e-13) << "the traction of one face of four ends";
  EXPECT_NEAR(std::abs(sewn[0]), 100 * 0.03, 1e-13);
  // The element of another face takes along its part of the force and of the traction.
  const Index element = seams[1].one / 24;
  body.pierce({element});
  const Vec3 pierced = sum();
  EXPECT_LT(pierced[1], 15.5);
  EXPECT_NEAR(pierced[2], 100 * 0.02, 1e-13);
  EXPECT_NEAR(std::abs(pierced[0]), 100 * 0.02, 1e-13);
}

TEST(Removal, BeforeTheFirstBalanceIsNoEventInIt) {
  Moving m(box(4, 2, 2), {}, with_diagonals);
  Column& velocity = m.body.attributes().velocity();
  for (Index v = 0; v < m.body.attributes().vertex_count(); ++v) velocity.set(v, 0, v % 3);
  m.dynamics.start();
  for (int i = 0; i < 10; ++i) m.dynamics.step(1e-4, 1e-4);
  m.body.pierce({0});
  const EnergyBalance first = m.dynamics.balance();
  EXPECT_GT(first.kinetic, 0);
  EXPECT_EQ(first.events, 0);
  m.body.pierce({1});
  EXPECT_LT(m.dynamics.balance().events, 0);
}

TEST(Removal, ConstraintsSurviveSeamsAndForgetWhatIsGone) {
  Moving m(box(4, 2, 2), {}, with_diagonals);
  suture::Body& body = m.body;
  Dynamics& dynamics = m.dynamics;
  const auto seams = middle(body);
  const TopologyChange change = cut_open(body, seams);
  std::vector<Index> held, also;  // the right side of the wound, which the seam takes away
  for (const Split& s : change.splits[0]) held.push_back(s.new_cell);
  for (Index v = 0; v < body.complex().count(0); ++v)
    if (body.attributes().rest().get(v, 0) == 0) also.push_back(v);
  PrescribedMotion motion;
  motion.translation = {0.1, 0, 0};
  motion.ramp = {0, 1e-2, false};
  m.hold(held, 7, motion);
  m.hold(also, 7);
  dynamics.start();
  dynamics.step(1e-4, 1e-4);
  const TopologyChange sewn = body.sew(seams);
  EXPECT_EQ(body.constraints().vertex_count(), held.size() + also.size());
  for (int i = 1; i < 100; ++i) dynamics.step(1e-4, (i + 1) * 1e-4);
  for (const Merge& merge : sewn.merges[0]) {
    EXPECT_EQ(body.attributes().fixed().get(merge.kept, 0), 7);
    EXPECT_NEAR(body.attributes().position().get(merge.kept, 0),
                body.attributes().rest().get(merge.kept, 0) + 0.1, 1e-15);
  }
  // The end that is held goes away with its elements.
  std::vector<Index> end;
  for (Index e = 0; e < body.complex().element_count(); ++e)
    for (const Index v : body.complex().vertices_of(e))
      if (body.attributes().rest().get(v, 0) == 0) end.push_back(e);
  body.pierce(end);
  EXPECT_EQ(body.constraints().vertex_count(), held.size());
  dynamics.step(1e-4, 0.0101);
}

}  // namespace
