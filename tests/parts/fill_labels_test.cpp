// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/fill_labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/base/vec3.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "tests/images/image_files.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/parts/filled_mesh.hpp"
#include "tests/run/open_scene.hpp"

namespace suture {
namespace {

using test::image_of;

constexpr double pi = std::numbers::pi;

struct Filled {
  Diagnostics diagnostics;
  Mesh mesh;

  Filled(const LabelImage& image, double edge)
      : mesh(fill_labels(image, {.edge = edge}, diagnostics)) {}
  const Vec3& low(Index e) const { return mesh.points[mesh.hexahedra[e][0]]; }
  bool has(const std::string& set, Index e) const {
    const auto& members = mesh.element_sets.at(set);
    return std::binary_search(members.begin(), members.end(), e);
  }
  double share(Index e) const { return test::share_of(mesh, e, "two"); }
};

/// 24 x 16 x 16 voxels of a box in 28 x 20 x 20; region 1 below i = 14.
LabelImage box() {
  return image_of({28, 20, 20}, [](double i, double j, double k) {
    const bool is_inside = i >= 2 && i < 26 && j >= 2 && j < 18 && k >= 2 && k < 18;
    return is_inside ? i < 14 ? 1 : 2 : 0;
  });
}

TEST(FillLabels, GivesVolumeAndPlaceOfABall) {
  const double radius = 20, middle = 22;
  const LabelImage ball = image_of({44, 44, 44}, [=](double i, double j, double k) {
    return std::hypot(i + 0.5 - middle, j + 0.5 - middle, k + 0.5 - middle) <= radius;
  });
  const Filled filled(ball, 3);
  const double volume = 4 * pi / 3 * radius * radius * radius;
  EXPECT_NEAR(test::volume_of(filled.mesh), volume, 0.01 * volume);
  EXPECT_EQ(filled.mesh.element_sets.at("one").size(), filled.mesh.hexahedra.size());
  EXPECT_TRUE(filled.mesh.mixtures.shares.empty());
}

// The cubes are 24 / n edges long, of which the lattice has one more around the body.
TEST(FillLabels, AnInterfaceThroughTheMiddleOfElementsGivesHalves) {
  const Filled filled(box(), 24.0 / 8.5);
  std::size_t cut = 0;
  for (Index e = 0; e < filled.mesh.hexahedra.size(); ++e) {
    const double low = filled.low(e)[0], edge = test::edge_of(filled.mesh);
    const double expected = std::clamp((low + edge - 14) / edge, 0.0, 1.0);
    EXPECT_NEAR(filled.share(e), expected, 1e-12) << "element " << e;
    cut += std::abs(expected - 0.5) < 1e-12 ? 1 : 0;
    const bool is_clear = std::abs(expected - 0.5) > 1e-9;
    EXPECT_TRUE(!is_clear || filled.has("two", e) == (expected > 0.5)) << "element " << e;
  }
  EXPECT_GT(cut, 30u);
  ASSERT_EQ(filled.diagnostics.notes().size(), 1u);
  EXPECT_NE(filled.diagnostics.notes()[0].find("elements hold more than one region"),
            std::string::npos);
}

// The box turned about z by 0.5: the interface is the plane through its middle.
TEST(FillLabels, CountsByVolumeWhereAxesAreOblique) {
  LabelImage image = box();
  const double c = std::cos(0.5), s = std::sin(0.5);
  image.steps[0] = {c, s, 0};
  image.steps[1] = {-s, c, 0};
  const Filled filled(image, 2);
  EXPECT_NEAR(test::volume_of(filled.mesh), 24 * 16 * 16, 0.02 * 24 * 16 * 16);
  const double edge = test::edge_of(filled.mesh);
  const std::vector<double> volumes = test::volumes_of_elements(filled.mesh);
  std::size_t cut = 0;
  for (Index e = 0; e < filled.mesh.hexahedra.size(); ++e) {
    if (volumes[e] < std::pow(edge, 3)) continue;
    constexpr int n = 100;
    double expected = 0;  // of the area beyond the plane
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double x = filled.low(e)[0] + edge * (i + 0.5) / n;
        const double y = filled.low(e)[1] + edge * (j + 0.5) / n;
        expected += c * x + s * y > 14 ? 1.0 / (n * n) : 0;
      }
    EXPECT_NEAR(filled.share(e), expected, 0.005) << "element " << e;
    cut += expected > 0.1 && expected < 0.9 ? 1 : 0;
  }
  EXPECT_GT(cut, 20u);
}

// Half a voxel of material may lie in elements of which the image has no voxel.
TEST(FillLabels, GivesEachElementARegion) {
  const LabelImage ball = image_of({16, 16, 16}, [](double i, double j, double k) {
    return std::hypot(i - 7.5, j - 7.5, k - 7.5) > 7 ? 0 : i < 7 ? 1 : 2;
  });
  for (const double edge : {0.4, 0.7, 1.3, 5.0}) {
    const Filled filled(ball, edge);
    EXPECT_EQ(filled.mesh.element_sets.at("one").size() + filled.mesh.element_sets.at("two").size(),
              filled.mesh.hexahedra.size())
        << edge;
  }
}

// Density is the mean by volume: the mass of a body is that of its regions, wherever the elements
// lie.
TEST(FillLabels, ElementsWeighWhatTheirRegionsWeigh) {
  static PluginHost plugins;
  const TemporaryFolder folder;
  Scene scene;
  const double radius = 15, middle = 16, height = 10;  // in voxels; of the light cap
  const auto label = [=](double i, double j, double k) {
    const double distance = std::hypot(i + 0.5 - middle, j + 0.5 - middle, k + 0.5 - middle);
    return distance > radius ? 0 : i + 0.5 < middle - radius + height ? 3 : 8;
  };
  const auto file = folder.write("a.mha", test::meta({32, 32, 32}, "ElementSpacing = 1 1 1\n",
                                                     test::voxels({32, 32, 32}, label)));
  scene.mesh.filled = FilledBody{.file = file,
                                 .is_shape = true,
                                 .labels = {{3, "light"}, {8, "heavy"}},
                                 .size = {.edge = 2.9e-3}};
  ModelUse use;
  use.name = "tm-faure";
  use.model = &plugins.model("tm-faure");
  for (std::uint32_t p = 0; p < use.model->parameter_count; ++p)
    use.parameters.push_back(use.model->parameters[p].default_value);
  CellValues& density = use.values.emplace_back();
  while (std::string(use.model->attributes[density.attribute].name) != "rho") ++density.attribute;
  density.parts = {{{Selection::Named{"light"}, ""}, {1000}},
                   {{Selection::Named{"heavy"}, ""}, {3000}}};
  scene.models.push_back(use);
  test::OpenScene open(scene);
  const Column& mass = open.built.body().attributes().mass();
  double sum = 0;
  for (Index v = 0; v < mass.size(); ++v) sum += mass.get(v, 0);
  const double cap = pi * height * height * (radius - height / 3);
  const double ball = 4 * pi / 3 * std::pow(radius, 3);
  const double expected = 1e-9 * (3000 * ball - 2000 * cap);
  EXPECT_NEAR(sum, expected, 0.01 * expected);
}

}  // namespace
}  // namespace suture
