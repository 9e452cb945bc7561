// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that are cut along blades while they move: mass, momentum, energy, forces, states.
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/embedded_parts.hpp"
#include "kernel/operations/cut_along.hpp"
#include "tests/base/same_state.hpp"
#include "tests/parts/part_body.hpp"

namespace parts_test::blade_body_test {
namespace {

using suture::dot;
using suture::minus;
using suture::norm;
using suture::PlanePatch;
using testing::HasSubstr;

constexpr double young = 1e5, density = 1000, pi = 3.14159265358979323846;

struct Law {
  const char* id;
  Values values;
  double warp = 0;  ///< how far points of the mesh are moved along each axis, in edges
};
const Values springs{{"E", young}, {"nu", 0.3}, {"rho", density}};
const Values viscous{{"K", 1e4}, {"n", 0.3}, {"lambda", 1e4}, {"rho", density}};
Values faure(int element, int quadrature = 0) {
  Values values = springs;
  values["element"] = element;
  values["quadrature"] = quadrature;
  return values;
}
const std::vector<Law> laws = {
    {"tm-faure", faure(0)},         {"tm-faure", faure(1)},      {"visco", viscous},
    {"mss-baudet", springs},        {"tm-faure", faure(0), 0.2}, {"tm-faure", faure(1), 0.2},
    {"tm-faure", faure(0, 1), 0.2}, {"visco", viscous, 0.2},     {"mss-baudet", springs, 0.2}};

/// A bar of 16 x 4 x 4 elements.
Mesh bar(double warp) {
  Mesh mesh = suture::make_box({.size = {0.8, 0.2, 0.2}, .cells = {16, 4, 4}});
  return warped(std::move(mesh), 0.05 * warp);
}

/// A bar whose elements may become parts.
struct BladeBody : PartBody {
  explicit BladeBody(const Law& law, unsigned threads = 1, bool skip = true)
      : PartBody(bar(law.warp), law.id, law.values, threads, skip, true) {
    parts.let_grow(complex());
  }
  BladeBody(BladeBody&&) = delete;

  Index cut(const PlanePatch& plane) {
    const suture::BladeCut cut = suture::cut_along(
        complex(), parts.parts(), attributes().rest().rows(), suture::PlaneBlade(plane));
    clone_volume(cut.cloning, cut.parts, [&] {
      parts.refine(cut.refined);
      parts.append(cut.parts, cut.cloning.origins);
    });
    return cut.divided;
  }
  double kinetic() {
    double sum = 0;
    for (Index v = 0; v < attributes().vertex_count(); ++v) {
      const Vec3 velocity = row(attributes().velocity(), v);
      sum += attributes().mass().get(v, 0) * dot(velocity, velocity) / 2;
    }
    return sum;
  }
  void throw_about(unsigned seed) {
    std::mt19937_64 random(seed);
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) attributes().velocity().set(v, c, between(random, -1, 1));
  }
  /// A rigid motion of every island, each its own.
  void move_islands() {
    const suture::Islands& all = islands();
    for (Index e = 0; e < complex().element_count(); ++e) {
      if (!complex().exists(3, e)) continue;
      const double angle = 0.4 * (all.of(e) + 1), c = std::cos(angle), s = std::sin(angle);
      for (const Index v : complex().vertices_of(e)) {
        const Vec3 x = rest(v);
        const Vec3 moved{c * x[0] - s * x[1] + angle, s * x[0] + c * x[1], x[2] - 3 * angle};
        for (int i = 0; i < 3; ++i) attributes().position().set(v, i, moved[std::size_t(i)]);
      }
    }
  }
  void state(suture::Archive& archive) {
    archive("body", static_cast<suture::Body&>(*this));
    archive("parts", parts);
  }

  suture::EmbeddedParts parts{suture::Parts{}};
};

PlanePatch tilted(double degrees, double x = 0.4) {
  const double angle = degrees * pi / 180;
  return {.point = {x, 0.1, 0.1}, .normal = {std::cos(angle), 0, std::sin(angle)}};
}

PlanePatch any_plane(std::mt19937_64& random) {
  return {.point = {between(random, 0.2, 0.6), 0.1, 0.1},
          .normal = {between(random, 0.3, 1), between(random, -1, 1), between(random, -1, 1)}};
}

TEST(BladeBody, KeepsMassMomentumAndKineticEnergy) {
  for (const Law& law : laws)
    for (unsigned seed = 1; seed <= 5; ++seed) {
      std::mt19937_64 random(seed);
      BladeBody body(law);
      body.throw_about(seed);
      const double mass = body.total_mass(), kinetic = body.kinetic();
      const Vec3 momentum = body.momentum();
      for (int i = 0; i < 3; ++i) {
        EXPECT_GT(body.cut(any_plane(random)), 10u);
        EXPECT_NEAR(body.total_mass() / mass, 1, 1e-12) << law.id << ", seed " << seed;
        EXPECT_NEAR(body.kinetic() / kinetic, 1, 1e-12);
        EXPECT_LT(norm(minus(body.momentum(), momentum)), 1e-12 * std::sqrt(mass * kinetic));
      }
      body.complex().validate();
    }
}

// Nothing holds the pieces together: they move as rigid bodies without energy.
TEST(BladeBody, StoresNoEnergyWhenPiecesMoveRigidly) {
  for (const Law& law : laws)
    for (const double degrees : {0.0, 30.0, 45.0, 62.0, -17.0}) {
      BladeBody body(law);
      body.cut(tilted(degrees));
      body.cut(tilted(-0.7 * degrees, 0.45));
      EXPECT_GE(body.islands().existing(), 3u);
      body.move_islands();
      const double scale = young * 0.8 * 0.2 * 0.2;
      EXPECT_LT(body.models().energy(0), 1e-12 * scale) << law.id << ' ' << degrees;
    }
}

// A cut that leaves all nodes where they are changes the stored energy only by how the law is
// integrated: not at all where the gradient is constant.
TEST(BladeBody, StoresTheEnergyOfAUniformStretchAfterACut) {
  for (const Law& law : laws) {
    if (std::string(law.id) == "mss-baudet")
      continue;  // its springs are on edges of whole elements
    SCOPED_TRACE(law.warp);
    BladeBody body(law);
    body.place([](const Vec3& x) { return Vec3{1.1 * x[0] + 0.05 * x[1], 0.95 * x[1], x[2]}; });
    const double energy = body.models().energy(0);
    ASSERT_GT(energy, 0);
    body.cut(tilted(30));
    EXPECT_NEAR(body.models().energy(0) / energy, 1, 1e-11) << law.id;
  }
}

TEST(BladeBody, HasTheTangentOfItsForces) {
  for (const Law& law : {laws[0], laws[1], laws[4], laws[5]}) {
    BladeBody body(law);
    body.cut(tilted(30));
    body.shake(0.002, 3);
    const std::size_t size = std::size_t{3} * body.attributes().vertex_count();
    std::mt19937_64 random(5);
    std::vector<double> d(size), product(size);
    for (double& value : d) value = between(random, -1, 1);
    body.add_tangent(d.data(), 1, 0, suture::TangentTime(0), product.data());
    constexpr double step = 1e-6;
    const auto moved = [&](double by) {
      for (Index v = 0; v < body.attributes().vertex_count(); ++v)
        for (int c = 0; c < 3; ++c) {
          const double x = body.attributes().position().get(v, c);
          body.attributes().position().set(v, c, x + by * d[3 * v + std::size_t(c)]);
        }
      return body.forces();
    };
    const std::vector<double> ahead = moved(step), behind = moved(-2 * step);
    double largest = 0, error = 0;
    for (std::size_t i = 0; i < size; ++i) {
      largest = std::max(largest, std::abs(product[i]));
      error = std::max(error, std::abs(product[i] - (ahead[i] - behind[i]) / (2 * step)));
    }
    ASSERT_GT(largest, 0);
    EXPECT_LT(error, 1e-5 * largest);
  }
}

TEST(BladeBody, FallsFreely) {
  for (const Law& law : laws) {
    BladeBody body(law);
    rig::Rig rig(body, {rig::euler, 0, {0, -9.81, 0}, {}});
    rig.start();
    const double dt = 0.3 * rig.stable_step();
    rig.run(dt, 10);
    body.cut(tilted(30));
    rig.run(dt, 40);
    expect_uniform_fall(rig, body.attributes().vertex_count());
  }
}

// The law is integrated again over the parts: the difference is work of the cut.
TEST(BladeBody, BooksTheJumpOfTheEnergy) {
  for (const char* scheme : rig::schemes) {
    BladeBody body(laws[0]);
    body.shake(0.004, 9);
    rig::Rig rig(body, {scheme, 0, {}, {}});
    rig.start();
    const double dt = 0.1 * rig.stable_step();
    rig.run(dt, 20);
    rig.dynamics.synchronise();
    const suture::EnergyBalance before = rig.dynamics.balance();
    body.cut(tilted(30));
    const suture::EnergyBalance after = rig.dynamics.balance();
    const double jump = after.kinetic + after.elastic - before.kinetic - before.elastic;
    EXPECT_GT(std::abs(jump), 1e-6 * before.elastic);
    EXPECT_NEAR(after.events - before.events, jump, 1e-9 * before.elastic) << scheme;
    EXPECT_NEAR(after.balance, before.balance, 1e-9 * before.elastic) << scheme;
    rig.run(dt, 200);
    EXPECT_LT(std::abs(rig.dynamics.balance().balance), 0.01 * before.elastic) << scheme;
    EXPECT_LT(norm(body.momentum()), 1e-11 * std::sqrt(2 * body.total_mass() * before.elastic));
  }
}

/// The least stable step over that of the whole bar, of random sequences of `cuts` planes.
double least_step(double warp, int cuts, unsigned sequences) {
  double least = 1;
  for (unsigned seed = 1; seed <= sequences; ++seed) {
    std::mt19937_64 random(seed);
    BladeBody body({"tm-faure", faure(static_cast<int>(seed % 2)), warp});
    rig::Rig rig(body);
    rig.start();
    const double whole = rig.stable_step();
    for (int i = 0; i < cuts; ++i) body.cut(any_plane(random));
    suture::StepLimits limits(body);
    least = std::min(least, limits.stable_step(0) / whole);
  }
  std::cout << "least stable step over that of the whole bar: " << least << '\n';
  return least;
}

TEST(BladeBody, KeepsTheStableStep) {
  const unsigned sequences = std::getenv("SUTURE_FULL") ? 500 : 6;
  EXPECT_GT(least_step(0, 6, sequences), 1 / std::sqrt(8.0));
  // A part of a distorted element sees the short edges of its corner.
  EXPECT_GT(least_step(0.2, 3, sequences), 1.0 / 8);
}

// Threads are used for loops of any size if nothing is skipped.
TEST(BladeBody, HasTheSameBitsForAnyNumberOfThreadsAndAfterLoading) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 4);
  for (const Law& law : laws)
    for (const bool skip : {true, false}) {
      BladeBody one(law, 1, skip), many(law, 3, skip), fresh(law, 2, skip);
      for (BladeBody* body : {&one, &many}) {
        body->islands();
        for (unsigned step = 1; step < 4; ++step) {
          body->shake(0.001, step);
          body->forces(0.01);
          body->models().accept();
        }
        body->cut(tilted(30));
        body->cut(tilted(-40));
      }
      suture::StateTree tree;
      suture::save_state(tree, one);
      suture::load_state(tree, fresh);
      for (BladeBody* body : {&one, &many, &fresh}) {
        body->cut(tilted(50, 0.2));
        body->complex().validate();
        body->shake(0.002, 9);
      }
      const std::vector<double> expected = one.forces(0.01);
      EXPECT_TRUE(std::ranges::any_of(expected, [](double f) { return f != 0; }));
      rig::expect_same_bits(expected, many.forces(0.01));
      rig::expect_same_bits(expected, fresh.forces(0.01));
      for (BladeBody* body : {&one, &many, &fresh}) body->models().accept();
      EXPECT_EQ(suture::difference_of_states(one, fresh), "");
      EXPECT_EQ(suture::difference_of_states(one, many), "");
    }
}

// Where a part ends does not change what is loaded: the sum of a force, and its place.
TEST(BladeBody, KeepsItsLoads) {
  BladeBody body(laws[0]);
  rig::Rig rig(body);
  std::vector<Index> all;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v) all.push_back(v);
  rig.loads.add_force(body.complex(), all, {3, -2, 1}, {});
  const auto sum = [&] {
    std::vector<double> rows(std::size_t{4} * body.attributes().vertex_count());
    rig.loads.add_forces(1, body.attributes().kernel(0).cells.live(), rows.data());
    Vec3 total{};
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (i % 4 < 3) total[i % 4] += rows[i];
    return total;
  };
  body.cut(tilted(30));
  EXPECT_LT(norm(minus(sum(), {3, -2, 1})), 1e-12);
}

TEST(BladeBody, CopiesAreHeldWhereTheirOriginsAre) {
  BladeBody body(laws[0]);
  rig::Rig rig(body);
  std::vector<Index> held;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    if (body.rest(v)[2] == 0) held.push_back(v);
  rig.hold(held, 7);
  body.cut(tilted(30));
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    EXPECT_EQ(body.attributes().fixed().get(v, 0), body.rest(v)[2] == 0 ? 7 : 0);
}

}  // namespace
}  // namespace parts_test::blade_body_test
