// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts described anew: the same material in fewer tetrahedra, however many cuts and sutures have
// made it.
#include "kernel/parts/coarse_parts.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <limits>
#include <random>

#include "kernel/parts/moments.hpp"
#include "kernel/parts/part_materials.hpp"
#include "tests/parts/cut_box.hpp"

namespace suture::test::coarse_parts_test {
namespace {

constexpr std::size_t never = std::numeric_limits<std::size_t>::max();

unsigned runs(unsigned few, unsigned many) { return std::getenv("SUTURE_FULL") ? many : few; }

PlanePatch plane_near(std::mt19937_64& random, const Vec3& centre, double spread) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(-spread, spread);
  PlanePatch plane;
  plane.normal = {normal(random), normal(random), normal(random)};
  plane.normal = scaled(1 / norm(plane.normal), plane.normal);
  plane.point = plus(centre, {offset(random), offset(random), offset(random)});
  return plane;
}

std::size_t tetrahedra_of(const Parts& parts, Index element) {
  const std::size_t i = position_in(parts.elements, element);
  return i == parts.elements.size() ? 6 : parts.first[i + 1] - parts.first[i];
}

/// Of the tetrahedra of a part, which are all positive.
PartMoments moments_of(const Parts& parts, std::size_t i) {
  MomentSum sum;
  for (Index t = parts.first[i]; t < parts.first[i + 1]; ++t) {
    std::array<Vec3, 4> x;
    for (std::size_t c = 0; c < 4; ++c) x[c] = parts.points[parts.tetrahedra[t][c]].at;
    EXPECT_GT(six_volumes(x), 0);
    sum.add(x);
  }
  return sum.moments();
}

void expect_equal(const PartMoments& a, const PartMoments& b) {
  EXPECT_NEAR(a.fraction, b.fraction, 1e-12);
  for (std::size_t c = 0; c < 3; ++c) {  // integrals: slivers have uncertain means
    EXPECT_NEAR(a.fraction * a.centroid[c], b.fraction * b.centroid[c], 1e-12);
    EXPECT_NEAR(a.fraction * a.covariance[c], b.fraction * b.covariance[c], 1e-11);
  }
}

/// Valid, closed, of that volume, and with the moments of its tetrahedra.
void expect_sound(CutBox& box, double volume) {
  ASSERT_NO_FATAL_FAILURE(expect_valid(box));
  ASSERT_NEAR(box.volume(), volume, 1e-11 * volume);
  const Embedding& embedding = box.parts.embedding(box.complex);
  ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
  ASSERT_NEAR(surface_volume(box, embedding), volume, 1e-11 * volume);
  const Parts& parts = box.parts.parts();
  ASSERT_EQ(parts.cells.size(), parts.tetrahedra.size());
  for (std::size_t i = 0; i < parts.elements.size(); ++i)
    if (box.complex.exists(3, parts.elements[i]))
      expect_equal(parts.moments[i], moments_of(parts, i));
}

/// The material at points, which is there or not in each existing element.
std::vector<bool> material_at(const CutBox& box, const std::vector<Vec3>& points) {
  std::vector<bool> found;
  for (Index e = 0; e < box.complex.element_count(); ++e)
    for (const Vec3& at : points)
      found.push_back(box.complex.exists(3, e) && has_material(box.parts.parts(), e, at));
  return found;
}

// Described anew at once, bodies have the same material, lips and surface.
TEST(CoarseParts, HaveTheSameMaterialAsBefore) {
  std::size_t before = 0, after = 0;
  for (unsigned seed = 1; seed <= runs(20, 1000) && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    CutBox box({2, 2, 2});
    box.most = never;
    for (unsigned i = 0; i < 2 + seed % 4; ++i) box.cut(plane_near(random, {1, 1, 1}, 0.4));
    std::vector<Vec3> points(50);
    std::uniform_real_distribution<double> place(-1, 1);
    for (Vec3& p : points) p = {place(random), place(random), place(random)};
    const std::vector<bool> material = material_at(box, points);
    const double lips = lip_area(box, box.parts.embedding(box.complex));
    std::vector<Index> elements;
    for (const Index e : box.parts.parts().elements)
      if (box.complex.exists(3, e)) {
        elements.push_back(e);
        before += tetrahedra_of(box.parts.parts(), e);
      }
    box.parts.coarsen(box.complex, elements, 0);
    for (const Index e : elements) after += tetrahedra_of(box.parts.parts(), e);
    ASSERT_NO_FATAL_FAILURE(expect_sound(box, 8));
    EXPECT_EQ(material_at(box, points), material);
    EXPECT_NEAR(lip_area(box, box.parts.embedding(box.complex)), lips, 1e-9 * lips);
  }
  EXPECT_LT(after, before * 2 / 3);
}

/// The most tetrahedra of a part of a cube after planes.
std::size_t most_after(unsigned seed, unsigned planes,
                       const std::function<PlanePatch(std::mt19937_64&)>& plane) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  CutBox box({1, 1, 1});
  for (unsigned i = 0; i < planes; ++i) {
    box.cut(plane(random));
    expect_sound(box, 1);
    if (testing::Test::HasFatalFailure()) return 0;
  }
  std::size_t most = 0;
  for (Index e = 0; e < box.complex.element_count(); ++e)
    if (box.complex.exists(3, e)) most = std::max(most, tetrahedra_of(box.parts.parts(), e));
  return most;
}

// Tangents of a ball: what is inside stays one part, which many planes bound.
TEST(CoarseParts, GrowWithTheirFacesAlone) {
  const auto tangent = [](std::mt19937_64& random) {
    PlanePatch plane = plane_near(random, {0.5, 0.5, 0.5}, 0);
    plane.point = plus(plane.point, scaled(0.45, plane.normal));
    return plane;
  };
  for (unsigned seed = 1; seed <= runs(3, 40); ++seed)
    EXPECT_LT(most_after(seed, 12, tangent), 500u);
  EXPECT_LT(most_after(1, runs(30, 50), tangent), 4000u);
}

TEST(CoarseParts, StaySmallAfterRandomPlanes) {
  const auto plane = [](std::mt19937_64& random) {
    return plane_near(random, {0.5, 0.5, 0.5}, 0.4);
  };
  for (unsigned seed = 1; seed <= runs(3, 200); ++seed)
    EXPECT_LT(most_after(seed, 12, plane), 600u);
}

// A blade in tissue that trembles.
TEST(CoarseParts, StaySmallAfterPlanesThatAreNearlyParallel) {
  const auto plane = [](std::mt19937_64& random) {
    std::normal_distribution<double> small(0, 0.05);
    return PlanePatch{.point = {0.5 + small(random), 0.5, 0.5},
                      .normal = {1, 0.3 + small(random), 0.2 + small(random)}};
  };
  for (unsigned seed = 1; seed <= runs(5, 200); ++seed)
    EXPECT_LT(most_after(seed, 12, plane), 200u);
}

// Planes through corners, edges and the diagonal, in any order.
TEST(CoarseParts, StaySmallAfterPlanesThroughCorners) {
  const auto plane = [](std::mt19937_64& random) {
    std::uniform_int_distribution<int> slope(-2, 2), corner(0, 2);
    PlanePatch patch;
    for (std::size_t a = 0; a < 3; ++a) {
      patch.normal[a] = slope(random);
      patch.point[a] = corner(random) / 2.0;
    }
    if (dot(patch.normal, patch.normal) == 0) patch.normal = {1, 1, 1};
    return patch;
  };
  for (unsigned seed = 1; seed <= runs(5, 200); ++seed)
    EXPECT_LT(most_after(seed, 12, plane), 200u);
}

// Each suture leaves whole elements, which are no parts any more.
TEST(CoarseParts, EndWithASuture) {
  for (unsigned seed = 1; seed <= runs(1, 20) && !HasFatalFailure(); ++seed) {
    std::mt19937_64 random(seed);
    CutBox box({3, 2, 2});
    for (unsigned i = 0; i < 100; ++i) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", turn " + std::to_string(i));
      for (unsigned k = 0; k < 1 + i % 3; ++k) box.cut(plane_near(random, {1.5, 1, 1}, 0.5));
      box.sew_parts(std::vector<std::uint8_t>(box.complex.element_count(), 1));
      box.sew(seams_of_cuts(box.complex, box.point, {}).seams);
      ASSERT_NO_FATAL_FAILURE(expect_sound(box, 12));
      EXPECT_EQ(box.parts.parts().elements.size(), 0u);
      EXPECT_EQ(box.parts.parts().triangles.size(), 0u);
      EXPECT_EQ(box.complex.existing(3), 12u);
      EXPECT_EQ(lip_area(box, box.parts.embedding(box.complex)), 0);
    }
  }
}

// Only some of the parts are sewn each time.
TEST(CoarseParts, StaySmallWhereSomeAreSewn) {
  for (unsigned seed = 1; seed <= runs(3, 100) && !HasFatalFailure(); ++seed) {
    std::mt19937_64 random(seed);
    CutBox box({2, 2, 2});
    for (unsigned i = 0; i < 12; ++i) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", turn " + std::to_string(i));
      box.cut(plane_near(random, {1, 1, 1}, 0.5));
      std::vector<std::uint8_t> is_wanted;
      for (Index e = 0; e < box.complex.element_count(); ++e)
        is_wanted.push_back(random() % 3 != 0 ? 1 : 0);
      box.sew_parts(is_wanted);
      ASSERT_NO_FATAL_FAILURE(expect_sound(box, 8));
      for (const Index e : box.parts.parts().elements)
        if (box.complex.exists(3, e)) {
          EXPECT_LT(tetrahedra_of(box.parts.parts(), e), 800u);
        }
    }
  }
}

}  // namespace
}  // namespace suture::test::coarse_parts_test
