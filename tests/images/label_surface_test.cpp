// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/label_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "tests/geometry/surfaces.hpp"
#include "tests/images/image_files.hpp"

namespace suture {
namespace {

using test::image_of;

constexpr double pi = std::numbers::pi;

/// Sums over the tetrahedra between the triangles and a point.
struct Body {
  double volume = 0;
  Vec3 centre{};   ///< of mass
  Vec3 squares{};  ///< integrals of x^2, y^2, z^2 around `about`

  Body(const TriangleSurface& surface, const Vec3& about) {
    for (const Triangle& t : surface.triangles) {
      const Vec3 a = minus(surface.points[t[0]], about), b = minus(surface.points[t[1]], about),
                 c = minus(surface.points[t[2]], about);
      const double v = dot(a, cross(b, c)) / 6;
      volume += v;
      for (std::size_t r = 0; r < 3; ++r) {
        const double sum = a[r] + b[r] + c[r];
        centre[r] += v * sum / 4;
        squares[r] += v * (a[r] * a[r] + b[r] * b[r] + c[r] * c[r] + sum * sum) / 20;
      }
    }
    for (double& x : centre) x /= volume;
  }
};

/// The integral of x^2 over a ball: V r^2 / 5.
double ball_squares(double volume) { return volume * std::pow(volume * 3 / (4 * pi), 2.0 / 3) / 5; }

LabelImage ball(double radius, double width) {
  const auto n = static_cast<std::uint64_t>(width);
  return image_of({n, n, n}, [=](double i, double j, double k) {
    return std::hypot(i + 0.5 - width / 2, j + 0.5 - width / 2, k + 0.5 - width / 2) <= radius;
  });
}

TEST(LabelSurface, GivesVolumeAndMomentsOfABall) {
  for (const double radius : {5.0, 10.0, 20.0}) {
    const Vec3 middle{radius + 2, radius + 2, radius + 2};
    const LabelImage image = ball(radius, 2 * radius + 4);
    const Body body(surface_of(image), middle);
    const double volume = 4 * pi / 3 * std::pow(radius, 3);
    double voxels = 0;
    for (const auto region : image.region_of) voxels += region;
    EXPECT_NEAR(body.volume, voxels, 0.005 * voxels) << radius;
    EXPECT_NEAR(voxels, volume, 0.06 * volume) << radius;
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_NEAR(body.centre[r], 0, 1e-9) << radius;
      EXPECT_NEAR(body.squares[r], ball_squares(body.volume), 0.01 * ball_squares(body.volume))
          << radius;
    }
  }
}

// Stairs of one voxel are smoothed away: the normals of a ball point outward to within 15 degrees,
// where stairs are off by up to 55.
TEST(LabelSurface, IsSmooth) {
  const double radius = 20, half = radius + 2;
  const TriangleSurface surface = surface_of(ball(radius, 2 * half));
  double mean = 0;
  for (const Triangle& t : surface.triangles) {
    const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    const Vec3 normal = cross(minus(b, a), minus(c, a));
    const Vec3 out = minus(a, {half, half, half});
    mean += dot(normal, out) / (norm(normal) * norm(out)) / double(surface.triangles.size());
  }
  EXPECT_GT(mean, std::cos(15 * pi / 180));
}

TEST(LabelSurface, KeepsFlatSidesAndStaysWithinHalfAVoxel) {
  const auto box = [](double i, double j, double k) {
    return i > 0 && i < 21 && j > 0 && j < 21 && k > 0 && k < 21;
  };
  const TriangleSurface surface = surface_of(image_of({22, 22, 22}, box));
  for (const Vec3& p : surface.points) {
    std::size_t flat = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GE(p[a], 0.5);
      EXPECT_LE(p[a], 21.5);
      flat += p[a] > 6 && p[a] < 16 ? 1 : 0;
    }
    if (flat != 2) continue;  // the middle of a side
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_TRUE((p[a] > 6 && p[a] < 16) || std::abs(p[a] - 1) < 5e-3 ||
                  std::abs(p[a] - 21) < 5e-3)
          << p[0] << ' ' << p[1] << ' ' << p[2];
  }
}

// Voxels that touch at an edge or a corner, at the border of the image, mirrored: closed, outward.
TEST(LabelSurface, IsClosedAndOrientedOutward) {
  LabelImage image = image_of({6, 6, 6}, [](double i, double j, double k) {
    return double((int(i) * 7 + int(j) * 5 + int(k) * 3 + int(i * j)) % 3 == 0);
  });
  for (const bool is_mirrored : {false, true}) {
    if (is_mirrored) image.steps[1] = {0, -1, 0};
    const TriangleSurface surface = surface_of(image);
    std::map<std::pair<Index, Index>, int> balance;
    for (const Triangle& t : surface.triangles)
      for (std::size_t c = 0; c < 3; ++c) {
        ++balance[{t[c], t[(c + 1) % 3]}];
        --balance[{t[(c + 1) % 3], t[c]}];
      }
    for (const auto& [edge, count] : balance) EXPECT_EQ(count, 0);
    EXPECT_GT(Body(surface, {3, 0, 3}).volume, 0);
  }
}

TEST(LabelSurface, IsRefusedWithoutTheMemory) {
  EXPECT_NE(test::error_of<InputError>([] {
              surface_of(ball(5, 14), 1000);
            }).find("sides of voxels on the surface need 0 MB of memory, but 0 MB are available"),
            std::string::npos);
}

}  // namespace
}  // namespace suture
