// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/motion_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

enum class Form { linear, smooth, cubic };

MotionPath random_path(unsigned seed, Form form) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<> number(-1, 1);
  MotionPath path;
  double time = 0.5;
  for (int i = 0; i < 9; ++i) {
    MotionPath::Station& station = path.stations.emplace_back();
    station.at = time;
    time += 0.1 + std::abs(number(engine));
    for (double& place : station.place) place = i > 0 ? number(engine) : 0;
  }
  path.is_linear = form == Form::linear;
  if (form == Form::cubic) path.make_monotone();
  return path;
}

class Paths : public testing::TestWithParam<Form> {};

TEST_P(Paths, PassThroughTheirStationsAndRestOutside) {
  const MotionPath path = random_path(1, GetParam());
  for (const MotionPath::Station& station : path.stations) {
    const Placed placed = path.at(station.at);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_DOUBLE_EQ(placed.translation[c], station.place[c]);
    EXPECT_DOUBLE_EQ(placed.angle, station.place[3]);
  }
  EXPECT_EQ(path.at(0).translation, Vec3{});
  EXPECT_EQ(path.at(0).velocity, Vec3{});
  const Placed last = path.at(path.stations.back().at + 1);
  EXPECT_EQ(last.angle, path.stations.back().place[3]);
  EXPECT_EQ(last.spin, 0);
}

TEST_P(Paths, HaveTheVelocityOfTheirPlaces) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const MotionPath path = random_path(seed, GetParam());
    const double end = path.stations.back().at, d = 1e-6;
    for (double time = 0.501; time < end - d; time += 0.0171) {
      const Placed before = path.at(time - d), now = path.at(time), after = path.at(time + d);
      const bool is_corner = std::ranges::any_of(
          path.stations, [&](const auto& s) { return std::abs(s.at - time) < 2 * d; });
      if (is_corner) continue;
      EXPECT_NEAR((after.angle - before.angle) / (2 * d), now.spin, 1e-7) << seed << ", " << time;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR((after.translation[c] - before.translation[c]) / (2 * d), now.velocity[c],
                    1e-7);
    }
  }
}

TEST_P(Paths, AreNeverFasterThanTheirTopSpeed) {
  constexpr double radius = 0.3;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const MotionPath path = random_path(seed, GetParam());
    double fastest = 0;
    for (double time = 0; time < path.stations.back().at; time += 1e-3) {
      const Placed placed = path.at(time);
      fastest = std::max(fastest, norm(placed.velocity) + radius * std::abs(placed.spin));
    }
    EXPECT_LE(fastest, path.top_speed(radius) * (1 + 1e-12)) << seed;
    EXPECT_GE(fastest, 0.7 * path.top_speed(radius)) << seed;
  }
}

/// Between two stations, no component leaves the range of its two places.
TEST_P(Paths, DoNotOvershoot) {
  const MotionPath path = random_path(3, GetParam());
  for (std::size_t i = 1; i < path.stations.size(); ++i)
    for (double s = 0; s <= 1; s += 0.01) {
      const auto &a = path.stations[i - 1], &b = path.stations[i];
      const double angle = path.at(a.at + s * (b.at - a.at)).angle;
      EXPECT_GE(angle, std::min(a.place[3], b.place[3]) - 1e-12);
      EXPECT_LE(angle, std::max(a.place[3], b.place[3]) + 1e-12);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, Paths, testing::Values(Form::linear, Form::smooth, Form::cubic));

/// Where the curve is monotone, the error of the cubic falls with the square of the spacing or
/// faster.
TEST(MonotoneCubic, ConvergesToASmoothMotion) {
  const auto place = [](double t) { return (1 - std::cos(t)) / 2; };
  double errors[2];
  for (int level = 0; level < 2; ++level) {
    const int n = 10 << level;
    MotionPath path;
    for (int i = 0; i <= n; ++i) {
      const double t = M_PI * i / n;
      path.stations.push_back({t, {place(t)}, {}});
    }
    path.make_monotone();
    double& error = errors[level] = 0;
    for (double t = 0; t <= M_PI; t += 1e-3)
      error = std::max(error, std::abs(path.at(t).translation[0] - place(t)));
  }
  EXPECT_LT(errors[0], 2e-3);
  EXPECT_LT(errors[1], errors[0] / 3.5);
}

}  // namespace
}  // namespace suture
