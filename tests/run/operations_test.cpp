// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pierce, suture, blades and islands in a running simulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

// A free block of 6 x 6 x 6 elements that falls.
Scene falling_block(const char* model, Index n = 6) {
  Scene scene = beam(host(), model, n, n, 9.8);
  scene.mesh.box->size = {1, 1, 1};
  scene.constraints.clear();
  scene.solver.dt = 2e-4;
  scene.solver.end = 0.02;
  return scene;
}

double total_mass(const Simulation& simulation, Attributes& a) {
  double mass = 0;
  for (Index v = 0; v < a.vertex_count(); ++v)
    if (simulation.complex().exists(0, v)) mass += a.mass().get(v, 0);
  return mass;
}

class Operations : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Both, Operations, testing::Values("tm-faure", "mss-baudet"),
                         [](const auto& model) { return std::string(model.param, 2); });

TEST_P(Operations, PierceTakesMassAndNothingElse) {
  Scene scene = falling_block(GetParam());
  TestSimulation simulation(scene);
  Listener heard;
  simulation.run_to(0.01, heard);
  Pierce pierce;
  pierce.path = {{0.5, 0.5, -1}, {0.5, 0.5, 2}};
  pierce.radius = 0.13;
  simulation.apply(event_of(pierce), heard);
  EXPECT_EQ(heard.lines, (std::vector<std::string>{"t = 0.01 s: removed 24 elements, 1 island"}));
  simulation.complex().validate();
  EXPECT_NEAR(total_mass(simulation, simulation.attributes()), 1000 * (216 - 24) / 216.0, 1e-10);
  EXPECT_EQ(simulation.run(heard).elements_removed, 24u);
  // What is left falls as if nothing had been.
  Attributes& a = simulation.attributes();
  const double fall = -9.8 * 4e-8 * 100 * 101 / 2;
  for (Index v = 0; v < a.vertex_count(); ++v)
    if (simulation.complex().exists(0, v)) {
      EXPECT_NEAR(a.position().get(v, 1) - a.rest().get(v, 1), fall, 1e-11);
    }
}

// Cut and sewn while nothing has moved apart: every bit as before.
TEST_P(Operations, ASutureUndoesACutBitForBit) {
  std::vector<double> whole;
  for (const bool sewn : {false, true}) {
    Scene scene = falling_block(GetParam(), 4);
    Constraint clamp;
    clamp.where.what = Selection::Named{"x0"};
    scene.constraints.push_back(clamp);
    if (sewn) {
      scene.events.push_back(event_of(CutPlane{{0.5, 0, 0}, {1, 0.3, 0.1}}));
      scene.events.push_back(event_of(CutPlane{{0.5, 0.4, 0.5}, {0, 1, 0.2}}));
      scene.events.push_back(event_of(SewFaces{}));
    }
    TestSimulation simulation(scene);
    Listener heard;
    const RunSummary summary = simulation.run(heard);
    EXPECT_EQ(summary.faces_sewn, summary.faces_cut);
    EXPECT_EQ(summary.faces_cut > 0, sewn);
    std::vector<double> places;
    for (const Hexahedron& nodes : simulation.complex().vertices())
      for (const Index v : nodes)
        for (int c = 0; c < 3; ++c) places.push_back(simulation.attributes().position().get(v, c));
    if (!sewn) whole = places;
    EXPECT_EQ(places, whole);
  }
}

TEST_P(Operations, ASutureKeepsMassAndMomentum) {
  Scene scene = falling_block(GetParam());
  scene.solver.end = 0.1;
  scene.events.push_back(event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}}));
  Constraint hold;  // half of it stays
  hold.where.what = Selection::Named{"x0"};
  scene.constraints.push_back(hold);
  TestSimulation simulation(scene);
  Listener heard;
  simulation.run_to(0.05, heard);
  simulation.energies();
  const auto momentum = [&] {
    Attributes& a = simulation.attributes();
    double sum = 0;
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (simulation.complex().exists(0, v)) sum += a.mass().get(v, 0) * a.velocity().get(v, 1);
    return sum;
  };
  const double before = momentum();
  EXPECT_LT(before, -100) << "kg m/s; half of it falls";
  SewFaces between;
  between.between = {Selection{}, Selection{}};
  (*between.between)[0].what = Selection::HalfSpace{{0.5, 0, 0}, {-1, 0, 0}};
  (*between.between)[1].what = Selection::HalfSpace{{0.5, 0, 0}, {1, 0, 0}};
  between.gap = 0.05;
  simulation.apply(event_of(between), heard);
  EXPECT_EQ(heard.lines.back(), "t = 0.05 s: sewed 36 faces, 1 island");
  simulation.complex().validate();
  EXPECT_NEAR(momentum(), before, 1e-12 * std::abs(before));
  EXPECT_NEAR(total_mass(simulation, simulation.attributes()), 1000, 1e-10);
  simulation.run(heard);
}

// 1,000 random cuts leave 8,000 cubes; the mass is the same, and each falls as a stone.
TEST(Dust, AThousandRandomCutsLeaveSingleElementsThatFall) {
  const unsigned seed = 20;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  Scene scene = falling_block("tm-faure", 20);
  scene.solver.dt = 1e-4;
  scene.solver.end = 0.004;
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  built.dynamics().start();
  const CellComplex& complex = built.body().complex();
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
    if (complex.beta3(d) != none && d < complex.beta3(d)) faces.push_back(d);
  std::ranges::shuffle(faces, random);
  const auto mass = [&] {
    const double* m = built.body().attributes().mass().rows();
    return std::accumulate(m, m + built.body().attributes().vertex_count(), 0.0);
  };
  const double before = mass();
  std::size_t done = 0;
  for (int step = 0; step < 40; ++step) {  // 25 cuts in each step
    for (int i = 0; i < 25; ++i) {
      const std::size_t end = faces.size() * static_cast<std::size_t>(25 * step + i + 1) / 1000;
      built.body().cut({faces.begin() + static_cast<std::ptrdiff_t>(done),
                        faces.begin() + static_cast<std::ptrdiff_t>(end)});
      done = end;
    }
    built.dynamics().step(1e-4, 1e-4 * (step + 1));
  }
  EXPECT_EQ(complex.count(0), 8u * 8000);
  EXPECT_EQ(built.body().islands().existing(), 8000u);
  EXPECT_NEAR(mass(), before, 1e-13 * before);
  const double fall = -9.8 * 1e-8 * 40 * 41 / 2;  // symplectic Euler: g dt^2 n (n + 1) / 2
  Attributes& a = built.body().attributes();
  double worst = 0;
  for (Index v = 0; v < a.vertex_count(); ++v)
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst,
                       std::abs(a.position().get(v, c) - a.rest().get(v, c) - (c == 1 ? fall : 0)));
  EXPECT_LT(worst, 1e-13) << "m";
}

CutBlade blade(std::vector<CutBlade::Station> stations) { return {std::move(stations)}; }

// A blade that moves through tissue, and tissue that is pushed past a blade.
TEST(Blade, CutsWhatItSweepsRelativeToTheTissue) {
  for (const bool tissue_moves : {false, true}) {
    Scene scene = beam(host(), "tm-faure", 8, 4, 0);
    scene.solver.dt = 2e-4;
    scene.solver.end = 0.05;
    scene.constraints.clear();
    const double x = 0.5 + 1e-3, from = -0.1, to = 0.35;
    if (tissue_moves) {
      Constraint push;  // all of it, so that nothing deforms
      push.where.what = Selection::All{};
      push.moves = true;
      push.translation = {0, from - to, 0};
      push.ramp = {0.01, 0.04, false};
      scene.constraints.push_back(push);
      scene.events.push_back(event_of(blade({{0.005, {{x, to, -1}, {x, to, 1}}}})));
      // The tissue comes from below the blade: it starts where the blade would end.
      std::get<CutBlade>(scene.events[0].what).stations[0].points = {{x, from, -1}, {x, from, 1}};
    } else {
      Constraint hold;
      hold.where.what = Selection::All{};
      scene.constraints.push_back(hold);
      scene.events.push_back(event_of(
          blade({{0.01, {{x, from, -1}, {x, from, 1}}}, {0.04, {{x, to, -1}, {x, to, 1}}}})));
    }
    TestSimulation simulation(scene);
    Listener heard;
    simulation.run_to(0.025, heard);  // half the way
    Index islands = 0;
    simulation.complex().islands(&islands);
    EXPECT_EQ(islands, 1u);
    const RunSummary summary = simulation.run(heard);
    EXPECT_EQ(summary.faces_cut, 16u) << (tissue_moves ? "tissue moves" : "blade moves");
    simulation.complex().islands(&islands);
    EXPECT_EQ(islands, 2u);
    EXPECT_TRUE(simulation.diagnostics.warnings().empty()) << simulation.diagnostics.warnings()[0];
  }
}

TEST(Blade, ThatMissesIsReportedOnce) {
  Scene scene = beam(host(), "tm-faure", 4, 2, 0);
  scene.solver.dt = 2e-4;
  scene.solver.end = 0.01;
  scene.events.push_back(
      event_of(blade({{0.001, {{9, 0, 0}, {9, 1, 0}}}, {0.008, {{8, 0, 0}, {8, 1, 0}}}})));
  TestSimulation simulation(scene);
  Listener heard;
  EXPECT_EQ(simulation.run(heard).faces_cut, 0u);
  ASSERT_EQ(simulation.diagnostics.warnings().size(), 1u);
  EXPECT_NE(simulation.diagnostics.warnings()[0].find("/events/0: cut had no effect"),
            std::string::npos)
      << simulation.diagnostics.warnings()[0];
}

// Islands keep their numbers; small ones and those that left the region go.
TEST(IslandEvents, CrumbsAndWhatHasFallenAreRemoved) {
  Scene scene = beam(host(), "tm-faure", 8, 2, 9.8);
  scene.solver.dt = 2e-4;
  scene.solver.end = 0.4;
  RemoveIslands fallen;
  fallen.outside = Selection::InBox{{-1, -0.5, -1}, {2, 1, 1}};
  Event watch = event_of(fallen);
  watch.every = 50;
  scene.events.push_back(event_of(CutFaces{{{{0, 1}, {0, 8}, {0, 16}}}}));  // a corner piece
  RemoveIslands small;
  small.below = 2;
  scene.events.push_back(event_of(small, 0.001));
  scene.events.push_back(event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}}, 0.002));
  scene.events.push_back(watch);
  TestSimulation simulation(scene);
  Listener heard;
  const RunSummary summary = simulation.run(heard);
  ASSERT_EQ(heard.lines.size(), 4u);
  EXPECT_EQ(heard.lines[0], "t = 0 s: cut 3 faces, 2 islands");
  EXPECT_EQ(heard.lines[1], "t = 0.001 s: removed 1 element, 1 island");
  EXPECT_EQ(heard.lines[2], "t = 0.002 s: cut 4 faces, 2 islands");
  EXPECT_NE(heard.lines[3].find("removed 16 elements, 1 island"), std::string::npos);
  EXPECT_EQ(summary.elements_removed, 17u);
}

// A cantilever cut loose from its wall side comes to rest and sleeps; the next cut wakes
// it. With the same scene awake the places agree within the stated bound.
TEST(Sleep, LosesNoMoreThanItsBoundAndAnyEventWakes) {
  const double a = 1e-3, v = 1e-4;
  std::vector<std::vector<double>> places;
  for (const bool sleeps : {false, true}) {
    Scene scene = beam(host(), "tm-faure", 8, 2, 1);
    scene.solver.dt = 1e-3;
    scene.solver.end = 3;
    scene.solver.damping = 20;
    Constraint other;
    other.where.what = Selection::Named{"x1"};
    scene.constraints.push_back(other);
    if (sleeps) {
      scene.solver.sleep_acceleration = a;
      scene.solver.sleep_velocity = v;
    }
    scene.events.push_back(event_of(CutPlane{{0.4, 0, 0}, {1, 0, 0}}));
    scene.events.push_back(event_of(CutPlane{{0.8, 0, 0}, {1, 0, 0}}, 2.5));
    TestSimulation simulation(scene);
    Listener heard;
    simulation.run_to(2.45, heard);
    std::vector<double> now;
    for (const Hexahedron& nodes : simulation.complex().vertices())
      for (const Index vertex : nodes)
        for (int c = 0; c < 3; ++c)
          now.push_back(simulation.attributes().position().get(vertex, c));
    places.push_back(now);
    simulation.run(heard);
    if (!sleeps) continue;
    ASSERT_GE(heard.lines.size(), 3u);
    EXPECT_NE(heard.lines[1].find(" of 2 islands asleep"), std::string::npos) << heard.lines[1];
    EXPECT_EQ(heard.lines[2], "t = 2.5 s: cut 4 faces, 3 islands");
    // The piece that was cut off 0.5 s before the end is awake: damped, it falls
    // g/alpha (T - (1 - exp(-alpha T))/alpha) = 0.0225 m, more than all had sagged.
    double fall = 0;
    const Column& x = simulation.attributes().position();
    for (Index vertex = 0; vertex < x.size(); ++vertex) fall = std::min(fall, x.get(vertex, 1));
    EXPECT_LT(fall, -0.0225) << "m";
  }
  double worst = 0;
  for (std::size_t i = 0; i < places[0].size(); ++i)
    worst = std::max(worst, std::abs(places[0][i] - places[1][i]));
  const double longest = 2.45;  // s; no sleep is longer
  EXPECT_LE(worst, v * longest + a * longest * longest / 2);
  EXPECT_GT(worst, 0) << "something slept";
}

// A cut of half the cross-section, sewn by place: the outer sides beside its lips are
// within the gap, too, at right angles.
TEST(SutureBetween, SewsTheEndOfACut) {
  Scene scene = falling_block("tm-faure");
  CutPlane half{{0.5, 0, 0}, {1, 0, 0}};
  half.radius = 0.6;
  scene.events.push_back(event_of(half));
  SewFaces sew;
  Selection left, right;
  left.what = Selection::HalfSpace{{0.5, 0, 0}, {-1, 0, 0}};
  right.what = Selection::HalfSpace{{0.5, 0, 0}, {1, 0, 0}};
  sew.between = {left, right};
  sew.gap = 0.34;  // two elements
  scene.events.push_back(event_of(sew, 0.01));
  TestSimulation simulation(scene);
  Listener heard;
  const RunSummary summary = simulation.run(heard);
  EXPECT_GT(summary.faces_cut, 0u);
  EXPECT_EQ(summary.faces_sewn, summary.faces_cut);
  EXPECT_TRUE(simulation.diagnostics.warnings().empty()) << simulation.diagnostics.warnings()[0];
}

// What repeats and once had an effect needs no warning; an event that fires once and finds
// the faces cut is reported as such, not as one that misses.
TEST(Cuts, ThatFindNothingLeftAreReportedTruly) {
  CutPlane plane{{0.5, 0, 0}, {1, 0, 0}};
  const auto warnings = [&](bool again) {
    Scene scene = falling_block("tm-faure", 4);
    scene.events.push_back(event_of(plane));
    if (again)
      scene.events.push_back(event_of(plane, 0.01));
    else
      scene.events[0].every = 1;
    TestSimulation simulation(scene);
    Listener heard;
    simulation.run(heard);
    return simulation.diagnostics.warnings();
  };
  EXPECT_TRUE(warnings(false).empty());
  EXPECT_EQ(warnings(true),
            (std::vector<std::string>{"t = 0.01 s: /events/0 cut no face: the blade misses the "
                                      "body, or the faces there have already been cut"}));
  plane.point[0] = 9;
  EXPECT_EQ(warnings(false),
            (std::vector<std::string>{"/events/0: cut had no effect in the whole run"}));
}

// A load or a constraint that loses what it acts on is reported by its path, once for a
// part of it and once for all.
TEST(Pierce, ReportsLoadsAndConstraintsThatLoseNodes) {
  Scene scene = falling_block("tm-faure", 4);
  Load force;
  force.where.what = Selection::Named{"y0"};
  force.value = {0, 1, 0};
  Load pressure = force;
  pressure.kind = Load::Kind::pressure;
  pressure.pressure = 1;
  pressure.where.what = Selection::Named{"z0"};
  scene.loads = {force, pressure};
  Constraint hold;
  hold.where.what = Selection::Named{"x1"};
  scene.constraints.push_back(hold);
  const auto slab = [](Vec3 min, Vec3 max, double at) {
    Pierce pierce;
    pierce.where.emplace().what = Selection::InBox{min, max};
    return event_of(pierce, at);
  };
  // One element at the side y0; then all of that side but those at x1; then those.
  scene.events = {slab({0.3, -1, 0.3}, {0.4, 0.2, 0.4}, 0),
                  slab({-1, -1, -1}, {0.7, 0.2, 2}, 0.002), slab({-1, -1, -1}, {2, 0.2, 2}, 0.004)};
  TestSimulation simulation(scene);
  Listener heard;
  EXPECT_EQ(simulation.run(heard).elements_removed, 16u);
  const std::string part = " removes some of the nodes or faces on which ",
                    ends = " acts; it continues to act on the others";
  EXPECT_EQ(
      simulation.diagnostics.warnings(),
      (std::vector<std::string>{"t = 0 s: /events/0 pierce" + part + "/loads/0" + ends,
                                "t = 0.002 s: /events/0 pierce" + part + "/loads/1" + ends,
                                "t = 0.004 s: /events/0 pierce removes all nodes or faces on which "
                                "/loads/0 acts; it has no effect from now on",
                                "t = 0.004 s: /events/0 pierce" + part + "/constraints/0" + ends}));
}

TEST(Mistakes, LeaveEverythingAsItWas) {
  Scene scene = falling_block("tm-faure", 3);
  TestSimulation simulation(scene);
  Listener heard;
  Pierce all;
  all.where = Selection{};
  const auto message = [&](const Event& event) {
    try {
      simulation.apply(event, heard);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message(event_of(all)).find("/events/0: pierce would remove all 27 remaining elements"),
            std::string::npos);
  SewFaces back_to_back;
  back_to_back.element_pairs = {{0, 1}, {0, 99}};
  EXPECT_EQ(message(event_of(back_to_back)),
            "/events/0/suture/faces/1: the mesh has no element 99");
  Pierce nodes;
  nodes.where.emplace().what = Selection::Named{"y1"};
  nodes.where->path = "/here";
  EXPECT_EQ(message(event_of(nodes)).find("/here: 'y1' is a set of nodes, but elements are"), 0u);
  EXPECT_EQ(simulation.complex().existing(3), 27u);
  EXPECT_TRUE(heard.lines.empty());
  simulation.run(heard);
}

}  // namespace
}  // namespace suture::test
