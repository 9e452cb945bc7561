// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scenes of bodies that are made from a surface: selections, frames, what is refused.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/parts/part_materials.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/results/evidence.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/open_scene.hpp"

namespace suture {
namespace {

using test::error_of;

constexpr double radius = 1;

PluginHost& plugins() {
  static PluginHost host;
  return host;
}

/// A ball around (3, 0, 0) of elements of 0.2 m, held below z = -0.7 m.
Scene ball() {
  Scene scene;
  test::fill(scene, test::sphere_surface({3, 0, 0}, radius, 4), 0.2);
  ModelUse use;
  use.name = "tm-faure";
  use.model = &plugins().model("tm-faure");
  for (std::uint32_t p = 0; p < use.model->parameter_count; ++p)
    use.parameters.push_back(use.model->parameters[p].default_value);
  scene.models.push_back(use);
  Constraint clamp;
  clamp.where.what = Selection::HalfSpace{{0, 0, -0.7}, {0, 0, -1}};
  scene.constraints.push_back(clamp);
  scene.output.fields = {"displacement", "node_id", "element_id"};
  scene.output.surface = true;
  return scene;
}

struct Built : test::OpenScene {
  using OpenScene::OpenScene;
  Vec3 rest(Index v) {
    const Column& x = built.body().attributes().rest();
    return built.frame().in_scene({x.get(v, 0), x.get(v, 1), x.get(v, 2)});
  }
  std::vector<Index> nodes(auto where) const {
    return built.selector().vertices(in_frame(Selection{where, "/here"}, built.frame()));
  }
};

double from_centre(const Vec3& p) { return norm(minus(p, {3, 0, 0})); }

double volume_of(const Frame& frame) {
  double volume = 0;
  for (const Hexahedron& h : frame.hexahedra) {
    double box = 1;  // at rest
    for (std::size_t a = 0; a < 3; ++a) box *= frame.points[h[7]][a] - frame.points[h[0]][a];
    volume += box;
  }
  for (const auto& [a, b, c, d] : frame.tetrahedra) {
    const Vec3 &o = frame.points[a], p = minus(frame.points[b], o), q = minus(frame.points[c], o);
    volume += dot(cross(p, q), minus(frame.points[d], o)) / 6;
  }
  return volume;
}

double enclosed_by(const Frame& frame) {
  double six = 0;
  for (const SmallCell& t : frame.cells)
    six += dot(frame.points[t[0]], cross(frame.points[t[1]], frame.points[t[2]]));
  return six / 6;
}

TEST(FilledScene, FramesShowTheMaterialOnly) {
  Built ball_of(ball());
  const Frame frame = ball_of.frame(), surface = ball_of.side();
  EXPECT_GT(frame.hexahedra.size(), 100u);
  EXPECT_GT(frame.tetrahedra.size(), 1000u);
  for (const Vec3& p : frame.points) EXPECT_LT(from_centre(p), radius + 0.02 * 0.2);
  EXPECT_NEAR(volume_of(frame), 4.0 / 3 * M_PI, 0.02 * 4.0 / 3 * M_PI);
  EXPECT_NEAR(enclosed_by(surface), volume_of(frame), 1e-12);
  EXPECT_GT(surface.cells.size(), 500u);
  EXPECT_EQ(surface.cell_fields.back().name, "cut");
}

// A linear field is interpolated exactly, wherever the points are.
TEST(FilledScene, FieldsAreInterpolated) {
  Built ball_of(ball());
  Column& x = ball_of.built.body().attributes().position();
  const Column& rest = ball_of.built.body().attributes().rest();
  const auto map = [](const Vec3& p) {
    return Vec3{0.1 * p[1] + 0.2 * p[2], 0.3 * p[0], -0.1 * p[0] + 0.4 * p[2]};
  };
  const Frame before = ball_of.frame();
  for (Index v = 0; v < x.size(); ++v) {
    const Vec3 u = map(ball_of.rest(v));
    for (int a = 0; a < 3; ++a) x.set(v, a, rest.get(v, a) + u[std::size_t(a)]);
  }
  const Frame after = ball_of.frame();
  ASSERT_EQ(after.points.size(), before.points.size());
  std::size_t vertices = 0;
  for (std::size_t p = 0; p < after.points.size(); ++p) {
    const Vec3 u = map(before.points[p]);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_NEAR(after.points[p][a], before.points[p][a] + u[a], 1e-13);
      EXPECT_NEAR(after.point_fields[0].values[3 * p + a], u[a], 1e-13);
    }
    vertices += after.point_fields[1].ids[p] >= 0 ? 1 : 0;
  }
  EXPECT_LT(vertices, after.points.size());
  EXPECT_EQ(after.cell_fields[0].ids.size(), after.hexahedra.size() + after.tetrahedra.size());
}

TEST(FilledScene, NodesAreSelectedWhereTheirMaterialIs) {
  Built ball_of(ball());
  // The whole of the outside of the lattice: the nodes there stand for the surface.
  std::size_t outside = 0;
  for (const Index v : ball_of.nodes(Selection::HalfSpace{{0, 0, -0.7}, {0, 0, -1}})) {
    const Vec3 p = ball_of.rest(v);
    outside += from_centre(p) > radius ? 1 : 0;
    EXPECT_LT(p[2], -0.7 + 0.2);
    EXPECT_LT(std::hypot(p[0] - 3, p[1]), std::sqrt(1 - 0.49) + 2 * 0.2);
  }
  EXPECT_GT(outside, 10u);
  // No material is near there, though nodes are.
  const std::string error = error_of<InputError>([&] {
    ball_of.nodes(Selection::Sphere{{3 + 1.1, 0, 0}, 0.09});
  });
  const std::string start = "/here: the selection contains no node; the nodes lie in ";
  ASSERT_EQ(error.find(start), 0u) << error;
  Vec3 low, high;
  ASSERT_EQ(std::sscanf(error.c_str() + start.size(), "[%lf, %lf, %lf] to [%lf, %lf, %lf] m",
                        &low[0], &low[1], &low[2], &high[0], &high[1], &high[2]),
            6);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_NEAR(high[a] - low[a], 2 * radius, 0.1);
    EXPECT_LT(high[a] - low[a], 2 * radius + 1e-4) << "not those outside of the material";
  }
  // The nearest node is one of the material.
  const std::vector<Index> nearest = ball_of.nodes(Selection::Nearest{{3 + 1.5, 0, 0}});
  ASSERT_EQ(nearest.size(), 1u);
  EXPECT_LT(from_centre(ball_of.rest(nearest[0])), radius);
}

TEST(FilledScene, ElementsAreWhereTheCentroidsOfTheirPartsAre) {
  const Built ball_of(ball());
  const auto all = ball_of.built.selector().elements(
      in_frame(Selection{Selection::Sphere{{3, 0, 0}, radius}, "/here"}, ball_of.built.frame()));
  EXPECT_EQ(all.size(), ball_of.built.body().complex().element_count());
}

TEST(FilledScene, CutsOpenTheSurface) {
  Scene scene = ball();
  Event event;
  event.what = CutPlane{{3, 0, 0.05}, {0.2, 0.1, 1}};
  event.path = "/events/0";
  scene.events = {event};
  Built ball_of(scene);
  const double volume = volume_of(ball_of.frame());
  const std::size_t triangles = ball_of.side().cells.size();
  ball_of.events.fire(0, 0);
  const Frame surface = ball_of.side();
  const auto& cut = surface.cell_fields.back().ids;
  EXPECT_EQ(std::size_t(std::ranges::count(cut, 0)), triangles);
  EXPECT_GT(std::ranges::count(cut, 1), 100);
  EXPECT_NEAR(enclosed_by(surface), volume, 1e-12);
  EXPECT_NEAR(volume_of(ball_of.frame()), volume, 1e-12);
}

// No blade has divided an element: the lists of what blades have made are empty.
TEST(FilledScene, FacesThatWereCutAreSewn) {
  for (const Vec3& normal : {Vec3{1, 0, 0}, Vec3{0.2, 0.1, 1}}) {
    Scene scene = ball();
    Event cut, sew;
    cut.what = CutPlane{{3, 0, 0.05}, normal};
    cut.path = "/events/0";
    sew.what = SewFaces{};
    sew.path = "/events/1";
    sew.at = 1;
    scene.events = {cut, sew};
    Built ball_of(scene);
    const Frame whole = ball_of.side();
    ball_of.events.fire(0, 0);
    EXPECT_GT(ball_of.side().cells.size(), whole.cells.size());
    ball_of.events.fire(1, 1);
    const Frame sewn = ball_of.side();
    EXPECT_EQ(sewn.cells.size(), whole.cells.size());
    EXPECT_NEAR(enclosed_by(sewn), enclosed_by(whole), 1e-12);
    EXPECT_NEAR(volume_of(ball_of.frame()), enclosed_by(whole), 1e-12);
  }
}

TEST(FilledScene, EvidenceShowsTheMaterialOnlyToo) {
  const TemporaryFolder folder;
  Built ball_of(ball());
  const Frame frame = ball_of.frame();
  Column& x = ball_of.built.body().attributes().position();
  const double kept = x.get(0, 1);
  x.set(0, 1, std::nan(""));
  Evidence evidence(ball_of.built, 0.5);
  x.set(0, 1, kept);
  evidence.add_last_good(ball_of.built, 0.25);
  evidence.write(std::make_shared<OutputFolder>(folder / "out"));
  const auto is_in = [&](const std::string& text, const char* count, std::size_t value) {
    return text.find(std::string(count) + "=\"" + std::to_string(value) + '"') != std::string::npos;
  };
  for (const char* file : {"out/failed_0000.vtu", "out/failed_0001.vtu"}) {
    const std::string text = read_text(folder / file);
    EXPECT_TRUE(is_in(text, "NumberOfPoints", frame.points.size())) << file;
    EXPECT_TRUE(is_in(text, "NumberOfCells", frame.hexahedra.size() + frame.tetrahedra.size()));
  }
}

/// What comes of a body from a surface: an error, or the volume after some steps in free fall.
std::string outcome_of(const TriangleSurface& surface, double edge,
                       std::vector<Event> events = {}) {
  Scene scene = ball();
  test::fill(scene, surface, edge);
  scene.constraints.clear();
  scene.output.enabled = false;
  scene.gravity = {0, 0, -1};
  ModelUse& use = scene.models[0];
  for (std::uint32_t p = 0; p < use.model->parameter_count; ++p) {
    const std::string name = use.model->parameters[p].name;
    use.parameters[p] = name == "rho" ? 1000 : name == "E" ? 1e5 : use.parameters[p];
  }
  scene.events = std::move(events);
  Diagnostics diagnostics;
  Observer nobody;
  try {
    Simulation simulation(scene, plugins(), diagnostics);
    for (int i = 0; i < 20; ++i) simulation.advance({{}, 1}, nobody);
    const Column& v = simulation.attributes().velocity();
    for (Index i = 0; i < v.size(); ++i)
      if (!(std::abs(v.get(i, 2) + simulation.time()) < 1e-3 * simulation.time()))
        return "a node is not in free fall";
    const Parts& parts = simulation.built().parts();
    const CellComplex& complex = simulation.complex();
    double volume = 0;
    for (Index e = 0; e < complex.element_count(); ++e)
      if (complex.exists(3, e)) volume += PartMaterials(parts).moments_of(e).fraction;
    char text[40];
    std::snprintf(text, sizeof text, "runs, %.3f", volume * edge * edge * edge);
    return text;
  } catch (const InputError& error) {
    return error.what();
  }
}

TriangleSurface turned(TriangleSurface surface) {
  for (auto& t : surface.triangles) std::swap(t[0], t[1]);
  return surface;
}

TriangleSurface together(TriangleSurface one, const TriangleSurface& other) {
  const auto first = static_cast<Index>(one.points.size());
  one.points.insert(one.points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles)
    one.triangles.push_back({first + a, first + b, first + c});
  return one;
}

/// Pressed along z.
TriangleSurface pressed(TriangleSurface surface, double by) {
  for (Vec3& p : surface.points) p[2] *= by;
  return surface;
}

TEST(FilledScene, BadSurfacesAreRefusedOrRun) {
  using testing::HasSubstr;
  const TriangleSurface sound = test::sphere_surface({3, 0, 0}, 1, 3);
  const std::string runs = outcome_of(sound, 0.2);
  EXPECT_TRUE(runs.starts_with("runs, 4.")) << runs;
  EXPECT_EQ(outcome_of(turned(sound), 0.2), runs) << "inside out";
  TriangleSurface leaky = sound;
  leaky.triangles.pop_back();
  EXPECT_THAT(outcome_of(leaky, 0.2), HasSubstr("is not closed: 3 edges have a face on one side"));
  EXPECT_THAT(outcome_of(together(sound, test::sphere_surface({3.9, 0.1, 0.2}, 1, 3)), 0.2),
              HasSubstr("the surface intersects itself"));
  for (const double small : {0.001, 0.04})
    EXPECT_THAT(outcome_of(test::sphere_surface({3, 0, 0}, small, 2), 0.2),
                HasSubstr("no cube of edge 0.2 m has a corner inside the body"));
  EXPECT_THAT(outcome_of(pressed(sound, 0), 0.2), HasSubstr("is not closed"));
  for (const double by : {1e-9, 0.02, 0.05})
    EXPECT_THAT(outcome_of(pressed(sound, by), 0.2), HasSubstr("no cube of edge 0.2 m has"));
  EXPECT_THAT(outcome_of(test::sphere_surface({3, 0, 0}, 0.2, 2), 0.2), HasSubstr("runs"));
  EXPECT_THAT(outcome_of(pressed(sound, 0.15), 0.2), HasSubstr("runs"));
}

Event plane_at(double height) {
  Event event;
  event.what = CutPlane{.point = {3, 0, height}, .normal = {0, 0, 1}, .along_blade = true};
  event.path = "/events/0";
  event.at = 0;
  return event;
}

// What touches cuts nothing, and slivers do not stop a run.
TEST(FilledScene, BladesThatTouchAndSliversRun) {
  const TriangleSurface sound = test::sphere_surface({3, 0, 0}, 1, 3);
  const std::string whole = outcome_of(sound, 0.2);
  EXPECT_TRUE(whole.starts_with("runs")) << whole;
  for (const double height : {1.0, 1 - 1e-12, 0.9999, 0.995, 0.98, 0.7000001})
    EXPECT_EQ(outcome_of(sound, 0.2, {plane_at(height)}), whole) << height;
}

TEST(FilledScene, TheTimeForManyTrianglesIsSaidBeforehand) {
  PolygonSoup soup{"many.stl", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {0}};
  for (Index i = 0; i < 200000; ++i) {
    soup.corners.insert(soup.corners.end(), {0, 1, 2});
    soup.offsets.push_back(3 * i + 3);
  }
  Diagnostics diagnostics;
  EXPECT_THROW(close_surface(soup, false, diagnostics, "repair"), InputError);
  ASSERT_EQ(diagnostics.notes().size(), 1u);
  EXPECT_NE(diagnostics.notes()[0].find("faces, which takes about 1 s"), std::string::npos);
}

TEST(FilledScene, RefusesWhatDoesNotFitItsSurface) {
  const auto error = [](auto change) {
    Scene scene = ball();
    change(scene);
    return error_of<InputError>([&] { const Built built(scene); });
  };
  EXPECT_TRUE(error([](Scene&) {}).empty());
  EXPECT_TRUE(error([](Scene& scene) {
                scene.mesh.filled.reset();
                scene.mesh.box = BoxOptions{{1, 1, 1}, {2, 2, 2}};
                scene.mesh.box->origin = {0, 0, -1};
              }).starts_with("/output/surface: is for bodies with \"surface\""));
  EXPECT_TRUE(error([](Scene& scene) {
                scene.mesh.filled->size = {.edge = 5};
              }).starts_with("/mesh/surface: "));
}

}  // namespace
}  // namespace suture
