// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/pressures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "tests/forces/load_sums.hpp"

namespace {

using namespace suture;
using namespace spring_model;

/// A block of 4 x 2 x 2 cubes of 0.1 m.
class Pressed : public testing::Test {
 protected:
  std::vector<Vec3> forces(double time = 0) { return forces_of_term(body, pressures, time); }
  std::vector<Dart> end() {  // x1 sides of the last column
    std::vector<Dart> faces;
    for (const Dart d : boundary_faces(body))
      if (d % 24 == 8) faces.push_back(d);
    return faces;
  }
  template <class Place>
  void deform(Place place) {
    const Column& rest = body.attributes().rest();
    for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
      const Vec3 x = place(Vec3{rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)});
      for (int c = 0; c < 3; ++c)
        body.attributes().position().set(v, c, x[static_cast<std::size_t>(c)]);
    }
  }
  void evaluate(double time) {
    std::vector<double> rows(4 * std::size_t{body.attributes().vertex_count()});
    pressures.add_forces_in_step({time, 0.1, 0.1}, {}, rows.data());
  }
  std::vector<double> random_direction(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    std::vector<double> d(3 * std::size_t{body.attributes().vertex_count()});
    for (double& x : d) x = value(random);
    return d;
  }
  std::vector<double> product(const std::vector<double>& d) {
    std::vector<double> image(d.size());
    pressures.add_tangent(d.data(), 2, 0, 9, image.data());
    for (double& f : image) f /= 2;
    return image;
  }
  /// The derivative of the forces by central differences.
  std::vector<double> difference(const std::vector<double>& d) {
    const double h = 1e-6;
    std::vector<double> result(d.size());
    const auto move = [&](double way) {
      for (std::size_t i = 0; i < d.size(); ++i)
        body.attributes().position().rows()[i / 3 * 4 + i % 3] += way * d[i];
      return forces(9);
    };
    const auto after = move(h), before = move(-2 * h);
    move(h);
    for (std::size_t i = 0; i < d.size(); ++i)
      result[i] = (after[i / 3][i % 3] - before[i / 3][i % 3]) / (2 * h);
    return result;
  }
  static double dot_of(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  }
  Compiled body{box(4, 2, 2)};
  Pressures& pressures{body.add(std::make_unique<Pressures>(body.attributes()))};
};

TEST_F(Pressed, NothingCannotBePressed) {
  EXPECT_TRUE(pressures.adds_no_rows());
  EXPECT_FALSE(pressures.is_stiff());
  EXPECT_THROW(pressures.add(body.complex(), {}, 1, {}), InputError);
}

TEST_F(Pressed, ASidePushesInwardByItsAreaAsItIsNow) {
  pressures.add(body.complex(), end(), 100, {1, 3, false});
  EXPECT_TRUE(pressures.is_stiff()) << "it follows the surface";
  EXPECT_EQ(pressures.last_change(), 3);
  EXPECT_NEAR(sum(forces(9))[0], -100 * 0.04, 1e-13);
  EXPECT_NEAR(sum(forces(1.5))[0], -25 * 0.04, 1e-13);
  expect_the_same_at(body, pressures, 2);
  // Turned by 90 degrees about z and stretched twice along z: f turns, the area doubles.
  deform([](const Vec3& x) { return Vec3{-x[1], x[0], 2 * x[2]}; });
  const Vec3 f = sum(forces(9));
  EXPECT_NEAR(f[0], 0, 1e-13);
  EXPECT_NEAR(f[1], -100 * 0.08, 1e-13);
}

// Force -p A n and moment of each warped face against the closed forms of a bilinear patch:
//   integral of dx/dr x dx/ds = (d1 x d2) / 2, of its diagonals.
TEST_F(Pressed, AWarpedFaceHasTheAreaVectorOfItsDiagonals) {
  pressures.add(body.complex(), end(), 100, {});
  body.shake(0.02, 5);
  Vec3 expected{};
  for (const Dart d : end()) {
    std::array<Vec3, 4> x;
    for (std::size_t a = 0; a < 4; ++a)
      for (int c = 0; c < 3; ++c)
        x[a][static_cast<std::size_t>(c)] = body.attributes().position().get(
            body.complex().vertices_of(d / 24)[suture_hexahedron_faces[d % 24 / 4][a]], c);
    const Vec3 area = cross(minus(x[2], x[0]), minus(x[3], x[1]));
    for (std::size_t c = 0; c < 3; ++c) expected[c] += 100 * area[c] / 2;
  }
  if (expected[0] > 0)  // inward is against the outward normal +x
    for (double& c : expected) c = -c;
  const Vec3 f = sum(forces());
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(f[c], expected[c], 1e-13);
  EXPECT_LT(f[0], -3);
  expect_the_same_at(body, pressures, 0);
}

TEST_F(Pressed, AClosedSurfaceGivesNoResultantAndNoMoment) {
  pressures.add(body.complex(), boundary_faces(body), 1000, {});
  body.shake(0.02, 6);
  const auto f = forces();
  Vec3 moment{};
  double power = 0;
  for (Index v = 0; v < f.size(); ++v) {
    Vec3 x;
    for (int c = 0; c < 3; ++c)
      x[static_cast<std::size_t>(c)] = body.attributes().position().get(v, c);
    const Vec3 m = cross(x, f[v]);
    for (std::size_t c = 0; c < 3; ++c) moment[c] += m[c];
    power += dot(x, f[v]);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(sum(f)[c], 0, 1e-11);
    EXPECT_NEAR(moment[c], 0, 1e-11);
  }
  EXPECT_NEAR(power, -3 * 1000 * volume(body), 1e-10);
}

TEST_F(Pressed, TheTangentOnAClosedSurfaceIsTheDerivative) {
  pressures.add(body.complex(), boundary_faces(body), 1000, {1, 3, false});
  body.shake(0.02, 7);
  const std::vector<double> d = random_direction(1), image = product(d), expected = difference(d);
  ASSERT_GT(dot_of(expected, expected), 1);
  for (std::size_t i = 0; i < d.size(); ++i) EXPECT_NEAR(image[i], expected[i], 1e-6) << i;
  EXPECT_TRUE(pressures.is_conservative(9));
}

// Archimedes: a pressure that is linear in the place lifts a body by its gradient times the volume.
TEST_F(Pressed, AProfileLiftsAtRestByItsGradientTimesTheVolume) {
  const Vec3 along{0.6, 0, 0.8};
  pressures.add(body.complex(), boundary_faces(body), 50, {}, {along, {{-1, 10}, {3, -30}}});
  const Vec3 f = sum(forces());
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(f[c], 500 * along[c] * volume(body), 1e-12);
}

TEST_F(Pressed, WithAProfileTheTangentIsTheDerivative) {
  pressures.add(body.complex(), boundary_faces(body), 1000, {1, 3, false},
                {{0, 0, 1}, {{0, 2}, {0.13, 0.5}, {0.2, 1}}});
  body.shake(0.02, 7);
  const std::vector<double> d = random_direction(1), expected = difference(d);
  std::vector<double> image = product(d);
  pressures.add_skew_tangent(d.data(), 1, 9, image.data());
  ASSERT_GT(dot_of(expected, expected), 1);
  for (std::size_t i = 0; i < d.size(); ++i) EXPECT_NEAR(image[i], expected[i], 1e-6) << i;
  EXPECT_FALSE(pressures.is_conservative(9)) << "it does not follow the place";
}

TEST_F(Pressed, TheTangentUpToAFreeEdgeIsTheSymmetricPart) {
  pressures.add(body.complex(), end(), 1000, {});
  body.shake(0.02, 8);
  const std::vector<double> a = random_direction(1), b = random_direction(2);
  const double ab = dot_of(a, difference(b)), ba = dot_of(b, difference(a));
  ASSERT_GT(std::abs(ab - ba), 0.1);
  EXPECT_NEAR(dot_of(a, product(b)), (ab + ba) / 2, 1e-6);
  EXPECT_NEAR(dot_of(b, product(a)), (ab + ba) / 2, 1e-6);
  std::vector<double> whole = product(b);
  pressures.add_skew_tangent(b.data(), 1, 9, whole.data());
  EXPECT_NEAR(dot_of(a, whole), ab, 1e-6);
  EXPECT_FALSE(pressures.is_conservative(0));
  std::vector<Index> edge;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    if (const Column& x = body.attributes().rest();
        x.get(v, 1) < 0.01 || x.get(v, 1) > 0.19 || x.get(v, 2) < 0.01 || x.get(v, 2) > 0.19)
      edge.push_back(v);
  body.constraints().add(edge, 7, {}, body.attributes());
  EXPECT_TRUE(pressures.is_conservative(0)) << "its edge is held";
}

TEST_F(Pressed, TheTangentIsTheSameInSinglePrecisionAndByCells) {
  pressures.add(body.complex(), boundary_faces(body), 1000, {});
  body.shake(0.02, 9);
  const std::vector<double> d = random_direction(3), image = product(d);
  std::vector<float> narrow(d.size() / 3 * 4), single(narrow.size());  // rows of 4
  for (std::size_t i = 0; i < d.size(); ++i) narrow[i / 3 * 4 + i % 3] = static_cast<float>(d[i]);
  EXPECT_TRUE(pressures.add_tangent_in_single(narrow.data(), 1, 0, 9, single.data()));
  const std::vector<double> sum = product_by_cells(pressures, d, 9, 4);
  for (std::size_t i = 0; i < d.size(); ++i) {
    EXPECT_NEAR(single[i / 3 * 4 + i % 3], image[i], 1e-4) << i;
    EXPECT_NEAR(sum[i], image[i], 1e-11) << i;
  }
}

TEST_F(Pressed, FollowsSplitsRemovalsAndSeams) {
  pressures.add(body.complex(), end(), 100, {});
  // Cut the end apart between its columns: the corners of the faces are other vertices.
  std::vector<Dart> across;
  for (Dart d = 12; d < 24 * body.complex().element_count(); d += 24)
    if (body.complex().beta3(d) != none) across.push_back(d);
  const TopologyChange change = body.cut(across);
  ASSERT_FALSE(change.splits[0].empty());
  EXPECT_NEAR(sum(forces())[0], -4, 1e-13);
  for (const Split& s : change.splits[0])  // the mirror images carry the same
    EXPECT_NEAR(forces()[s.new_cell][0], forces()[s.old_cell][0], 1e-14);
  body.pierce({end()[0] / 24});
  EXPECT_NEAR(sum(forces())[0], -3, 1e-13);
  expect_the_same_at(body, pressures, 0);
}

TEST_F(Pressed, OfASewnFaceEndsForGood) {
  const auto seams = section(body, 0.2);
  body.cut(left_sides(seams));
  pressures.add(body.complex(), left_sides(seams), 100, {});
  EXPECT_NEAR(sum(forces())[0], -4, 1e-13);
  body.sew({seams[2]});
  EXPECT_NEAR(sum(forces())[0], -3, 1e-13);
  body.cut({seams[2].one});
  EXPECT_NEAR(sum(forces())[0], -3, 1e-13);
}

// The trapezoid in one step: mean force times way; also over a cut, which moves nothing.
TEST_F(Pressed, WorkIsByTheTrapezoid) {
  pressures.add(body.complex(), end(), 100, {});
  evaluate(0);
  deform([](const Vec3& x) { return Vec3{x[0] - 0.01, 1.5 * x[1], x[2]}; });
  evaluate(0.1);
  const double squeezed = 100 * (0.04 + 0.06) / 2 * 0.01;  // forces across y and z are none
  EXPECT_NEAR(pressures.work(), squeezed, 1e-14);
  std::vector<Dart> across;
  for (Dart d = 12; d < 24 * body.complex().element_count(); d += 24)
    if (body.complex().beta3(d) != none) across.push_back(d);
  body.cut(across);
  evaluate(0.1);
  EXPECT_NEAR(pressures.work(), squeezed, 1e-14);
  StateBuffer kept;
  kept.save(pressures);
  for (int i = 0; i < 2; ++i) {
    const double way = i == 0 ? 0.5 : 0.02;
    deform([&](const Vec3& x) { return Vec3{x[0] - 0.01 - way, 1.5 * x[1], x[2]}; });
    evaluate(0.2);
    EXPECT_NEAR(pressures.work(), squeezed + 100 * 0.06 * way, 1e-13);
    if (i == 0) kept.load(pressures);
  }
  pressures.forget_last();
  deform([](const Vec3& x) { return x; });
  evaluate(0.3);
  EXPECT_NEAR(pressures.work(), squeezed + 100 * 0.06 * 0.02, 1e-13) << "a jump";
}

}  // namespace
