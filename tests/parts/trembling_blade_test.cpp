// SPDX-License-Identifier: GPL-3.0-or-later
//
// Moving blades in tissue that trembles, swings and is pushed past them.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <random>

#include "kernel/base/rows.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/parts/cut_box.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/open_scene.hpp"

namespace suture::test::trembling_blade_test {
namespace {

using Motion = std::function<Vec3(const Vec3& at_rest, double time)>;

/// A bar of 12 x 4 x 4 elements of 1 m.
Scene bar() {
  Scene scene = beam(tree_plugins(), "tm-faure", 1, 1, 0);
  scene.mesh.box = BoxOptions{{0, 0, 0}, {12, 4, 4}, {12, 4, 4}};
  scene.constraints.clear();
  scene.output.fields = {"displacement"};
  scene.output.surface = true;
  return scene;
}

CutBlade along(std::vector<CutBlade::Station> stations) {
  CutBlade blade;
  blade.stations = std::move(stations);
  blade.along_blade = true;
  return blade;
}

/// A bar that is moved, rigidly, and blades.
class MovedBar {
 public:
  explicit MovedBar(std::vector<CutBlade> blades) : open_(scene_with(std::move(blades))) {}

  /// In steps of 0.005 s. Elements are divided by their numbers in the mesh.
  void move(const Motion& motion, double end) {
    for (int i = 0; i <= std::lround(end / dt); ++i) {
      place(motion, dt * i);
      for (std::size_t b = 0; b < open_.scene.events.size(); ++b) {
        const Index before = complex().element_count();
        open_.events.fire(b, dt * i);
        count(b, before);
      }
    }
  }
  /// How often the elements were divided by a blade, at most.
  Index most_divisions(std::size_t blade) const {
    Index most = 0;
    for (const auto& [element, times] : divisions_.at(blade)) most = std::max(most, times);
    return most;
  }
  std::size_t divided(std::size_t blade) const { return divisions_.at(blade).size(); }
  Index islands() { return open_.built.body().islands().existing(); }

  struct Measures {
    double volume = 0, lips = 0;
  };
  Measures measures() {
    const Frame surface = open_.side();
    const auto& cut = surface.cell_fields.back().ids;
    Measures sum;
    for (std::size_t t = 0; t < surface.cells.size(); ++t) {
      const auto corner = [&](int i) { return surface.points[surface.cells[t][i]]; };
      const Vec3 area = cross(minus(corner(1), corner(0)), minus(corner(2), corner(0)));
      sum.volume += dot(corner(0), area) / 6;
      if (cut[t] != 0) sum.lips += norm(area) / 2;
    }
    return sum;
  }
  bool has_open_side() { return open_side(open_.built.embedding()).has_value(); }
  const CellComplex& complex() { return open_.built.body().complex(); }
  void expect_sound() {
    ASSERT_NO_THROW(complex().validate());
    ASSERT_NO_FATAL_FAILURE(expect_closed(open_.built.embedding()));
    ASSERT_NEAR(measures().volume, 192, 1e-9);
  }

 private:
  static constexpr double dt = 0.005;

  static Scene scene_with(std::vector<CutBlade> blades) {
    Scene scene = bar();
    for (std::size_t b = 0; b < blades.size(); ++b) {
      Event event;
      event.what = std::move(blades[b]);
      event.path = "/events/" + std::to_string(b);
      scene.events.push_back(event);
    }
    return scene;
  }

  void place(const Motion& motion, double time) {
    Attributes& a = open_.built.body().attributes();
    for (Index v = 0; v < a.vertex_count(); ++v) {
      const Vec3 at_rest = row(a.rest().rows(), v), now = motion(at_rest, time),
                 before = motion(at_rest, time - dt);
      for (int c = 0; c < 3; ++c) {
        a.position().set(v, c, now[c]);
        a.velocity().set(v, c, (now[c] - before[c]) / dt);
      }
    }
  }
  /// Copies that came together have come from elements that were divided once.
  void count(std::size_t blade, Index before) {
    std::map<Index, std::vector<Index>> copies;
    for (Index e = before; e < complex().element_count(); ++e)
      copies[static_cast<Index>(open_.built.element_name(e))].push_back(e);
    for (const auto& [name, list] : copies) ++divisions_[blade][name];
    divisions_[blade];
  }

  OpenScene open_;
  std::map<std::size_t, std::map<Index, Index>> divisions_;
};

Motion still() {
  return [](const Vec3& x, double) { return x; };
}

/// About the middle of the bar, and along a direction, with random frequencies.
Motion trembling(std::mt19937_64& random, double amplitude) {
  std::uniform_real_distribution<double> between(-1, 1), frequency(5, 60), phase(0, 2 * M_PI);
  const Vec3 by{between(random), between(random), between(random)};
  const double f = frequency(random), g = frequency(random), p = phase(random), q = phase(random),
               turn = 0.1 * amplitude * between(random);
  return [=](const Vec3& x, double t) {
    const double angle = turn * std::sin(2 * M_PI * g * t + q),
                 shake = amplitude * std::sin(2 * M_PI * f * t + p);
    const Vec3 from{x[0] - 6, x[1] - 2, x[2] - 2};
    return Vec3{6 + std::cos(angle) * from[0] - std::sin(angle) * from[1] + shake * by[0],
                2 + std::sin(angle) * from[0] + std::cos(angle) * from[1] + shake * by[1],
                2 + from[2] + shake * by[2]};
  };
}

/// Lips of a plane through the bar along which a blade moves.
double lips_of_plane(const CutBlade::Station& from, const CutBlade::Station& to) {
  const Vec3 step = minus(to.points[0], from.points[0]);
  return 2 * 4 * 12 * std::hypot(step[0], step[1]) / std::abs(step[0]);
}

// Tissue that trembles by a third of an element in any direction, about a blade that goes through
// it: the cut is that in still tissue.
TEST(TremblingBlade, LeavesOneSurface) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 200 : 6;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> y(1.2, 2.8), amplitude(0, 0.35);
    const double from = y(random), to = y(random);
    const CutBlade::Station first{0, {{-2, from, -2}, {-1.8, from, 6}}},
        last{1, {{14.5, to, -2}, {14.7, to, 6}}};
    MovedBar moved({along({first, last})});
    moved.move(trembling(random, amplitude(random)), 1);
    ASSERT_NO_FATAL_FAILURE(moved.expect_sound());
    EXPECT_EQ(moved.most_divisions(0), 1u);
    EXPECT_EQ(moved.islands(), 2u);
    const double lips = lips_of_plane(first, last);
    EXPECT_NEAR(moved.measures().lips, lips, 0.25 * lips);
  }
}

// However strongly it trembles, and however the blades move: they graze the tissue, stop in it,
// leave it on the side on which they came, cross each other, and turn.
TEST(TremblingBlade, KeepsMapVolumeAndSurfaceHoweverItMoves) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 300 : 8;
  unsigned open_sides = 0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(1000 + seed);
    std::uniform_real_distribution<double> x(-2, 14), y(-1, 5), amplitude(0, 1), from(0, 0.4);
    std::vector<CutBlade> blades;
    for (unsigned b = 0; b < 1 + seed % 2; ++b) {
      std::vector<CutBlade::Station> stations;
      double t = from(random);
      for (unsigned k = 0; k < 2 + random() % 3; ++k, t += 0.2)
        stations.push_back({t, {{x(random), y(random), -2}, {x(random), y(random), 6}}});
      blades.push_back(along(stations));
    }
    MovedBar moved(blades);
    ASSERT_NO_THROW(moved.move(trembling(random, amplitude(random)), 1));
    for (std::size_t b = 0; b < blades.size(); ++b)
      EXPECT_LE(moved.most_divisions(b), 3u) << "once, and both copies where it is crossed";
    EXPECT_NEAR(moved.measures().volume, 192, 1e-9);
    ASSERT_NO_THROW(moved.complex().validate());
    open_sides += moved.has_open_side() ? 1 : 0;
  }
  EXPECT_LE(open_sides, runs / 100) << "slits without area";
}

// A bar that flies past a blade, and a blade that flies past a bar.
TEST(TremblingBlade, CutsTissueThatIsPushedPastIt) {
  const double speed = 16;
  MovedBar by_blade({along({{0, {{-2, 1.3, -2}, {-1.8, 1.3, 6}}},
                            {1, {{-2 + speed, 2.7, -2}, {-1.8 + speed, 2.7, 6}}}})});
  by_blade.move(still(), 1);
  MovedBar by_tissue({along({{0, {{-2, 1.3, -2}, {-1.8, 1.3, 6}}}})});
  by_tissue.move([&](const Vec3& p, double t) { return plus(p, {-speed * t, -1.4 * t, 0}); }, 1);
  ASSERT_NO_FATAL_FAILURE(by_tissue.expect_sound());
  EXPECT_EQ(by_tissue.islands(), 2u);
  EXPECT_EQ(by_tissue.divided(0), by_blade.divided(0));
  EXPECT_NEAR(by_tissue.measures().lips, by_blade.measures().lips, 1e-6);
}

// It touches the bar, which falls away; the blade goes on beside it, through where it was.
TEST(TremblingBlade, CutsNothingWhereTheTissueHasLeft) {
  MovedBar moved({along({{0, {{-1, 4.01, -2}, {13, 4.01, -2}}}, {1, {{-1, 1, 2}, {13, 1, 2}}}})});
  moved.move(
      [](const Vec3& p, double t) {
        return plus(p, {0, t < 0.01 ? 0 : 30 * (0.01 - t), 0});
      },
      1);
  EXPECT_EQ(moved.divided(0), 0u);
  EXPECT_EQ(moved.islands(), 1u);
}

// A cantilever falls into three blades that come towards it, and swings.
TEST(TremblingBlade, EndsRunsInWhichABarSwings) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> x(0.03, 0.1), end(0.15, 0.3);
    Scene scene =
        beam(tree_plugins(), "neo-hookean", 12, 4, 9.81, {{"E", 4e4}, {"nu", 0.4}, {"rho", 1e3}});
    scene.mesh.box = BoxOptions{{0, 0, 0}, {0.12, 0.04, 0.04}, {12, 4, 4}};
    scene.solver.end = 0.3;
    scene.debris.removes = true;
    if (seed == 3) scene.solver.dt = 2e-3;
    if (seed == 3) scene.solver.integrator = "implicit-euler";
    for (int b = 0; b < 3; ++b) {
      const double at = x(random);
      Event event;
      event.what = along({{0.02, {{at, 0.05, -0.01}, {at, 0.05, 0.05}}},
                          {end(random), {{at, 0.01 * b - 0.05, -0.01}, {at, -0.05, 0.05}}}});
      event.path = "/events/" + std::to_string(b);
      scene.events.push_back(event);
    }
    Diagnostics diagnostics;
    Simulation simulation(scene, tree_plugins(), diagnostics);
    Observer nobody;
    ASSERT_NO_THROW(simulation.run(nobody));
  }
}

}  // namespace
}  // namespace suture::test::trembling_blade_test
