// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cuts along blades: geometry and map. Random sequences of planes through small boxes keep the
// volume, a closed and oriented surface, a valid map and the right pieces.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "kernel/base/error.hpp"
#include "tests/parts/cut_box.hpp"

namespace suture::test::blade_cut_test {
namespace {

using testing::HasSubstr;

/// Which island lies on which sides of the planes: points of one island are on one side of each,
/// and no two islands on the same sides of all.
void expect_right_pieces(const CutBox& box, const std::vector<PlanePatch>& planes) {
  const Parts& parts = box.parts.parts();
  std::map<Index, std::vector<int>> sides;
  const auto see = [&](Index island, const Vec3& p) {
    std::vector<int>& seen = sides.try_emplace(island, planes.size(), 0).first->second;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const double height = dot(planes[i].normal, minus(p, planes[i].point));
      if (std::abs(height) < 0.05) continue;  // corners near a plane are on it
      const int side = height > 0 ? 1 : -1;
      ASSERT_NE(seen[i], -side) << "island " << island << " is on both sides of plane " << i;
      seen[i] = side;
    }
  };
  for (Index e = 0; e < box.complex.element_count(); ++e) {
    if (!box.complex.exists(3, e)) continue;
    const Index island = box.islands.of(e);
    if (!box.part(e))
      for (const Index v : box.complex.vertices_of(e)) see(island, box.rows[v]);
  }
  for (const EmbeddedPoint& point : parts.points)
    if (box.complex.exists(3, point.element)) see(box.islands.of(point.element), box.place(point));
  std::map<std::vector<int>, Index> known;
  for (const auto& [island, seen] : sides) {
    if (std::ranges::find(seen, 0) != seen.end()) continue;  // a sliver along a plane
    const auto [at, is_new] = known.emplace(seen, island);
    EXPECT_TRUE(is_new) << "islands " << at->second << " and " << island << " are one piece";
  }
}

PlanePatch random_plane(std::mt19937_64& random, double size) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> inside(0, size);
  Vec3 n{normal(random), normal(random), normal(random)};
  n = scaled(1 / std::sqrt(dot(n, n)), n);
  return {.point = {inside(random), inside(random), inside(random)}, .normal = n};
}

/// Cuts a box by 1 to 6 planes, and checks everything after each.
void expect_sound_cuts(unsigned seed, const std::function<PlanePatch(std::mt19937_64&)>& plane) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  CutBox box({4, 4, 4});
  std::vector<PlanePatch> planes;
  for (unsigned i = 0; i < 1 + seed % 6; ++i) {
    planes.push_back(plane(random));
    box.cut(planes.back());
    ASSERT_NO_FATAL_FAILURE(expect_valid(box));
    ASSERT_NEAR(box.volume(), 64, 64e-12);
    const Embedding& embedding = box.parts.embedding(box.complex);
    ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
    ASSERT_NEAR(surface_volume(box, embedding), 64, 64e-12);
    ASSERT_NO_FATAL_FAILURE(expect_right_pieces(box, planes));
  }
}

TEST(blade_cut, random_planes_keep_volume_surface_map_and_pieces) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 2000 : 40;
  for (unsigned seed = 1; seed <= runs && !HasFatalFailure(); ++seed)
    expect_sound_cuts(seed, [](auto& random) { return random_plane(random, 4); });
}

// Many corners lie on the planes, and many sides and faces of tetrahedra.
TEST(blade_cut, planes_through_corners_keep_them_too) {
  const auto plane = [](std::mt19937_64& random) {
    std::uniform_int_distribution<int> slope(-2, 2), corner(1, 3);
    PlanePatch patch;
    for (std::size_t a = 0; a < 3; ++a) {
      patch.normal[a] = slope(random);
      patch.point[a] = corner(random);
    }
    if (dot(patch.normal, patch.normal) == 0) patch.normal = {1, 1, 1};
    return patch;
  };
  const unsigned runs = std::getenv("SUTURE_FULL") ? 2000 : 40;
  for (unsigned seed = 1; seed <= runs && !HasFatalFailure(); ++seed)
    expect_sound_cuts(seed, plane);
}

// Right through a bar along x: the section projects onto the bar's square.
void expect_lips(const Vec3& normal) {
  CutBox box({16, 4, 4});
  box.cut({.point = {8.1, 2, 2}, .normal = normal});
  EXPECT_EQ(box.islands.existing(), 2u);
  const double area = 16 * std::sqrt(dot(normal, normal)) / std::abs(normal[0]);
  EXPECT_NEAR(lip_area(box, box.parts.embedding(box.complex)) / (2 * area), 1, 0.005);
}

TEST(blade_cut, the_lips_of_an_oblique_cut_have_the_area_of_the_plane) {
  for (const double degrees : {0.0, 17.0, 30.0, 45.0, 60.0}) {
    SCOPED_TRACE(degrees);
    const double angle = degrees * 3.14159265358979323846 / 180;
    expect_lips({std::cos(angle), 0, std::sin(angle)});
  }
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> tilt(-1, 1);
    expect_lips({1, tilt(random), tilt(random)});
  }
}

TEST(blade_cut, a_plane_of_the_grid_separates_faces) {
  CutBox box({4, 4, 4});
  for (Vec3& x : box.rows) x[0] += 1e-15 * (x[1] - 2 * x[2]);
  const BladeCut cut = box.cut({.point = {2, 0, 0}, .normal = {1, 0, 0}});
  EXPECT_EQ(cut.divided, 0u);
  EXPECT_EQ(cut.cloning.cut.size(), 16u);
  EXPECT_EQ(box.complex.element_count(), 64u);
  EXPECT_EQ(box.islands.existing(), 2u);
  EXPECT_DOUBLE_EQ(lip_area(box, box.parts.embedding(box.complex)), 32);
}

TEST(blade_cut, the_same_cut_again_does_nothing) {
  CutBox box({3, 3, 3});
  const PlanePatch plane{.point = {1.4, 1.3, 1.2}, .normal = {1, 0.6, -0.3}};
  EXPECT_FALSE(box.cut(plane).empty());
  EXPECT_TRUE(box.cut(plane).empty());
}

TEST(blade_cut, elements_outside_a_polygon_stay_whole) {
  CutBox box({6, 6, 6});
  const std::vector<Vec3> polygon{{-1, -1, 2.4}, {3.5, -1, 2.4}, {3.5, 7, 2.4}, {-1, 7, 2.4}};
  const BladeCut cut = box.cut({.point = polygon[0], .normal = {0, 0, 1}, .polygon = polygon});
  EXPECT_EQ(cut.divided, 3u * 6u);  // the fourth row is crossed in part
  EXPECT_NO_THROW(box.complex.validate());
  EXPECT_EQ(box.islands.existing(), 1u);
  EXPECT_NEAR(box.volume(), 216, 1e-10);
}

// Along each axis, on either side, in both directions and nearly there: a row is not lost.
TEST(blade_cut, a_polygon_that_ends_on_grid_planes_divides_up_to_them) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double off : {0.0, 1e-14, -1e-14, 0.013, -0.013})
      for (const double height : {2.4, 2.0})
        for (const bool is_surface : {false, true}) {
          SCOPED_TRACE(std::to_string(axis) + ' ' + std::to_string(off) + ' ' +
                       std::to_string(height) + (is_surface ? " surface" : " polygon"));
          CutBox box({6, 6, 6});
          const auto at = [&](double u, double v) {
            Vec3 place;
            place[axis] = height;
            place[(axis + 1) % 3] = u;
            place[(axis + 2) % 3] = v;
            return place;
          };
          const double low = 1 - off, high = 4 + off;
          const std::vector<Vec3> polygon{at(low, low), at(high, low), at(high, high),
                                          at(low, high)};
          Vec3 normal{};
          normal[axis] = 1;
          const BladeCut cut =
              is_surface ? box.cut(SurfacePatch(
                               TriangleSurface{"square", polygon, {{0, 1, 2}, {0, 2, 3}}}))
                         : box.cut({.point = polygon[0], .normal = normal, .polygon = polygon});
          EXPECT_EQ(cut.divided + cut.cloning.cut.size(), 9u);
          EXPECT_NEAR(cut.area.opened, 9, 1e-9);
          EXPECT_NEAR(cut.area.blade, 9, 0.4);
          EXPECT_NO_THROW(box.complex.validate());
        }
}

// The opened elements are those that the disc holds, by their corners, and the area of both is
// that of the figures.
TEST(blade_cut, a_disc_says_how_much_of_it_has_been_opened) {
  for (const double height : {5.3, 5.0})
    for (const double radius : {1.5, 2.3, 4.6}) {
      SCOPED_TRACE(radius);
      CutBox box({10, 10, 10});
      const BladeCut cut =
          box.cut({.point = {5, 5, height}, .normal = {0, 0, 1}, .radius = radius});
      double whole = 0;
      for (int x = 0; x < 5; ++x)
        for (int y = 0; y < 5; ++y) whole += std::hypot(x + 1, y + 1) <= radius + 0.02 ? 4 : 0;
      if (height == 5.3) {
        EXPECT_NEAR(cut.area.opened, whole, 1e-9);
      }
      EXPECT_NEAR(cut.area.opened, double(cut.divided + cut.cloning.cut.size()), 1e-9);
      EXPECT_NEAR(cut.area.blade, 3.14159 * radius * radius, 0.06 * 3.14159 * radius * radius);
    }
}

// Discs that end inside the box and cross each other: elements around their rims are left whole.
TEST(blade_cut, random_discs_keep_volume_surface_and_map) {
  for (unsigned seed = 1; seed <= (std::getenv("SUTURE_FULL") ? 2000u : 40u) && !HasFatalFailure();
       ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    CutBox box({5, 5, 5});
    for (unsigned i = 0; i < 1 + seed % 6; ++i) {
      PlanePatch patch = random_plane(random, 5);
      patch.radius = std::uniform_real_distribution<double>(1, 4)(random);
      box.cut(patch);
      ASSERT_NO_FATAL_FAILURE(expect_valid(box));
      ASSERT_NEAR(box.volume(), 125, 125e-12);
      const Embedding& embedding = box.parts.embedding(box.complex);
      ASSERT_NEAR(surface_volume(box, embedding), 125, 125e-12);
      ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
    }
  }
}

TEST(blade_cut, cloning_refuses_what_was_not_joined) {
  CutBox box({3, 1, 1});
  const auto refuse = [&](const Cloning& cloning, const char* reason) {
    try {
      box.complex.clone_volume(cloning);
      ADD_FAILURE() << reason;
    } catch (const TopologyError& error) {
      EXPECT_THAT(error.what(), HasSubstr(reason));
    }
    box.complex.validate();
    EXPECT_EQ(box.complex.element_count(), 3u);
  };
  const Dart right = face_dart(1, 2), left = face_dart(1, 0);
  const Dart mate = box.complex.beta3(right);
  refuse({{3}, {}, {}}, "does not exist");
  refuse({{2, 1}, {}, {}}, "ascending");
  refuse({{1, 1}, {{right, mate}}, {}}, "not joined");
  refuse({{1, 1}, {{24 * 3 + local(left), mate}}, {}}, "not joined");
  refuse({{1, 1}, {{24 * 3 + local(right), mate}, {24 * 4 + local(right), mate}}, {}},
         "listed twice");
  refuse({{1, 1}, {}, {right}}, "between two elements that stay");
}

TEST(blade_cut, copies_that_stay_joined_all_around_keep_the_vertices_of_one) {
  CutBox box({3, 1, 1});
  Cloning cloning{{1}, {}, {}};
  for (const int f : {0, 2}) {
    const Dart side = face_dart(1, f);
    cloning.seams.push_back({24 * 3 + local(side), box.complex.beta3(side)});
  }
  const TopologyChange change = box.complex.clone_volume(cloning);
  box.complex.validate();
  EXPECT_TRUE(change.splits[0].empty() && change.splits[1].empty() && change.splits[2].empty());
  EXPECT_EQ(box.complex.existing(3), 3u);
  EXPECT_EQ(box.complex.count(0), 16u);
}

}  // namespace
}  // namespace suture::test::blade_cut_test
