// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scenes with cuts along blades: frames, selections, what is refused and where.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/check_parts.hpp"
#include "kernel/parts/general_part.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "tests/parts/blade_event.hpp"
#include "tests/run/open_scene.hpp"

namespace suture::blade_scene_test {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// A bar of 8 x 2 x 2 elements of 1 m, cut at 30 degrees.
Scene bar() {
  static PluginHost plugins;
  Scene scene;
  scene.mesh.box = BoxOptions{{2, 0, 0}, {8, 2, 2}, {8, 2, 2}};
  ModelUse use;
  use.name = "tm-faure";
  use.model = &plugins.model("tm-faure");
  for (std::uint32_t p = 0; p < use.model->parameter_count; ++p)
    use.parameters.push_back(use.model->parameters[p].default_value);
  scene.models.push_back(use);
  scene.output.fields = {"displacement", "element_id"};
  scene.output.surface = true;
  scene.events = {test::divide({6, 1, 1}, {std::cos(M_PI / 6), 0, std::sin(M_PI / 6)})};
  return scene;
}

Scene ball() {
  Scene scene = bar();
  test::fill(scene, test::sphere_surface({3, 0, 0}, 1, 4), 0.2);
  scene.events = {test::divide({3, 0, 0.05}, {0.3, 0.2, 1})};
  return scene;
}

using Built = test::OpenScene;

double six_volumes(const Frame& frame) {
  double six = 0;
  for (const auto& [a, b, c, d] : frame.tetrahedra) {
    const Vec3 &o = frame.points[a], p = minus(frame.points[b], o), q = minus(frame.points[c], o);
    six += dot(cross(p, q), minus(frame.points[d], o));
  }
  return six;
}

Vec3 six_areas(const Frame& frame, const SmallCell& t) {
  const Vec3 &a = frame.points[t[0]], b = minus(frame.points[t[1]], a);
  return cross(b, minus(frame.points[t[2]], a));
}

/// Six times the volume inside, and the area of the lips.
std::pair<double, double> measures(const Frame& surface) {
  std::pair<double, double> sum{};
  const auto& cut = surface.cell_fields.back().ids;
  for (std::size_t t = 0; t < surface.cells.size(); ++t) {
    const Vec3 area = six_areas(surface, surface.cells[t]);
    sum.first += dot(surface.points[surface.cells[t][0]], area);
    if (cut[t] != 0) sum.second += norm(area) / 2;
  }
  return sum;
}

TEST(BladeScene, FramesShowPartsAndLips) {
  Built bar_of(bar());
  EXPECT_EQ(bar_of.frame().hexahedra.size(), 32u);
  const auto [volume, closed] = measures(bar_of.side());
  EXPECT_NEAR(volume, 6 * 32, 1e-10);
  EXPECT_EQ(closed, 0);
  const EventOutcome outcome = bar_of.events.fire(0, 0);
  EXPECT_EQ(outcome.text(), "cut 4 elements");
  const Frame frame = bar_of.frame();
  EXPECT_EQ(frame.hexahedra.size(), 28u);
  EXPECT_NEAR(six_volumes(frame), 6 * 4, 1e-10);
  const auto [inside, lips] = measures(bar_of.side());
  EXPECT_NEAR(inside, 6 * 32, 1e-10);
  EXPECT_NEAR(lips / (2 * 4 / std::cos(M_PI / 6)), 1, 0.005);
  // Copies have the numbers of the elements in the mesh.
  const auto& ids = frame.cell_fields[0].ids;
  ASSERT_EQ(ids.size(), frame.hexahedra.size() + frame.tetrahedra.size());
  EXPECT_LT(*std::ranges::max_element(ids), 32);
}

TEST(BladeScene, SeriesOfCutsShowLips) {
  Scene scene = bar();
  const auto [point, normal] = std::pair(Vec3{6, 1, 1}, Vec3{std::cos(M_PI / 6), 0, 0.5});
  scene.output.surface = false;
  scene.output.cuts = true;
  Built bar_of(scene);
  EXPECT_TRUE(bar_of.side().cells.empty());
  bar_of.events.fire(0, 0);
  const Frame cuts = bar_of.side();
  double area = 0;
  for (const SmallCell& t : cuts.cells) area += norm(six_areas(cuts, t)) / 2;
  EXPECT_NEAR(area / (2 * 4 / normal[0]), 1, 0.005);
  for (const Vec3& p : cuts.points) EXPECT_NEAR(dot(minus(p, point), normal), 0, 0.03);
}

TEST(BladeScene, BodiesFromSurfacesAreCutToo) {
  Built ball_of(ball());
  const auto [volume, closed] = measures(ball_of.side());
  ball_of.events.fire(0, 0);
  const auto [inside, lips] = measures(ball_of.side());
  EXPECT_NEAR(inside, volume, 1e-11 * volume);
  const double distance = 0.05 / norm(Vec3{0.3, 0.2, 1});
  EXPECT_EQ(closed, 0);
  EXPECT_NEAR(lips / (2 * M_PI * (1 - distance * distance)), 1, 0.01);
  EXPECT_EQ(ball_of.built.body().islands().existing(), 2u);
}

TEST(BladeScene, TrianglesDivideAsPlanesDo) {
  Scene scene = bar();
  CutSurface cut;
  cut.surface = std::make_shared<TriangleSurface>(test::sphere_surface({5.9, 1.1, 1}, 1.6, 4));
  cut.translation = {0.1, -0.1, 0};
  cut.along_blade = true;
  scene.events[0].what = cut;
  Built bar_of(std::move(scene));
  bar_of.events.fire(0, 0);
  EXPECT_EQ(bar_of.built.body().islands().existing(), 3u) << "two ends and what the ball takes out";
  const auto [inside, lips] = measures(bar_of.side());
  EXPECT_NEAR(inside, 6 * 32, 1e-10);
  EXPECT_GT(lips, 2 * 2 * 4);
}

// The body lies at 2 m along x; what is wrong is where the scene says it is.
TEST(BladeScene, SaysWhereABladeHasNoTwoSides) {
  Scene scene = bar();
  CutSurface cut;
  cut.along_blade = true;
  TriangleSurface fan;
  fan.points = {{6, 0, 0}, {6, 1, 0}, {6, 0, 1}, {7, 0, 1}, {5, 0, 1}};
  for (const Index i : {2, 3, 4}) fan.triangles.push_back({0, 1, i});
  cut.surface = std::make_shared<const TriangleSurface>(fan);
  scene.events[0].what = cut;
  EXPECT_THAT(error_of<InputError>([&] { Built built(scene); }),
              HasSubstr("three triangles share the edge from (6, 0, 0) to (6, 1, 0) m"));
}

TEST(BladeScene, SelectionsByNumberFindCopies) {
  Built bar_of(bar());
  const Selector& selector = bar_of.built.selector();
  const double* rows = bar_of.built.body().attributes().position().rows();
  Selection::Ids ids;
  ids.ids = {3, 4};
  EXPECT_EQ(selector.elements_now({ids, "/here"}, rows).size(), 2u);
  bar_of.events.fire(0, 0);
  rows = bar_of.built.body().attributes().position().rows();
  const std::vector<Index> found = selector.elements_now({ids, "/here"}, rows);
  EXPECT_GT(found.size(), 2u);
  for (const Index e : found) {
    EXPECT_TRUE(bar_of.built.body().complex().exists(3, e));
    EXPECT_THAT(bar_of.built.element_name(e), testing::AnyOf(3u, 4u));
  }
}

TEST(BladeScene, CopiesOfCopiesHaveTheNumberOfTheElementInTheMesh) {
  Scene scene = bar();
  scene.events.push_back(test::divide({6, 1, 1}, {1, 0.3, -0.4}));
  scene.events.push_back(test::divide({6, 1, 1}, {1, -0.7, 0.2}));
  Built bar_of(scene);
  for (std::size_t i = 0; i < 3; ++i) bar_of.events.fire(i, 0);
  Body& body = bar_of.built.body();
  StateTree tree;
  save_state(tree, body);
  Built loaded(scene);
  load_state(tree, loaded.built.body());
  std::size_t copies = 0;
  for (Index e = 0; e < body.complex().element_count(); ++e) {
    if (!body.complex().exists(3, e)) continue;
    copies += e >= 32 ? 1 : 0;
    const Index v = body.complex().vertices_of(e)[0];
    const auto at = [&](int c) { return Index(std::lround(body.attributes().rest().get(v, c))); };
    const Index number = at(0) + 8 * (at(1) + 2 * at(2));
    ASSERT_EQ(bar_of.built.element_name(e), number);
    ASSERT_EQ(loaded.built.element_name(e), number);
    ASSERT_EQ(body.user_element(e), number);
  }
  EXPECT_GT(copies, 20u);
}

TEST(BladeScene, RefusesWhatDoesNotKnowParts) {
  const auto error = [](auto change) {
    Scene scene = bar();
    change(scene);
    return error_of<InputError>([&] { const Built built(scene); });
  };
  EXPECT_THAT(error([](Scene&) {}), IsEmpty());
  EXPECT_THAT(error([](Scene& scene) { scene.contact.pieces = true; }), IsEmpty());
  EXPECT_THAT(error([](Scene& scene) {
                scene.contact.pieces = true;
                scene.solver.sleep_acceleration = 1;
              }),
              IsEmpty());
  EXPECT_THAT(error([](Scene& scene) {
                scene.events.push_back({.what = SewFaces{}, .path = "/events/1"});
              }),
              IsEmpty());
  EXPECT_THAT(error([](Scene& scene) { scene.mesh.box->grading = {1, 1, 2}; }), IsEmpty());
}

std::shared_ptr<Mesh> mesh_of_bar() {
  return std::make_shared<Mesh>(make_box({{0, 0, 0}, {8, 2, 2}, {8, 2, 2}}));
}

/// A hexagonal prism of three elements with an inner edge.
std::shared_ptr<Mesh> three_around_an_edge() {
  auto mesh = std::make_shared<Mesh>();
  for (const double z : {0.0, 1.0}) {
    mesh->points.push_back({6, 1, z});
    for (int i = 0; i < 6; ++i)
      mesh->points.push_back({6 + std::cos(i * M_PI / 3), 1 + std::sin(i * M_PI / 3), z});
  }
  for (const Index i : {1u, 3u, 5u}) {
    const Index next = i + 1, last = i == 5 ? 1 : i + 2;
    mesh->hexahedra.push_back({0, i, last, next, 7, i + 7, last + 7, next + 7});
  }
  return mesh;
}

TEST(BladeScene, RefusesMeshesThatAreNoGrid) {
  const auto error = [](std::shared_ptr<const Mesh> mesh) {
    Scene scene = bar();
    scene.mesh.box.reset();
    scene.mesh.given = std::move(mesh);
    return error_of<InputError>([&] { const Built built(scene); });
  };
  EXPECT_THAT(error(mesh_of_bar()), IsEmpty());
  auto bent = mesh_of_bar();
  bent->points[13][0] += 0.1;
  EXPECT_THAT(error(bent), IsEmpty());
  auto turned = mesh_of_bar();
  const Hexahedron h = turned->hexahedra[9];
  turned->hexahedra[9] = {h[1], h[3], h[0], h[2], h[5], h[7], h[4], h[6]};
  EXPECT_THAT(error(turned), IsEmpty());
  EXPECT_THAT(error(three_around_an_edge()), AllOf(StartsWith("/events/0/cut/along: element "),
                                                   HasSubstr("do not lie along the same axes")));
}

/// det J = 1 - 3 x 0.4 at this corner of a unit cube, and positive at the Gauss points.
constexpr Vec3 behind_its_neighbours{0.4, 0.4, 0.4};

TEST(BladeScene, RefusesElementsThatAreInvertedAtRest) {
  auto mesh = mesh_of_bar();
  mesh->points[0] = behind_its_neighbours;
  Scene scene = bar();
  scene.mesh.box.reset();
  scene.mesh.given = mesh;
  scene.mesh.import.allow_inverted_rest = true;
  EXPECT_THAT(error_of<InputError>([&] { const Built built(scene); }),
              AllOf(StartsWith("/events/0/cut/along: element 0 has a corner Jacobian <= 0"),
                    HasSubstr("cut along \"faces\"")));
}

TEST(BladeScene, PartsOfNegativeVolumeAreErrors) {
  const auto mesh = mesh_of_bar();
  std::array<Vec3, 8> rest;
  for (std::size_t n = 0; n < 8; ++n) rest[n] = mesh->points[mesh->hexahedra[0][n]];
  Parts corner;
  for (const Vec3& at : {Vec3{-1, -1, -1}, {-0.9, -1, -1}, {-1, -0.9, -1}, {-1, -1, -0.9}})
    corner.points.push_back({0, at});
  corner.tetrahedra = {{0, 1, 2, 3}};
  corner.first = {0, 1};
  EXPECT_NEAR(general_part(corner, 0, rest).fraction, 1e-3 / 48, 1e-15);
  rest[0] = behind_its_neighbours;
  EXPECT_THAT(error_of<NumericalError>([&] { general_part(corner, 0, rest); }),
              HasSubstr("of its volume at rest, expected more than 0"));
}

TEST(BladeScene, MayBeDivisibleWithoutACut) {
  Scene scene = bar();
  scene.events.clear();
  EXPECT_THAT(error_of<InputError>([&] { const Built built(scene); }),
              StartsWith("/output/surface: is for bodies with"));
  scene.is_divisible = true;
  EXPECT_NO_THROW(Built built(scene));
}

TEST(BladeScene, RefusesCutsForWhichItIsNotPrepared) {
  const Event event = test::divide({0, 0, 0}, {1, 0, 0});
  EXPECT_THAT(error_of<InputError>([&] { check_parts(event, false); }),
              StartsWith("/events/0/cut/along: the scene has no cut along a blade"));
  EXPECT_NO_THROW(check_parts(event, true));
}

}  // namespace
}  // namespace suture::blade_scene_test
