// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/paper_body.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/geometry/voxelize.hpp"
#include "kernel/topology/import.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture::bench {
namespace {

using test::error_of;

Vec3 centroid(const CellComplex& complex, const std::vector<Vec3>& points, Index e) {
  Vec3 c{};
  for (const Index v : complex.vertices_of(e))
    for (int a = 0; a < 3; ++a) c[a] += points[v][a];
  return c;
}

std::size_t faces_across(const Imported& body, const Vec3& point, const Vec3& normal) {
  std::size_t count = 0;
  const auto above = [&](Index e) {
    const Vec3 c = centroid(body.complex, body.rest, e);
    double height = 0;
    for (int a = 0; a < 3; ++a) height += normal[a] * (c[a] - 8 * point[a]);
    return height >= 0;
  };
  for (Index e = 0; e < body.complex.element_count(); ++e)
    for (int f = 0; f < 6; ++f) {
      const Index n = body.complex.neighbour(e, f);
      count += n != none && e < n && above(e) != above(n) ? 1 : 0;
    }
  return count;
}

// Table 1 of Golec, Coquet, Zara and Damiand, WSCG 2015.
TEST(Body, PresetsRepeatTheTableOfThePaper) {
  const struct {
    const char* name;
    double elements, faces;
  } table[] = {{"frog", 2354, 112},
               {"elephant", 125754, 592},
               {"mushroom", 27000, 987},
               {"giraffe", 85405, 5210}};
  for (const auto& row : table) {
    SCOPED_TRACE(row.name);
    const BodyPreset& preset = body_preset(row.name);
    Diagnostics diagnostics;
    const TriangleSurface surface = generate_body(preset.parameters);
    const Mesh mesh = voxelize(surface, {.cells = preset.cells}, diagnostics);
    EXPECT_NEAR(double(mesh.hexahedra.size()), row.elements, 0.05 * row.elements);
    const Imported body = import_mesh(mesh, {}, diagnostics);
    Index islands = 0;
    body.complex.islands(&islands);
    EXPECT_EQ(islands, 1u);
    EXPECT_NEAR(double(faces_across(body, preset.cut_point, preset.cut_normal)), row.faces,
                0.05 * row.faces);
  }
}

TEST(Body, IsClosedOutwardAndTheSameEachTime) {
  const BodyParameters giraffe = body_preset("giraffe").parameters;
  const TriangleSurface surface = generate_body(giraffe);
  EXPECT_EQ(generate_body(giraffe).points, surface.points);
  Diagnostics diagnostics;
  EXPECT_EQ(close_surface(test::soup_of(surface), false, diagnostics).triangles.size(),
            surface.triangles.size());
  EXPECT_TRUE(diagnostics.warnings().empty());
  EXPECT_NEAR(test::winding(surface, {0, 0, 0}), 1, 1e-9);
  EXPECT_NEAR(test::winding(surface, {0, 0, 5}), 0, 1e-9);
}

// A torso alone is an ellipsoid: V = 4/3 pi a b c; chords of length h lose O(h^2).
TEST(Body, TorsoAloneIsAnEllipsoid) {
  const TriangleSurface surface = generate_body({.torso = {0.3, 0.2, 0.1}, .blend = 0.03}, 0.02);
  for (const Vec3& p : surface.points)
    EXPECT_NEAR(std::hypot(p[0] / 0.3, p[1] / 0.2, p[2] / 0.1), 1, 1e-4);
}

TEST(Body, SaysWhatIsWrong) {
  EXPECT_NE(error_of<UsageError>([] { body_preset("girafe"); }).find("did you mean 'giraffe'"),
            std::string::npos);
  EXPECT_NE(error_of<InputError>([] {
              generate_body({.torso = {0, 1, 1}});
            }).find("half axes"),
            std::string::npos);
  EXPECT_NE(error_of<InputError>([] { generate_body({.leg_length = -1}); }).find("lengths"),
            std::string::npos);
  EXPECT_NE(error_of<InputError>([] {
              generate_body({.tail_length = 1, .tail_radius = 0.01}, 0.1);
            }).find("would lose"),
            std::string::npos);
  // A ball of area pi, triangles of about size^2: estimated, not begun.
  const std::string error = error_of<InputError>([] {
    generate_body({.torso = {0.5, 0.5, 0.5}}, 1e-9);
  });
  EXPECT_NE(error.find("e+18, more than 50 million"), std::string::npos) << error;
}

}  // namespace
}  // namespace suture::bench
