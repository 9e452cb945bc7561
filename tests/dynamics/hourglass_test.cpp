// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/hourglass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using namespace spring_model;
using spring_model::Body;

constexpr double edge = 0.1;  // of box()

/// Displaces every vertex by u(rest position).
template <class Displacement>
Hourglass measured(Body& body, Displacement u) {
  Attributes& all = body.attributes();
  for (Index v = 0; v < all.vertex_count(); ++v) {
    if (!body.complex().exists(0, v)) continue;
    const Vec3 x{all.rest().get(v, 0), all.rest().get(v, 1), all.rest().get(v, 2)};
    const Vec3 moved = u(x);
    for (int c = 0; c < 3; ++c)
      all.position().set(v, c, x[static_cast<std::size_t>(c)] + moved[static_cast<std::size_t>(c)]);
  }
  return measure_hourglass(body.complex(), all);
}

double largest(const std::vector<double>& values) { return *std::ranges::max_element(values); }

double sign(double x) { return std::lround(x / edge) % 2 == 0 ? 1 : -1; }

class Block : public testing::Test {
 protected:
  Block() : body(box(8, 8, 8)) {
    body.add(defaults());
    body.compile();
  }
  Body body;
};

TEST_F(Block, AConstantStrainAndARotationHaveNone) {
  const Hourglass found = measured(body, [](const Vec3& x) {
    return Vec3{0.2 * x[0] - x[1], x[0] - x[1] + 0.1 * x[2], 0.3 * x[0]};
  });
  EXPECT_GT(found.mean_strain, 0.1);
  EXPECT_LT(largest(found.amplitude), 1e-14);
  EXPECT_EQ(found.content(0), 0) << "noise";
}

// u_x = A (-1)^(j+k): the residuals are A, so a = 2 A / edge, but for what comes from the edges
// of the body, where w is 0.
TEST_F(Block, OfACheckerboardItIsTheAmplitude) {
  const double a = 1e-3;
  const Hourglass found = measured(body, [&](const Vec3& x) {
    return Vec3{a * sign(x[1]) * sign(x[2]), 0, 0};
  });
  EXPECT_LT(found.mean_strain, 1e-3 * a / edge) << "no strain";
  EXPECT_NEAR(largest(found.amplitude), 2 * a / edge, 0.1 * a / edge);
  EXPECT_GT(*std::ranges::min_element(found.amplitude), 0.4 * a / edge);
  EXPECT_GT(found.content(0), 100);
}

// Bending has the residual k x y in every element, and neighbours agree.
TEST_F(Block, SmoothBendingAndTorsionHaveNone) {
  const double k = 0.1;
  const Hourglass bent = measured(body, [&](const Vec3& x) {
    return Vec3{-k * x[0] * (x[1] - 0.4), k * x[0] * x[0] / 2, 0};
  });
  const Hourglass twisted = measured(body, [&](const Vec3& x) {
    return Vec3{0, -k * x[0] * (x[2] - 0.4), k * x[0] * (x[1] - 0.4)};
  });
  for (const Hourglass* found : {&bent, &twisted}) {
    EXPECT_GT(found->mean_strain, 1e-3);
    for (Index e = 0; e < found->amplitude.size(); ++e) EXPECT_LT(found->content(e), 0.06);
  }
}

TEST_F(Block, AWaveOfSixElementsIsNoCheckerboard) {
  const Hourglass found = measured(body, [](const Vec3& x) {
    const double phase = 2 * 3.14159265358979 / (6 * edge);
    return Vec3{0, 1e-3 * std::sin(phase * x[0]) * std::sin(phase * x[2]), 0};
  });
  for (Index e = 0; e < found.amplitude.size(); ++e) EXPECT_LT(found.content(e), 0.2);
}

TEST_F(Block, WhereACheckerboardIsTheOtherHalfIsNot) {
  const double a = 1e-3;
  const Hourglass found = measured(body, [&](const Vec3& x) {
    const double here = x[0] < 0.35 ? a : 0;
    return Vec3{here * sign(x[1]) * sign(x[2]) + 0.01 * x[0], 0, 0};
  });
  const auto& users = body.imported().user_element;
  for (Index e = 0; e < found.amplitude.size(); ++e) {
    const Index layer = users[e] % 8;
    if (layer == 0) {
      EXPECT_GT(found.content(e), 0.5) << users[e];
    }
    if (layer == 7) {
      EXPECT_LT(found.content(e), 0.05) << users[e];
    }
  }
}

TEST(Hourglass, HolesAndCutsAreBorders) {
  Body body(box(6, 6, 6));
  body.add(defaults());
  body.compile();
  body.cut_random(20, 3);
  body.pierce({5, 70});
  const Hourglass found = measured(body, [](const Vec3& x) {
    return Vec3{0.1 * x[1], 0, 0.2 * x[2]};
  });
  EXPECT_LT(largest(found.amplitude), 1e-14);
}

}  // namespace
