// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/moving_blade.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "tests/base/same_state.hpp"
#include "tests/geometry/dyadic.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

using namespace test;

using Polyline = std::vector<Vec3>;

Polyline moved(Polyline line, const Vec3& by) {
  for (Vec3& p : line) p = plus(p, by);
  return line;
}

void move(Block& block, const Vec3& by) {
  for (std::size_t i = 0; i < block.rows.size(); i += 4)
    for (int a = 0; a < 3; ++a) block.rows[i + a] += by[a];
}

Vec3 lattice_point(std::mt19937& random, double unit, double low, double high) {
  std::uniform_int_distribution<int> step(static_cast<int>(low / unit),
                                          static_cast<int>(high / unit));
  return {unit * step(random), unit * step(random), unit * step(random)};
}

/// The triangles of the class's description for still tissue.
TriangleSurface swept(const Polyline& from, const Polyline& to) {
  TriangleSurface s{"swept", from, {}};
  s.points.insert(s.points.end(), to.begin(), to.end());
  const auto n = static_cast<Index>(from.size());
  for (Index i = 0; i + 1 < n; ++i) {
    s.triangles.push_back({i, i + 1, n + i + 1});
    s.triangles.push_back({i, n + i + 1, n + i});
  }
  return s;
}

void unite(std::vector<Dart>& all, const std::vector<Dart>& more) {
  all.insert(all.end(), more.begin(), more.end());
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

TEST(MovingBlade, ThroughStillTissueCutsWhatTheSweptSurfaceCuts) {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const double unit = seed % 3 == 0 ? 0.5 : 1.0 / 256;
    const Block block = jittered_block(5, 4, 5, seed % 2 ? 0 : 1.0 / 64, random);
    Polyline from, to;
    for (unsigned i = 0; i < 2 + seed % 3; ++i) {
      from.push_back(lattice_point(random, unit, -1, 6));
      to.push_back(lattice_point(random, unit, -1, 6));
    }
    MovingBlade blade({{2, from}, {3, to}});
    EXPECT_TRUE(blade.advance(block.complex, block.places(), 2).empty());
    const std::vector<Dart> faces = blade.advance(block.complex, block.places(), 3);
    EXPECT_EQ(faces, every_face_against_every_triangle(swept(from, to), block));
    total += faces.size();
  }
  EXPECT_GT(total, 500u);
}

// A key between two steps: what lies before and behind it is swept.
TEST(MovingBlade, TurnsAtItsKeys) {
  const Block block = block_of(6, 6, 6);
  const Polyline line{{2.25, -1, 1.75}, {2.25, 7, 1.75}};
  const Polyline middle = moved(line, {2, 0, 0}), last = moved(middle, {0, 0, 2});
  MovingBlade blade({{0, line}, {1, middle}, {2, last}});
  blade.advance(block.complex, block.places(), 0);
  const std::vector<Dart> faces = blade.advance(block.complex, block.places(), 5);
  std::vector<Dart> expected = every_face_against_every_triangle(swept(line, middle), block);
  EXPECT_EQ(expected.size(), 12u);
  unite(expected, every_face_against_every_triangle(swept(middle, last), block));
  EXPECT_EQ(faces, expected);
  EXPECT_EQ(expected.size(), 24u);
  EXPECT_TRUE(blade.advance(block.complex, block.places(), 6).empty());
}

TEST(MovingBlade, ManySmallStepsCutAsOne) {
  std::mt19937 random(17);
  const Block block = jittered_block(6, 6, 6, 1.0 / 64, random);
  const Polyline line{{-1, 0.28125, 2.40625}, {2.1875, 3.03125, 3.15625}, {7, 5.40625, 2.03125}};
  const Vec3 way{0.5, -0.25, 2};
  MovingBlade one({{0, line}, {1, moved(line, way)}}), many = one;
  one.advance(block.complex, block.places(), 0);
  many.advance(block.complex, block.places(), 0);
  const std::vector<Dart> whole = one.advance(block.complex, block.places(), 1);
  std::vector<Dart> parts;
  for (int i = 1; i <= 64; ++i) unite(parts, many.advance(block.complex, block.places(), i / 64.0));
  EXPECT_EQ(parts, whole);
  EXPECT_GT(whole.size(), 20u);
}

// Tissue is pushed past a still blade: the same cut as by a blade that moves the other way.
TEST(MovingBlade, StandingStillCutsTissueThatIsPushedPast) {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Block block = jittered_block(5, 4, 5, seed % 2 ? 0 : 1.0 / 64, random);
    const Polyline line{lattice_point(random, 0.25, -1, 6), lattice_point(random, 0.25, -1, 6)};
    if (line[0] == line[1]) continue;
    const Vec3 push = lattice_point(random, 0.25, -3, 3);
    MovingBlade still({{0, line}});
    Block pushed = block;
    still.advance(pushed.complex, pushed.places(), 0);
    move(pushed, push);
    const std::vector<Dart> faces = still.advance(pushed.complex, pushed.places(), 1);
    MovingBlade moving({{0, line}, {1, moved(line, {-push[0], -push[1], -push[2]})}});
    moving.advance(block.complex, block.places(), 0);
    EXPECT_EQ(faces, moving.advance(block.complex, block.places(), 1));
    total += faces.size();
  }
  EXPECT_GT(total, 100u);
}

TEST(MovingBlade, GoingWithTheTissueCutsNothing) {
  std::mt19937 random(23);
  Block block = jittered_block(6, 6, 6, 1.0 / 64, random);
  const Polyline line{{-1, 3.1, 2.6}, {7, 3.4, 3.3}};
  // Blade and tissue turn about the z axis together, half a degree per step.
  const auto turned = [](const Vec3& p, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return Vec3{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
  };
  const double step = 0.0087;
  std::vector<BladeKey> keys;
  for (int i = 0; i <= 100; ++i) {
    keys.push_back({double(i), line});
    for (Vec3& p : keys.back().points) p = turned(p, i * step);
  }
  MovingBlade blade(keys);
  const std::vector<double> rest = block.rows;
  for (int i = 0; i <= 100; ++i) {
    for (std::size_t v = 0; v < rest.size(); v += 4) {
      const Vec3 p = turned({rest[v], rest[v + 1], rest[v + 2]}, i * step);
      std::copy(p.begin(), p.end(), block.rows.begin() + static_cast<std::ptrdiff_t>(v));
    }
    EXPECT_TRUE(blade.advance(block.complex, block.places(), i).empty()) << "step " << i;
  }
}

// Tissue rocks about the blade's direction and stretches while the blade comes, slowly: no link
// slips through between two steps, so the blade separates the body into two.
TEST(MovingBlade, LeavesNoBridgeInTissueThatTurns) {
  std::mt19937 random(29);
  Block block = jittered_block(8, 8, 8, 1.0 / 64, random);
  const std::vector<double> rest = block.rows;
  const Polyline line{{-8, -30, 4.3}, {-8, 40, 4.3}};
  const int steps = 240;
  std::vector<Dart> faces;
  MovingBlade blade({{0, line}, {double(steps), moved(line, {24, 0, 0})}});
  for (int i = 0; i <= steps; ++i) {
    const double angle = 0.4 * std::sin(0.05 * i), stretch = 1 + 0.2 * std::sin(0.07 * i);
    for (std::size_t v = 0; v < rest.size(); v += 4) {
      const double x = rest[v] - 4, z = rest[v + 2] - 4;
      block.rows[v] = 4 + std::cos(angle) * x - std::sin(angle) * z;
      block.rows[v + 1] = rest[v + 1] * stretch;
      block.rows[v + 2] = 4 + std::sin(angle) * x + std::cos(angle) * z;
    }
    unite(faces, blade.advance(block.complex, block.places(), i));
  }
  block.complex.cut(faces);
  Index islands = 0;
  block.complex.islands(&islands);
  EXPECT_EQ(islands, 2u);
}

// The same cuts in the same steps as by a check of every element, whatever moves how fast,
// through cuts and removals, reported to the blade or not.
TEST(MovingBlade, LooksNearItselfAndMissesNothing) {
  const char* given = std::getenv("SUTURE_SEED");
  const unsigned first = given ? static_cast<unsigned>(std::atoi(given)) : std::random_device{}();
  const unsigned rounds = std::getenv("SUTURE_FULL") ? 3000 : 60;
  std::size_t total = 0;
  for (unsigned seed = first; seed < first + rounds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1, 1);
    Block block = jittered_block(12, 3 + seed % 5, 9, 1.0 / 64, random);
    const double far = seed % 4 == 0 ? 1e6 : 0;  // where a coordinate's last place is coarse
    move(block, {far, -far, far});
    std::vector<BladeKey> keys;
    for (int i = 0; i < 4; ++i) {
      keys.push_back({i * 4.0, {}});
      for (unsigned p = 0; p < 2 + seed % 2; ++p)
        keys.back().points.push_back(plus(lattice_point(random, 0.25, -1, 10), {far, -far, far}));
      if (keys.back().points[0] == keys.back().points[1]) keys.back().points[0][0] += 1;
    }
    MovingBlade near(keys), all(keys, MovingBlade::Scope::all);
    const double speed = std::pow(10, 2 * number(random) - 1);  // elements per step
    Vec3 drift{};
    for (int step = 0; step <= 16; ++step) {
      const auto faces = near.advance(block.complex, block.places(), step);
      ASSERT_EQ(faces, all.advance(block.complex, block.places(), step)) << "step " << step;
      total += faces.size();
      const auto follow = [&](const TopologyChange& change) {
        for (const Split& split : change.splits[0])
          for (std::size_t a = 0; a < 4; ++a)
            block.rows.push_back(block.rows[4 * std::size_t{split.old_cell} + a]);
        if (seed % 3 == 0) return;
        near.follow(block.complex, change);
        all.follow(block.complex, change);
      };
      if (!faces.empty() && seed % 3 != 2) follow(block.complex.cut(faces));
      if (const Index e = random() % block.complex.element_count();
          step % 5 == 2 && block.complex.can_pierce(e))
        follow(block.complex.pierce({{e}}));
      for (double& d : drift) d = step % 4 == 0 ? speed * number(random) : d;
      for (std::size_t v = 0; v < block.rows.size(); v += 4)
        for (std::size_t a = 0; a < 3; ++a)
          block.rows[v + a] += drift[a] + 0.2 * speed * number(random);
    }
  }
  EXPECT_GT(total, rounds);
}

// Saved before, during and after its life; vertices may have been moved by nobody's leave.
TEST(MovingBlade, ThatIsLoadedCutsAsTheOneThatWasSaved) {
  const unsigned first = std::random_device{}();
  std::size_t total = 0;
  for (unsigned seed = first; seed < first + 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1, 1);
    Block block = jittered_block(12, 3 + seed % 5, 9, 1.0 / 64, random);
    std::vector<BladeKey> keys;
    for (int i = 0; i < 4; ++i) {
      keys.push_back({2 + i * 4.0, {lattice_point(random, 0.25, -1, 10)}});
      keys.back().points.push_back(plus(keys.back().points[0], {0.5, 9, double(i)}));
    }
    MovingBlade blade(keys), twin(keys);
    const int saved = static_cast<int>(seed % 17);
    for (int step = 0; step <= 17; ++step) {
      const auto faces = blade.advance(block.complex, block.places(), step);
      total += faces.size();
      if (step > saved) {
        ASSERT_EQ(faces, twin.advance(block.complex, block.places(), step)) << "step " << step;
      }
      if (!faces.empty()) {
        const TopologyChange change = block.complex.cut(faces);
        for (const Split& split : change.splits[0])
          for (std::size_t a = 0; a < 4; ++a)
            block.rows.push_back(block.rows[4 * std::size_t{split.old_cell} + a]);
        blade.follow(block.complex, change);
        if (step > saved) twin.follow(block.complex, change);
      }
      if (step == 9 && seed % 4 == 0) {
        blade.reset();
        if (step > saved) twin.reset();
      }
      if (step == saved) load_state(state_of(blade), twin);
      if (step >= saved) {
        ASSERT_EQ(difference_of_states(blade, twin), "") << "step " << step;
      }
      for (std::size_t v = 0; v < block.rows.size(); v += 4)
        for (std::size_t a = 0; a < 3; ++a) block.rows[v + a] += 0.1 * number(random);
    }
  }
  EXPECT_GT(total, 200u);
}

TEST(MovingBlade, ExistsFromItsFirstKeyToItsLast) {
  const Block block = block_of(4, 4, 4);
  const Polyline line{{-1, 2.25, 2.25}, {5, 2.25, 2.25}};
  MovingBlade blade({{1, line}, {2, moved(line, {0, 0, 9})}});
  EXPECT_EQ(blade.begin(), 1);
  EXPECT_EQ(blade.end(), 2);
  EXPECT_TRUE(blade.advance(block.complex, block.places(), 0).empty());
  EXPECT_TRUE(blade.advance(block.complex, block.places(), 0.5).empty());
  // One step over all of its life.
  EXPECT_EQ(blade.advance(block.complex, block.places(), 7).size(), 8u);
  EXPECT_EQ(blade.at(1.5)[0], (Vec3{-1, 2.25, 6.75}));
  EXPECT_EQ(blade.box().high, (Vec3{5, 2.25, 11.25}));
}

TEST(MovingBlade, SaysWhatIsWrong) {
  const Polyline line{{0, 0, 0}, {1, 0, 0}};
  const auto error = [](std::vector<BladeKey> keys) {
    return error_of<InputError>([&] { MovingBlade blade(std::move(keys)); });
  };
  EXPECT_NE(error({}).find("no station"), std::string::npos);
  EXPECT_NE(error({{0, {{0, 0, 0}}}}).find("at least 2"), std::string::npos);
  EXPECT_NE(error({{0, line}, {1, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}}).find("the first has 2"),
            std::string::npos);
  EXPECT_NE(error({{0, line}, {0, line}}).find("station 1 of the moving blade has a time"),
            std::string::npos);
  EXPECT_NE(error({{0, {{0, 0, 0}, {0, 0, 0}}}}).find("coincident points"), std::string::npos);
  EXPECT_NE(error({{std::nan(""), line}}).find("not finite"), std::string::npos);
  MovingBlade blade({{0, line}});
  const Block block = block_of(1, 1, 1);
  blade.advance(block.complex, block.places(), 1);
  EXPECT_NE(error_of<InputError>([&] {
              blade.advance(block.complex, block.places(), 0.5);
            }).find("must not decrease"),
            std::string::npos);
}

}  // namespace
}  // namespace suture
