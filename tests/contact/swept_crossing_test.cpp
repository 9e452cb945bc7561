// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/swept_crossing.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

/// Places and their ways, in rows of 4.
struct Moving {
  std::vector<double> from, to;
  Index add(const Vec3& at, const Vec3& way) {
    for (std::size_t c = 0; c < 4; ++c) {
      from.push_back(c < 3 ? at[c] : 0);
      to.push_back(c < 3 ? at[c] + way[c] : 0);
    }
    return static_cast<Index>(from.size() / 4 - 1);
  }
  std::vector<Index> all() const {
    std::vector<Index> points(from.size() / 4);
    std::iota(points.begin(), points.end(), Index{0});
    return points;
  }
  SweptPlaces places() const { return {from.data(), to.data(), 1}; }
};

/// A square of 40 x 40 edges of length 1 at z = 0 that looks up, whose places move by `way`.
struct Floor : Moving {
  explicit Floor(const std::function<Vec3(const Vec3&)>& way) {
    constexpr int n = 40;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const Vec3 at{double(i), double(j), 0};
        add(at, way(at));
      }
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        const Index a = j * (n + 1) + i;
        triangles.push_back({a, a + 1, a + n + 2});
        triangles.push_back({a, a + n + 2, a + n + 1});
      }
  }
  std::optional<SweptCrossing> passed() const {
    return find_passed_triangle(places(), all(), triangles, 0.05,
                                [](Index, Index) { return true; });
  }
  std::vector<std::array<Index, 3>> triangles;
};

const Vec3 fall{3, -200, 50};

TEST(SweptCrossing, IsThatOfAPointThroughATriangle) {
  const auto passes = [](const Vec3& at, const Vec3& way) {
    Floor floor([](const Vec3&) { return fall; });
    const Index p = floor.add(at, plus(fall, way));
    const auto passed = floor.passed();
    if (passed) {
      EXPECT_EQ(passed->places[0], p);
    }
    return passed ? passed->depth : 0;
  };
  EXPECT_NEAR(passes({7.3, 8.2, 0.2}, {0, 0, -0.3}), 0.1, 1e-12);
  EXPECT_NEAR(passes({7.3, 8.2, 20}, {10, 10, -30}), 10, 1e-12) << "far and fast";
  EXPECT_NEAR(passes({-20, 8.2, 20}, {45, 0, -40}), 20, 1e-12) << "from beside the floor";
  EXPECT_EQ(passes({7.3, 8.2, 0.2}, {0, 0, -0.24}), 0) << "not deep";
  EXPECT_EQ(passes({7.3, 8.2, 0.2}, {5, 5, -0.1}), 0) << "slides in front";
  EXPECT_EQ(passes({7.3, 8.2, -0.2}, {0, 0, -3}), 0) << "was behind";
  EXPECT_EQ(passes({7.3, 8.2, -0.2}, {0, 0, 3}), 0) << "comes out";
  EXPECT_EQ(passes({-20, 8.2, 20}, {15, 0, -40}), 0) << "falls beside the floor";
}

/// The floor turns over by a quarter around x = 0: what is in its way passes it, and what only
/// meets its plane at the start or end does not.
TEST(SweptCrossing, FollowsTheTriangleOnItsWay) {
  const auto passes = [](double x, double z) {
    Floor floor([](const Vec3& at) { return Vec3{-at[0], 0, at[0]}; });
    floor.add({x, 8.2, z}, {});
    return floor.passed().has_value();
  };
  EXPECT_TRUE(passes(3.3, 3.1));
  EXPECT_TRUE(passes(18, 20.9));
  EXPECT_FALSE(passes(22, 20)) << "ways are straight: outside of the triangle swept";
  EXPECT_FALSE(passes(-1, 3));
}

/// The same points as each with each triangle.
TEST(SweptCrossing, FindsWhatASearchOfAllPairsFinds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-3, 3);
  unsigned found = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Moving soup;
    std::vector<std::array<Index, 3>> triangles;
    for (int t = 0; t < 4; ++t) {
      std::array<Index, 3> corners;
      const Vec3 at{any(random), any(random), any(random)};
      for (Index& corner : corners)
        corner = soup.add(plus(at, scaled(0.3, Vec3{any(random), any(random), any(random)})),
                          scaled(trial % 2 ? 1 : 0.1, Vec3{any(random), any(random), any(random)}));
      triangles.push_back(corners);
    }
    for (int p = 0; p < 8; ++p)
      soup.add({any(random), any(random), any(random)}, {any(random), any(random), any(random)});
    const auto yes = [](Index, Index) { return true; };
    const auto together = find_passed_triangle(soup.places(), soup.all(), triangles, 0.05, yes);
    bool alone = false;
    for (const auto& corners : triangles)
      for (const Index p : soup.all()) {
        const std::vector<Index> few{p, corners[0], corners[1], corners[2]};
        alone |= find_passed_triangle(soup.places(), few, std::vector{corners}, 0.05,
                                      [&](Index q, Index) { return q == p; })
                     .has_value();
      }
    EXPECT_EQ(together.has_value(), alone) << trial;
    found += alone;
  }
  EXPECT_GT(found, 10u);
  EXPECT_LT(found, 390u);
}

TEST(SweptCrossing, IsThatOfTwoEdges) {
  const auto passes = [](const Vec3& at, const Vec3& way) {
    Moving bars;
    const std::array<Index, 2> first{bars.add({-1, 0, 0}, fall), bars.add({1, 0, 0}, fall)};
    const Vec3 along{0.1, 1, 0.2};
    const std::array<Index, 2> second{bars.add(minus(at, along), plus(fall, way)),
                                      bars.add(plus(at, along), plus(fall, way))};
    return find_passed_edges(bars.places(), std::vector{first, second}, 0.3,
                             [](Index, Index) { return true; })
        .has_value();
  };
  EXPECT_TRUE(passes({0.2, 0, 0.5}, {0, 0, -1}));
  EXPECT_TRUE(passes({0.2, 0, 5}, {0, 0, -10}));
  EXPECT_FALSE(passes({0.2, 0, 0.5}, {0, 0, -0.6})) << "not far apart at the end";
  EXPECT_FALSE(passes({0.2, 0, 0.5}, {5, 0, -0.2})) << "passes above";
  EXPECT_FALSE(passes({1.5, 0, 0.5}, {0, 0, -1})) << "passes beside the end";
}

}  // namespace
}  // namespace suture
