// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tractions and pressures on the surface inside elements. SUTURE_FULL=1: the finest sphere, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/forces/dead_loads.hpp"
#include "kernel/forces/pressures.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/parts/fill_surface.hpp"
#include "tests/base/same_state.hpp"
#include "tests/forces/load_sums.hpp"
#include "tests/geometry/surfaces.hpp"
#include "tests/parts/part_body.hpp"
#include "tests/run/equilibrium.hpp"
#include "tests/run/open_scene.hpp"

namespace parts_test::surface_loads_test {
namespace {

using namespace suture;
using spring_model::forces_of_term;
using test::sphere_surface;

const Values rubber{{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}, {"element", 1}};

/// Space between two spheres.
TriangleSurface shell(double inner, double outer, int rounds) {
  TriangleSurface hollow = sphere_surface({}, inner, rounds);
  for (auto& triangle : hollow.triangles) std::swap(triangle[1], triangle[2]);
  return test::joined(sphere_surface({}, outer, rounds), hollow);
}

TriangleSurface turned(TriangleSurface surface, double angle) {
  for (Vec3& p : surface.points) {
    const double s = std::sin(angle), c = std::cos(angle);
    p = {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
    p = {p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]};
  }
  return surface;
}

struct Filled : PartBody {
  explicit Filled(const TriangleSurface& surface, double edge, const Values& values = rubber)
      : Filled(fill(surface, edge), values) {}
  Filled(const Mesh& mesh, const Values& values)
      : PartBody(mesh, "tm-faure", values),
        embedding(renumbered(mesh.parts, imported().element_of), complex()) {
    for (Index t = 0; t < embedding.triangles.size(); ++t)
      triangles.push_back(surface_triangle(embedding, t, complex()));
  }
  static Mesh fill(const TriangleSurface& surface, double edge) {
    Diagnostics diagnostics;
    return fill_surface(surface, {.edge = edge}, diagnostics);
  }
  SurfacePressures& press(double pressure, std::size_t first = 0) {
    auto& pressures = add(std::make_unique<SurfacePressures>(attributes()));
    pressures.add(complex(), std::span(triangles).subspan(first), pressure, {});
    return pressures;
  }
  /// The area vector of triangle t at rest, flat.
  Vec3 area(Index t) {
    std::array<Vec3, 3> x;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        x[i][c] =
            embedding.points.value(embedding.triangles[t][i], attributes().rest().rows(), 4, c);
    return scaled(0.5, cross(minus(x[1], x[0]), minus(x[2], x[0])));
  }
  double power(const std::vector<Vec3>& forces, const std::vector<Vec3>& d) const {
    double sum = 0;
    for (std::size_t v = 0; v < forces.size(); ++v) sum += dot(forces[v], d[v]);
    return sum;
  }
  std::vector<Vec3> places() {
    std::vector<Vec3> x;
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      x.push_back(row(attributes().position(), v));
    return x;
  }
  void move(double way, const std::vector<Vec3>& d) {
    for (std::size_t v = 0; v < d.size(); ++v)
      for (std::size_t c = 0; c < 3; ++c)
        attributes().position().rows()[4 * v + c] += way * d[v][c];
  }
  std::vector<Vec3> random_direction(unsigned seed) {
    std::mt19937_64 random(seed);
    std::vector<Vec3> d(attributes().vertex_count());
    for (Vec3& of : d)
      for (double& c : of) c = between(random, -1, 1);
    return d;
  }
  /// The derivative of the forces in a direction, by central differences.
  std::vector<Vec3> difference(ForceTerm& term, const std::vector<Vec3>& d) {
    const double h = 1e-5;
    move(h, d);
    std::vector<Vec3> result = forces_of_term(*this, term, 0);
    move(-2 * h, d);
    const std::vector<Vec3> before = forces_of_term(*this, term, 0);
    move(h, d);
    for (std::size_t v = 0; v < d.size(); ++v)
      result[v] = scaled(1 / (2 * h), minus(result[v], before[v]));
    return result;
  }

  Embedding embedding;
  std::vector<SurfaceTriangle> triangles;
};

std::vector<double> flat(const std::vector<Vec3>& of) {
  std::vector<double> numbers;
  for (const Vec3& v : of) numbers.insert(numbers.end(), v.begin(), v.end());
  return numbers;
}

/// Shells and boxes at an angle, shaken by a tenth of an edge.
class Shaken : public testing::Test {
 protected:
  Shaken() { body.shake(0.02, 3); }
  Filled body{shell(0.5, 1, 2), 0.2};
};

TEST_F(Shaken, APressureAllAroundHasNoResultantAndNoMoment) {
  SurfacePressures& pressures = body.press(1000);
  const auto f = forces_of_term(body, pressures, 0);
  const auto x = body.places();
  Vec3 total{}, moment{};
  double size = 0;
  for (std::size_t v = 0; v < f.size(); ++v) {
    total = plus(total, f[v]);
    moment = plus(moment, cross(x[v], f[v]));
    size += norm(f[v]);
  }
  ASSERT_GT(size, 1000);
  EXPECT_LT(norm(total), 1e-12 * size);
  EXPECT_LT(norm(moment), 1e-12 * size);
  spring_model::expect_the_same_at(body, pressures, 0);
}

// With E = p V and V = - sum f . x / 3 p, of a closed surface.
TEST_F(Shaken, ForcesAreTheGradientOfTheEnclosedVolume) {
  SurfacePressures& pressures = body.press(1000);
  const auto d = body.random_direction(1);
  const auto energy = [&] {
    return -body.power(forces_of_term(body, pressures, 0), body.places()) / 3;
  };
  const double h = 1e-5;
  body.move(h, d);
  const double after = energy();
  body.move(-2 * h, d);
  const double before = energy();
  body.move(h, d);
  const double power = body.power(forces_of_term(body, pressures, 0), d);
  ASSERT_GT(std::abs(power), 1);
  EXPECT_NEAR((after - before) / (2 * h), -power, 1e-6 * std::abs(power));
  body.place([](const Vec3& x) { return x; });
  double volume = 0;
  for (Index e = 0; e < body.complex().element_count(); ++e)
    volume += body.attributes().rest_places(body.complex()).volume(e);
  EXPECT_NEAR(energy() / 1000, volume, 1e-10);
}

TEST_F(Shaken, TheTangentIsTheDerivative) {
  SurfacePressures& pressures = body.press(1000);
  const auto d = body.random_direction(2);
  const std::vector<double> expected = flat(body.difference(pressures, d)), dx = flat(d);
  const std::vector<double> by_cells = spring_model::product_by_cells(pressures, dx, 0, 8);
  std::vector<double> image(dx.size());
  pressures.add_tangent(dx.data(), 1, 0, 0, image.data());
  double largest = 0;
  for (std::size_t i = 0; i < dx.size(); ++i) {
    largest = std::max(largest, std::abs(expected[i]));
    EXPECT_NEAR(image[i], expected[i], 1e-6) << i;
    EXPECT_NEAR(by_cells[i], expected[i], 1e-6) << i;
  }
  EXPECT_GT(largest, 1);
  EXPECT_TRUE(pressures.is_conservative(0));
}

TEST_F(Shaken, UpToAFreeEdgeTheTangentHasTwoParts) {
  SurfacePressures& pressures = body.press(1000, body.triangles.size() / 2);
  const auto d = body.random_direction(4);
  const std::vector<double> expected = flat(body.difference(pressures, d)), dx = flat(d);
  std::vector<double> image(dx.size());
  pressures.add_tangent(dx.data(), 1, 0, 0, image.data());
  double skew = 0;
  for (std::size_t i = 0; i < dx.size(); ++i) skew += std::abs(image[i] - expected[i]);
  EXPECT_GT(skew, 1);
  pressures.add_skew_tangent(dx.data(), 1, 0, image.data());
  for (std::size_t i = 0; i < dx.size(); ++i) EXPECT_NEAR(image[i], expected[i], 1e-6) << i;
  EXPECT_FALSE(pressures.is_conservative(0));
}

TEST_F(Shaken, FollowsSplitsAndRemovalsAndIsSaved) {
  SurfacePressures& pressures = body.press(1000);
  const double whole = body.power(forces_of_term(body, pressures, 0), body.places());
  ASSERT_FALSE(body.cut(body.inner_faces()).splits[0].empty());
  const auto apart = forces_of_term(body, pressures, 0);
  EXPECT_NEAR(body.power(apart, body.places()), whole, 1e-9) << "in pieces";
  std::vector<Index> without{body.triangles.front().element, body.triangles.back().element};
  body.pierce(without);
  const auto fewer = forces_of_term(body, pressures, 0);
  std::vector<SurfaceTriangle> remaining = body.triangles;
  std::erase_if(remaining, [&](const SurfaceTriangle& t) {
    return std::ranges::find(without, t.element) != without.end();
  });
  ASSERT_LT(remaining.size(), body.triangles.size());
  SurfacePressures again(body.attributes());
  again.add(body.complex(), remaining, 1000, {});
  EXPECT_EQ(forces_of_term(body, again, 0), fewer);
  StateTree tree;
  save_state(tree, pressures);
  SurfacePressures loaded(body.attributes());
  loaded.add(body.complex(), std::span(body.triangles).first(1), 1000, {});
  load_state(tree, loaded);
  EXPECT_EQ(forces_of_term(body, loaded, 0), fewer);
}

// Archimedes, and the same profile of a traction: the area times the factor at the centroid.
TEST(SurfaceLoads, FollowAProfile) {
  const Vec3 along{0.6, 0, 0.8};
  const LoadProfile profile{along, {{-2, 6}, {2, -2}}};  // 2 - 2 s
  Filled body(turned(test::box_surface({}, {1, 0.7, 0.8}), 0.4), 0.15);
  auto& pressures = body.add(std::make_unique<SurfacePressures>(body.attributes()));
  pressures.add(body.complex(), body.triangles, 50, {}, profile);
  Vec3 lift{}, force{}, expected{};
  for (const Vec3& f : forces_of_term(body, pressures, 0)) lift = plus(lift, f);
  double volume = 0;
  const RestPlaces rest = body.attributes().rest_places(body.complex());
  for (Index e = 0; e < body.complex().element_count(); ++e) volume += rest.volume(e);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(lift[c], 100 * along[c] * volume, 1e-11);
  auto& loads = body.add(std::make_unique<DeadLoads>(body.attributes()));
  loads.add_surface_traction(body.complex(), body.triangles, {0, 7, 0}, {}, profile);
  for (const Vec3& f : forces_of_term(body, loads, 0)) force = plus(force, f);
  for (Index t = 0; t < body.triangles.size(); ++t) {
    Vec3 centroid{};
    for (const Index corner : body.embedding.triangles[t])
      for (std::size_t c = 0; c < 3; ++c)
        centroid[c] +=
            body.embedding.points.value(corner, body.attributes().rest().rows(), 4, c) / 3;
    expected[1] += 7 * norm(body.area(t)) * profile(centroid);
  }
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(force[c], expected[c], 1e-11);
}

// Tractions P N on the whole surface are in balance with the stress P of a uniform gradient: every
// node inside and outside the material is, up to rounding.
TEST(SurfaceLoads, PassThePatchTest) {
  for (const int element : {0, 1}) {
    Values values = rubber;
    values["element"] = element;
    values["nu"] = 0;
    Filled body(turned(test::box_surface({}, {1, 0.7, 0.8}), 0.4), 0.15, values);
    const Matrix stress = stress_of(stretched, 1e5, 0);
    auto& loads = body.add(std::make_unique<DeadLoads>(body.attributes()));
    for (Index t = 0; t < body.triangles.size(); ++t)
      if (const Vec3 area = body.area(t); norm(area) > 0)
        loads.add_surface_traction(body.complex(), std::span(body.triangles).subspan(t, 1),
                                   mapped(stress, scaled(1 / norm(area), area)), {});
    body.place([&](const Vec3& x) { return mapped(stretched, x); });
    const std::vector<double> inner = body.forces();
    const auto outer = forces_of_term(body, loads, 0);
    double largest = 0, worst = 0;
    for (std::size_t i = 0; i < inner.size(); ++i) {
      largest = std::max(largest, std::abs(inner[i]));
      worst = std::max(worst, std::abs(inner[i] + outer[i / 3][i % 3]));
    }
    EXPECT_GT(largest, 10);
    EXPECT_LT(worst, 1e-12 * largest) << element;
  }
}

// ------------------------------------------------------------------- scenes --

PluginHost& host() {
  static PluginHost plugins;
  return plugins;
}

Scene scene_of(const TriangleSurface& surface, double edge, const Values& values) {
  Scene scene = test::block(host(), "tm-faure", {1, 1, 1}, {1, 1, 1}, values);
  test::fill(scene, surface, edge);
  return scene;
}

Load& press(Scene& scene, const Selection& where, double pressure) {
  Load& load = scene.loads.emplace_back();
  load.kind = Load::Kind::pressure;
  load.pressure = pressure;
  load.where = where;
  load.ramp = {0, 1, false};
  return load;
}

Selection nearest(const Vec3& point) {
  Selection selection;
  selection.what = Selection::Nearest{point};
  return selection;
}

/// The rigid motions, by three nodes near these points on a ring of this radius.
void hold_in_place(Scene& scene, double r) {
  test::hold(scene, nearest({r, 0, 0}), 7);
  test::hold(scene, nearest({-r, 0, 0}), 6);
  test::hold(scene, nearest({0, r, 0}), 4);
}

/// The error of the compliance of a thick sphere under pressure inside, beside
/// Lame's solution: u(a) = p a ((1 - 2 nu) a^3 + (1 + nu) b^3 / 2) / E (b^3 - a^3).
double error_of_thick_sphere(double edge, int element) {
  const double a = 0.5, b = 1, young = 1e5, nu = 0.3, p = 1e-3;
  Scene scene = scene_of(shell(a, b, 5), edge,
                         {{"E", young}, {"nu", nu}, {"rho", 1000}, {"element", double(element)}});
  Selection inside;
  inside.what = Selection::Sphere{{}, (a + b) / 2};
  press(scene, inside, p);
  hold_in_place(scene, (a + b) / 2);
  const double opened = p * a * ((1 - 2 * nu) * a * a * a + (1 + nu) * b * b * b / 2) / young /
                        (b * b * b - a * a * a);
  return test::Equilibrium(scene).energy() / (p * 4 * M_PI * a * a * opened / 2) - 1;
}

TEST(SurfaceLoads, ThickSpheresFollowLameWithOrderTwo) {
  for (const int element : {0, 1}) {
    const double coarse = error_of_thick_sphere(1. / 8, element),
                 fine = error_of_thick_sphere(1. / 16, element);
    RecordProperty("errors_" + std::to_string(element),
                   std::to_string(coarse) + " " + std::to_string(fine));
    EXPECT_LT(std::abs(coarse), 0.050) << element;
    EXPECT_LT(std::abs(fine), 0.012) << element;
    if (std::getenv("SUTURE_FULL") == nullptr) continue;
    const double finest = error_of_thick_sphere(1. / 32, element);
    RecordProperty("finest_" + std::to_string(element), std::to_string(finest));
    EXPECT_LT(std::abs(finest), 0.003) << element;
  }
}

// Whatever its shape, a body under pressure all around has a uniform stress.
TEST(SurfaceLoads, ABodyUnderWaterIsCompressedUniformly) {
  const double young = 1e5, nu = 0.3, p = 2e4;
  Scene scene = scene_of(turned(test::box_surface({-0.5, -0.35, -0.4}, {0.5, 0.35, 0.4}), 0.4),
                         0.15, {{"E", young}, {"nu", nu}, {"rho", 1000}, {"element", 1}});
  press(scene, {}, p);
  hold_in_place(scene, 0.3);
  test::Equilibrium body(scene);
  // -p = S / l with S = E (l^2 - 1) / 2 (1 - 2 nu), the stress of a stretch l.
  const double c = 2 * (1 - 2 * nu) * p / young, stretch = (-c + std::sqrt(c * c + 4)) / 2;
  ASSERT_LT(stretch, 0.95);
  const Column& rest = body.body().attributes().rest();
  const Column& x = body.body().attributes().position();
  const auto difference = [](const Column& of, Index v) {
    return Vec3{of.get(v, 0) - of.get(0, 0), of.get(v, 1) - of.get(0, 1),
                of.get(v, 2) - of.get(0, 2)};
  };
  for (Index v = 1; v < x.size(); ++v)
    EXPECT_NEAR(norm(difference(x, v)), stretch * norm(difference(rest, v)), 1e-8) << v;
}

TEST(SurfaceLoads, AreSelectedWhereTheSurfaceIs) {
  const auto total = [](const auto& where, const char* path) {
    Scene scene = scene_of(sphere_surface({}, 1, 4), 0.125, rubber);
    test::load(scene, {where, path}, {0, 0, 100});
    Diagnostics diagnostics;
    BuiltScene built(scene, diagnostics);
    Vec3 sum{};
    for_each_with<EnergyTerm>(built.body().terms(), [&](auto& term) {
      if (auto* loads = dynamic_cast<DeadLoads*>(&term))
        sum = spring_model::sum(forces_of_term(built.body(), *loads, 1));
    });
    return sum[2];
  };
  EXPECT_NEAR(total(Selection::All{}, "/loads/0/where"), 100 * 4 * M_PI, 0.01 * 400 * M_PI);
  const double cap = 2 * M_PI * 0.25, rim = 2 * M_PI * std::sqrt(1 - 0.75 * 0.75) * 0.125;
  const double loaded = total(Selection::HalfSpace{{0, 0, 0.75}, {0, 0, 1}}, "/loads/0/where");
  EXPECT_LT(loaded, 100 * cap);
  EXPECT_GT(loaded, 100 * (cap - rim));
  EXPECT_EQ(test::error_of<InputError>([&] {
              total(Selection::Sphere{{}, 0.9}, "/loads/0/where");
            }).find("/loads/0/where: the selection contains no triangle of the surface"),
            0u);
}

}  // namespace
}  // namespace parts_test::surface_loads_test
