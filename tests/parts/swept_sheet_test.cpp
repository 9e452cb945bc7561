// SPDX-License-Identifier: GPL-3.0-or-later
//
// Moving blades that divide elements, step by step, through a body that does not move.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "kernel/base/vec3.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "tests/parts/cut_box.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/open_scene.hpp"

namespace suture::test::swept_sheet_test {
namespace {

/// A bar of 12 x 4 x 4 elements of 1 m; the edge of the blade lies along z.
Scene bar() {
  Scene scene = beam(tree_plugins(), "tm-faure", 1, 1, 0);
  scene.mesh.box = BoxOptions{{0, 0, 0}, {12, 4, 4}, {12, 4, 4}};
  scene.constraints.clear();
  scene.output.fields = {"displacement"};
  scene.output.surface = true;
  return scene;
}

CutBlade::Station at(double time, double x, double y, double low = -1, double high = 5) {
  return {time, {{x, y, low}, {x + 0.2, y, high}}};
}

class MovingAlong : public testing::Test {
 protected:
  void build(std::vector<CutBlade::Station> stations) {
    CutBlade blade;
    blade.stations = std::move(stations);
    blade.along_blade = true;
    Event event;
    event.what = blade;
    event.path = "/events/0";
    scene.events = {event};
    open.emplace(scene);
  }
  /// In steps of 0.01 s; after each, the surface is closed and holds the same volume.
  void move(double from, double to) {
    for (int i = 0; from + 0.01 * i <= to + 1e-9; ++i) {
      const EventOutcome outcome = open->events.fire(0, from + 0.01 * i);
      divided += outcome.elements_cut;
      if (!outcome.changed()) continue;
      ASSERT_NO_FATAL_FAILURE(expect_sound());
    }
  }
  void expect_sound() {
    ASSERT_NO_THROW(open->built.body().complex().validate());
    ASSERT_NO_FATAL_FAILURE(expect_closed(open->built.embedding()));
    measure();
    ASSERT_NEAR(volume, 192, 1e-10);
  }
  void measure() {
    const Frame surface = open->side();
    const auto& cut = surface.cell_fields.back().ids;
    volume = lips = 0;
    for (std::size_t t = 0; t < surface.cells.size(); ++t) {
      const auto corner = [&](int i) { return surface.points[surface.cells[t][i]]; };
      const Vec3 area = cross(minus(corner(1), corner(0)), minus(corner(2), corner(0)));
      volume += dot(corner(0), area) / 6;
      if (cut[t] != 0) lips += norm(area) / 2;
    }
  }
  Index islands() { return open->built.body().islands().existing(); }

  Scene scene = bar();
  std::optional<OpenScene> open;
  Index divided = 0;
  double volume = 0, lips = 0;
};

// A blade that enters the tissue and stands there at once divides nothing.
TEST_F(MovingAlong, CutsNothingWithoutAWay) {
  build({at(0, 3, 2), at(0.1, 3, 2)});
  move(0, 0.2);
  EXPECT_EQ(divided, 0u);
}

// From left to right along an oblique plane: the same lips as those of the plane.
TEST_F(MovingAlong, CutsAPlaneAsThePlaneDoes) {
  build({at(0, -1, 1.3), at(1, 13.5, 2.7)});
  move(0, 0.85);
  EXPECT_EQ(islands(), 1u);
  move(0.86, 1);
  EXPECT_EQ(islands(), 2u);
  const Index by_blade = divided;
  const double by_blade_lips = lips;
  const Vec3 along = minus({13.5, 2.7, 0}, {-1, 1.3, 0}), edge{0.2, 0, 6};
  scene.events[0].what =
      CutPlane{.point = {-1, 1.3, -1}, .normal = cross(along, edge), .along_blade = true};
  open.emplace(scene);
  EXPECT_EQ(open->events.fire(0, 0).elements_cut, by_blade);
  measure();
  EXPECT_NEAR(by_blade_lips, lips, 1e-6 * lips);
}

// Elements see the arc through the heights of their nodes, fixed when they are first divided.
TEST_F(MovingAlong, CutsWhatItPassesWithinAStep) {
  build({at(0, -1, 1.3), at(0.004, 13.5, 2.7)});
  move(0, 0.02);
  EXPECT_EQ(islands(), 2u);
  const Index in_a_step = divided;
  divided = 0;
  build({at(0, -1, 1.3), at(1, 13.5, 2.7)});
  move(0, 1);
  EXPECT_EQ(in_a_step, divided);
}

TEST_F(MovingAlong, RefusesEdgesAndWaysWithoutAnEnd) {
  EXPECT_THAT(
      [&] {
        build({at(0, 3, 2, -1, 1e5), at(1, 4, 2, -1, 1e5)});
      },
      testing::ThrowsMessage<InputError>(testing::HasSubstr(
          "/events/0/cut: the edge of the blade is 1e+05 m long, 1e+05 elements; at most "
          "5e+04 elements are traced")));
  build({at(0, -1, 1.3), at(0.004, 4e9, 2.7)});
  EXPECT_THAT([&] { move(0, 0.01); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr(
                  "t = 0.01 s: /events/0/cut/blade: the blade moves 4e+09 m in this step")));
  build({at(0, -1, 1.3), at(0.004, 1e5, 2.7)});
  move(0, 0.02);
  EXPECT_EQ(islands(), 2u);
}

TEST_F(MovingAlong, CutsAnArc) {
  std::vector<CutBlade::Station> stations;
  double length = 0;
  for (int i = 0; i <= 60; ++i) {
    const double x = -1 + 14.0 * i / 60, y = 1.2 + 1.5 * std::sin(M_PI * x / 12);
    stations.push_back({i / 60.0, {{x, y, -1}, {x, y, 5}}});
    if (x > 0 && x <= 12)
      length += std::hypot(14.0 / 60, 1.5 * M_PI / 12 * std::cos(M_PI * x / 12) * 14.0 / 60);
  }
  build(stations);
  move(0, 1);
  EXPECT_EQ(islands(), 2u);
  EXPECT_NEAR(lips, 2 * 4 * length, 0.02 * 2 * 4 * length);
}

// Into the body and back the same way, and in again to the same depth: one slit.
TEST_F(MovingAlong, FindsItsOwnSlitAgain) {
  build({at(0, -1, 1.3), at(0.5, 6.2, 1.7), at(1, -1.5, 1.25), at(1.5, 6.2, 1.7)});
  move(0, 0.5);
  EXPECT_EQ(islands(), 1u);
  const Index once = divided;
  EXPECT_GT(once, 4u * 4);
  move(0.51, 1.5);
  EXPECT_EQ(divided, once);
  EXPECT_EQ(islands(), 1u);
}

// Half of the width: the lower end of the edge stays inside, and elements there stay whole.
TEST_F(MovingAlong, LeavesWhatItsEdgeCrossesInPart) {
  build({at(0, -1, 1.3, 1.5), at(1, 13.5, 1.4, 1.5)});
  move(0, 1);
  EXPECT_EQ(divided, 12u * 2);
  EXPECT_EQ(islands(), 1u);
}

// The opening lags behind the edge by less than an element and a row of the sheet.
TEST_F(MovingAlong, OpensBehindTheEdge) {
  build({at(0, -1, 1.3), at(1, 13.5, 1.3)});
  for (int i = 0; i < 80; ++i) {
    move(0.01 * i, 0.01 * i);
    const double tip = -1 + 14.5 * 0.01 * i;
    EXPECT_GE(divided + 4 * 1.5, 4 * std::floor(tip)) << tip;
    EXPECT_LE(divided, 4 * std::max(std::ceil(tip), 0.0)) << tip;
  }
}

// Forwards, up and down, and tilted.
TEST_F(MovingAlong, RandomWaysKeepVolumeSurfaceAndMap) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 200 : 8;
  unsigned splinters = 0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> y(1.3, 2.7), tilt(-0.5, 0.5);
    std::vector<CutBlade::Station> stations;
    double height = y(random);
    for (int i = 0; i <= 5; ++i) {
      const double x = -1 + 14.5 * i / 5, half = tilt(random);
      stations.push_back({i / 5.0, {{x, height - half, -1}, {x + tilt(random), height + half, 5}}});
      height = std::clamp(height + tilt(random), 1.3, 2.7);
    }
    build(stations);
    ASSERT_NO_FATAL_FAILURE(move(0, 1));
    splinters += islands() != 2;
  }
  EXPECT_LE(splinters, runs / 100) << "of two per mille of an element";
}

// As tissue does that trembles at an edge: ten ways through one layer of elements, beside each
// other.
TEST_F(MovingAlong, DoesNotShredWhatItPassesAgainAndAgain) {
  std::vector<CutBlade::Station> stations;
  for (int i = 0; i <= 10; ++i) stations.push_back(at(i, i % 2 == 0 ? -3 : 15, 1.03 + 0.09 * i));
  build(stations);
  for (int i = 0; i <= 1000; ++i) divided += open->events.fire(0, 0.01 * i).elements_cut;
  EXPECT_GE(divided, 48u);
  EXPECT_LE(divided, 3 * 48u) << "an element once, and both of its copies";
}

// A blade that crosses its own way: what it leaves is sound, whatever it is.
TEST_F(MovingAlong, WildWaysKeepMapMassAndSurface) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 400 : 8;
  unsigned open_sides = 0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-1, 5), along(-1, 13);
    std::vector<CutBlade::Station> stations;
    for (int i = 0; i < 5; ++i)
      stations.push_back({i / 4.0,
                          {{along(random), place(random), place(random)},
                           {along(random), place(random), place(random)}}});
    build(stations);
    const auto mass = [&] {
      const Column& column = open->built.body().attributes().mass();
      double sum = 0;
      for (Index v = 0; v < column.size(); ++v) sum += column.get(v, 0);
      return sum;
    };
    const double before = mass();
    for (int i = 0; i <= 100; ++i) {
      if (!open->events.fire(0, 0.01 * i).changed()) continue;
      ASSERT_NO_THROW(open->built.body().complex().validate());
    }
    EXPECT_NEAR(mass(), before, 1e-12 * before);
    measure();
    EXPECT_NEAR(volume, 192, 1e-10);
    open_sides += open_side(open->built.embedding()) ? 1 : 0;
  }
  EXPECT_LE(open_sides, runs / 400) << "slits without area";
}

}  // namespace
}  // namespace suture::test::swept_sheet_test
