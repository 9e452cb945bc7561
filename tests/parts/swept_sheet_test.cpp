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

// However long the edge and its way are beside the body, and where along the edge it is.
TEST_F(MovingAlong, TracesEdgesAndWaysWithoutAnEnd) {
  for (const double length : {1e5, 1e9}) {
    SCOPED_TRACE(length);
    divided = 0;
    build({{0, {{-1, 1.3, -length}, {-1, 1.3, 1.7 * length}}},
           {1, {{13.5, 2.7, -length}, {13.5, 2.7, 1.7 * length}}}});
    ASSERT_NO_FATAL_FAILURE(move(0, 1));
    EXPECT_EQ(islands(), 2u);
    EXPECT_NEAR(lips, 2 * 4 * 12 * std::hypot(1, 1.4 / 14.5), 1e-4);
    divided = 0;
    build({at(0, -1, 1.3), at(0.004, length, 1.3)});
    ASSERT_NO_FATAL_FAILURE(move(0, 0.02));
    EXPECT_EQ(islands(), 2u);
    EXPECT_EQ(divided, 12u * 4);
  }
}

// Along itself by many times the length of its samples near the body.
TEST_F(MovingAlong, CutsWithALongEdgeThatSlides) {
  build({{0, {{-1, 1.3, -1e6}, {-1, 1.3, 1e6}}},
         {1, {{13.5, 1.3, 200 - 1e6}, {13.5, 1.3, 200 + 1e6}}}});
  ASSERT_NO_FATAL_FAILURE(move(0, 1));
  EXPECT_EQ(islands(), 2u);
  EXPECT_EQ(divided, 12u * 4);
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

// Ten ways through one layer of elements, beside each other.
TEST_F(MovingAlong, DividesWhatIsWholeOnly) {
  std::vector<CutBlade::Station> stations;
  for (int i = 0; i <= 10; ++i) stations.push_back(at(i, i % 2 == 0 ? -3 : 15, 1.03 + 0.09 * i));
  build(stations);
  ASSERT_NO_FATAL_FAILURE(move(0, 10));
  EXPECT_EQ(divided, 48u);
  EXPECT_EQ(islands(), 2u);
}

// A saw, which goes to and fro by four elements while it advances by a tenth of one.
TEST_F(MovingAlong, Saws) {
  std::vector<CutBlade::Station> stations;
  for (int i = 0; i <= 145; ++i) {
    const double x = -1 + 0.1 * i, z = i % 2 == 0 ? 2 : -2;
    stations.push_back({i / 145.0, {{x, 1.3, z - 8}, {x, 1.3, z + 12}}});
  }
  build(stations);
  ASSERT_NO_FATAL_FAILURE(move(0, 1));
  EXPECT_EQ(divided, 48u);
  EXPECT_EQ(islands(), 2u);
}

// Half of the width, forwards by seven elements, back by less than one, and so on.
TEST_F(MovingAlong, WaitsWhereItsEdgeGoesBack) {
  build({at(0, -1, 1.3), at(1, 13.5, 2.7)});
  ASSERT_NO_FATAL_FAILURE(move(0, 1));
  const double straight = lips;
  std::vector<CutBlade::Station> stations{at(0, -1, 1.3)};
  for (int i = 1; i <= 60; ++i) {
    const double x = std::min(-1 + 0.3 * i + (i % 2 == 0 ? -0.6 : 0), 13.5);
    stations.push_back(at(i / 60.0, x, 1.3 + (x + 1) * 1.4 / 14.5 + (i % 4 < 2 ? 0.1 : -0.1)));
  }
  divided = 0;
  build(stations);
  ASSERT_NO_FATAL_FAILURE(move(0, 1));
  EXPECT_EQ(islands(), 2u);
  EXPECT_NEAR(lips, straight, 0.05 * straight);
}

// In at one place, turned back by more than an element, and out beside the first slit.
TEST_F(MovingAlong, CutsWhereItTurns) {
  build({at(0, -1, 1.3), at(0.5, 6.4, 1.3), at(1, -1.5, 2.8)});
  ASSERT_NO_FATAL_FAILURE(move(0, 0.5));
  const Index once = divided;
  ASSERT_NO_FATAL_FAILURE(move(0.51, 1));
  EXPECT_GE(divided, once + 4 * 3);
  EXPECT_LE(divided, once + 4 * 7);
}

// Along the bar, out of it, and across.
TEST_F(MovingAlong, CrossesItsOwnSlit) {
  build({at(0, -1, 1.7),
         at(1, 15, 1.7),
         at(1.5, 15, 8),
         at(2, 6.4, 8),
         {3, {{6.4, -3, -1}, {6.6, -3, 5}}}});
  ASSERT_NO_FATAL_FAILURE(move(0, 3));
  EXPECT_EQ(islands(), 4u);
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
