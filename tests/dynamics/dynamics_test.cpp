// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "kernel/attributes/shape.hpp"
#include "kernel/dynamics/rest_search.hpp"
#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using spring_model::Body;
using Scheme = DynamicsOptions::Scheme;

BoxOptions box(Index x, Index y, Index z) {
  BoxOptions options;
  options.cells = {x, y, z};
  options.size = {0.1 * x, 0.1 * y, 0.1 * z};
  return options;
}

std::vector<Index> vertices_at(Body& body, int axis, double where) {
  std::vector<Index> found;
  for (Index v = 0; v < body.attributes->vertex_count(); ++v)
    if (std::abs(body.attributes->rest().get(v, axis) - where) < 1e-9) found.push_back(v);
  return found;
}

/// One cube between two plates that move along x only: four springs of k/4 in
/// parallel and two lumped plates, an oscillator with a closed form.
///   mass of a plate M = rho V / 2, stiffness K = k (4 edges x 1/4),
///   the other plate held: omega^2 = K / M
struct Oscillator {
  explicit Oscillator(const DynamicsOptions& options) : body(box(1, 1, 1)) {
    auto parameters = spring_model::defaults();
    parameters[spring_model::diagonal_stiffness] = 0;
    body.add(parameters);
    body.initialise();
    dynamics = std::make_unique<Dynamics>(*body.attributes, body.mesh.complex, options);
    dynamics->constraints().add(vertices_at(body, 0, 0), 7, {}, *body.attributes);
    moving = vertices_at(body, 0, 0.1);
    dynamics->constraints().add(moving, 6, {}, *body.attributes);
  }
  double displacement() const {
    return body.attributes->position().get(moving[0], 0) -
           body.attributes->rest().get(moving[0], 0);
  }
  double velocity() const { return body.attributes->velocity().get(moving[0], 0); }
  void displace(double u) {
    for (const Index v : moving) body.attributes->position().set(v, 0, 0.1 + u);
  }

  static constexpr double mass = 1000 * 1e-3 / 2, stiffness = 100;
  static double omega() { return std::sqrt(stiffness / mass); }
  Body body;
  std::unique_ptr<Dynamics> dynamics;
  std::vector<Index> moving;
};

void run(Dynamics& dynamics, double dt, int steps) {
  for (int i = 0; i < steps; ++i) dynamics.step(dt, (i + 1) * dt);
}

/// Error after one second of u'' + alpha u' + omega^2 u = g, from rest at u0.
double error_after_a_second(Scheme scheme, double alpha, double gravity, int steps) {
  DynamicsOptions options;
  options.scheme = scheme;
  options.damping = alpha;
  options.gravity = {gravity, 0, 0};
  Oscillator o(options);
  const double u0 = 1e-3;
  o.displace(u0);
  o.dynamics->start();
  run(*o.dynamics, 1.0 / steps, steps);
  o.dynamics->synchronise();
  const double w2 = Oscillator::omega() * Oscillator::omega(), shift = gravity / w2;
  const double wd = std::sqrt(w2 - alpha * alpha / 4), decay = std::exp(-alpha / 2);
  const double c = std::cos(wd), s = std::sin(wd), a = u0 - shift;
  const double u = shift + a * decay * (c + alpha / (2 * wd) * s);
  const double v = -a * decay * w2 / wd * s;
  return std::hypot(o.displacement() - u, (o.velocity() - v) / Oscillator::omega()) / u0;
}

TEST(Integrators, ConvergeWithTheirOrderToTheDampedOscillator) {
  for (const double alpha : {0.0, 1.5, 6.0}) {
    const double verlet = error_after_a_second(Scheme::velocity_verlet, alpha, 0.05, 200);
    const double finer = error_after_a_second(Scheme::velocity_verlet, alpha, 0.05, 400);
    EXPECT_LT(verlet, 5e-3);
    EXPECT_NEAR(verlet / finer, 4, 0.2) << "alpha " << alpha;
    const double euler = error_after_a_second(Scheme::symplectic_euler, alpha, 0.05, 400);
    EXPECT_NEAR(euler / error_after_a_second(Scheme::symplectic_euler, alpha, 0.05, 800), 2, 0.2)
        << "alpha " << alpha;
  }
}

TEST(Integrators, AreStableForAnyMassDamping) {
  for (const auto scheme : {Scheme::symplectic_euler, Scheme::velocity_verlet})
    for (const double alpha : {10.0, 1e3, 1e6}) {
      DynamicsOptions options;
      options.scheme = scheme;
      options.damping = alpha;
      options.gravity = {0.1, 0, 0};
      Oscillator o(options);
      o.dynamics->start();
      run(*o.dynamics, 1.9 / Oscillator::omega(), 3000);
      EXPECT_LT(std::abs(o.displacement()), 2.1 * 0.1 / std::pow(Oscillator::omega(), 2));
      EXPECT_GE(o.displacement(), 0);
    }
}

/// formulas.md 2: stable iff omega dt < 2 (sqrt(zeta^2 + 1) - zeta).
TEST(Integrators, AreStableUpToTheBoundAndNoFurther) {
  for (const auto scheme : {Scheme::symplectic_euler, Scheme::velocity_verlet})
    for (const double zeta : {0.0, 1.0, std::sqrt(2.0), 3.0})
      for (const double factor : {0.98, 1.02}) {
        DynamicsOptions options;
        options.scheme = scheme;
        auto parameters = spring_model::defaults();
        parameters[spring_model::diagonal_stiffness] = 0;
        // c per edge; four edges in parallel on two... one plate of mass M.
        parameters[spring_model::edge_damping] =
            2 * zeta * Oscillator::omega() * Oscillator::mass / 4;
        Body damped(box(1, 1, 1));
        damped.add(parameters);
        damped.initialise();
        Dynamics dynamics(*damped.attributes, damped.mesh.complex, options);
        dynamics.constraints().add(vertices_at(damped, 0, 0), 7, {}, *damped.attributes);
        const auto moving = vertices_at(damped, 0, 0.1);
        dynamics.constraints().add(moving, 6, {}, *damped.attributes);
        for (const Index v : moving) damped.attributes->position().set(v, 0, 0.1 + 1e-9);
        dynamics.start();
        const double limit = 2 * (std::sqrt(zeta * zeta + 1) - zeta) / Oscillator::omega();
        run(dynamics, factor * limit, 500);
        const double u = std::abs(damped.attributes->position().get(moving[0], 0) - 0.1);
        if (factor < 1)
          EXPECT_LT(u, 1e-7) << zeta;
        else
          EXPECT_GT(u, 1e-6) << zeta;
      }
}

TEST(Integrators, TheStateBetweenStepsMayBeLookedAt) {
  for (const auto scheme : {Scheme::symplectic_euler, Scheme::velocity_verlet}) {
    std::vector<double> positions[2];
    for (int look = 0; look < 2; ++look) {
      DynamicsOptions options;
      options.scheme = scheme;
      options.damping = 0.7;
      options.gravity = {0, 0, -9.8};
      Body body(box(4, 3, 3));
      auto parameters = spring_model::defaults();
      parameters[spring_model::edge_damping] = 1;
      body.add(parameters);
      body.initialise();
      Dynamics dynamics(*body.attributes, body.mesh.complex, options);
      PrescribedMotion turn;
      turn.axis = {1, 0, 0};
      turn.angle = 0.5;
      turn.ramp = {0, 0.2, true};
      dynamics.constraints().add(vertices_at(body, 0, 0), 7, turn, *body.attributes);
      dynamics.start();
      double time = 0;
      for (int i = 0; i < 100; ++i) {
        const double dt = i < 50 ? 1e-3 : 1.5e-3;
        dynamics.step(dt, time += dt);
        if (look && i % 7 == 0) dynamics.energies();
        if (look && i % 5 == 0) dynamics.rest_sums();
      }
      dynamics.synchronise();
      const double* x = body.attributes->position().rows();
      positions[look].assign(x, x + 4 * body.attributes->vertex_count());
      const double* v = body.attributes->velocity().rows();
      positions[look].insert(positions[look].end(), v, v + 4 * body.attributes->vertex_count());
    }
    EXPECT_EQ(
        std::memcmp(positions[0].data(), positions[1].data(), positions[0].size() * sizeof(double)),
        0);
  }
}

TEST(Dynamics, SameBitsForAnyNumberOfThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<double> one;
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    DynamicsOptions options;
    options.threads = threads;
    options.gravity = {0, -9.8, 0};
    Body body(box(34, 32, 32));
    body.add(spring_model::defaults());
    body.initialise();
    Dynamics dynamics(*body.attributes, body.mesh.complex, options);
    dynamics.constraints().add(vertices_at(body, 0, 0), 7, {}, *body.attributes);
    dynamics.start();
    run(dynamics, 1e-3, 5);
    dynamics.synchronise();
    dynamics.update(body.mesh.complex, body.cut_random(200, 3));
    for (int i = 5; i < 10; ++i) dynamics.step(1e-3, (i + 1) * 1e-3);
    const double* x = body.attributes->position().rows();
    if (threads == 1) one.assign(x, x + 4 * body.attributes->vertex_count());
    EXPECT_EQ(std::memcmp(one.data(), x, one.size() * sizeof(double)), 0) << threads;
  }
}

TEST(Dynamics, FreeBodyKeepsItsMomentumAndEnergyThroughCuts) {
  DynamicsOptions options;
  options.scheme = Scheme::velocity_verlet;
  Body body(box(4, 4, 4));
  auto parameters = spring_model::defaults();
  parameters[spring_model::diagonal_stiffness] = 0;  // has no energy extension
  body.add(parameters);
  body.initialise();
  body.shake(2e-3, 4);
  Dynamics dynamics(*body.attributes, body.mesh.complex, options);
  dynamics.start();
  const auto momentum = [&] {
    Vec3 p{};
    for (Index v = 0; v < body.attributes->vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        p[static_cast<std::size_t>(c)] +=
            body.attributes->mass().get(v, 0) * body.attributes->velocity().get(v, c);
    return p;
  };
  const Vec3 before = momentum();
  double energy = dynamics.energies().total();
  double time = 0;
  for (unsigned round = 0; round < 6; ++round) {
    for (int i = 0; i < 200; ++i) dynamics.step(1e-4, time += 1e-4);
    EXPECT_NEAR(dynamics.energies().total(), energy, 1e-4 * energy) << round;
    dynamics.synchronise();
    dynamics.update(body.mesh.complex, body.cut_random(8, round));
    EXPECT_NEAR(dynamics.energies().total(), energy, 1e-4 * energy) << "cut " << round;
    energy = dynamics.energies().total();
  }
  const Vec3 after = momentum();
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(after[c], before[c], 1e-12);
}

TEST(Constraints, PrescribedRotationAndTranslationAreExact) {
  Body body(box(3, 2, 2));
  body.add(spring_model::defaults());
  body.initialise();
  DynamicsOptions options;
  Dynamics dynamics(*body.attributes, body.mesh.complex, options);
  PrescribedMotion motion;
  motion.axis = {0, 0, 2};  // any length
  motion.angle = std::numbers::pi / 2;
  motion.centre = {0, 0.1, 0};
  motion.translation = {0.5, 0, 0.25};
  motion.ramp = {0, 0.1, false};
  const auto held = vertices_at(body, 0, 0);
  dynamics.constraints().add(held, 7, motion, *body.attributes);
  dynamics.start();
  EXPECT_EQ(dynamics.settled_after(), 0.1);
  run(dynamics, 1e-3, 50);
  for (const Index v : held) {  // half way: 45 degrees
    const double y = body.attributes->rest().get(v, 1) - 0.1, z = body.attributes->rest().get(v, 2);
    const double r = std::sqrt(0.5), w = std::numbers::pi / 2 / 0.1;
    EXPECT_NEAR(body.attributes->position().get(v, 0), -r * y + 0.25, 1e-14);
    EXPECT_NEAR(body.attributes->position().get(v, 1), 0.1 + r * y, 1e-14);
    EXPECT_NEAR(body.attributes->position().get(v, 2), z + 0.125, 1e-14);
    EXPECT_NEAR(body.attributes->velocity().get(v, 0), -w * r * y + 5, 1e-12);
    EXPECT_NEAR(body.attributes->velocity().get(v, 1), -w * r * y, 1e-12);
  }
  for (int i = 50; i < 120; ++i) dynamics.step(1e-3, (i + 1) * 1e-3);
  for (const Index v : held) {
    EXPECT_NEAR(body.attributes->position().get(v, 0),
                0.5 - (body.attributes->rest().get(v, 1) - 0.1), 1e-14);
    EXPECT_EQ(body.attributes->velocity().get(v, 0), 0);
  }
}

TEST(Constraints, FollowASplitVertex) {
  Body body(box(2, 2, 1));
  body.add(spring_model::defaults());
  body.initialise();
  Dynamics dynamics(*body.attributes, body.mesh.complex, {});
  const auto all = vertices_at(body, 2, 0);
  dynamics.constraints().add(all, 7, {}, *body.attributes);
  dynamics.start();
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * body.mesh.complex.element_count(); d += 4)
    if (body.mesh.complex.can_cut(d)) faces.push_back(d);
  const auto change = body.mesh.complex.cut(faces);
  body.attributes->apply(body.mesh.complex, change);
  dynamics.update(body.mesh.complex, change);
  EXPECT_EQ(vertices_at(body, 2, 0).size(), 16u);
  EXPECT_EQ(dynamics.constraints().vertex_count(), 16u);
}

double sum_of_loads(Body& body, Dynamics& dynamics, double time, std::size_t component) {
  std::vector<double> rows(4 * body.attributes->vertex_count());
  dynamics.loads().add_to(rows.data(), body.attributes->position().rows(), time);
  double sum = 0;
  for (std::size_t i = component; i < rows.size(); i += 4) sum += rows[i];
  return sum;
}

TEST(Loads, TotalsAreKeptByCutsAndSharedByArea) {
  Body body(box(4, 4, 2));
  body.add(spring_model::defaults());
  body.initialise();
  Dynamics dynamics(*body.attributes, body.mesh.complex, {});
  const auto top = vertices_at(body, 2, 0.2);
  dynamics.loads().add_force(body.mesh.complex, *body.attributes, top, {3, -5, 7}, {0, 2, false});
  std::vector<double> rows(4 * body.attributes->vertex_count());
  dynamics.loads().add_to(rows.data(), body.attributes->position().rows(), 2);
  const Index corner = [&] {
    for (const Index v : top)
      if (body.attributes->rest().get(v, 0) == 0 && body.attributes->rest().get(v, 1) == 0)
        return v;
    return none;
  }();
  EXPECT_NEAR(rows[4 * corner + 2], 7.0 / 16 / 4, 1e-14) << "a quarter of a face of sixteen";
  EXPECT_NEAR(sum_of_loads(body, dynamics, 1, 2), 3.5, 1e-13) << "half the ramp";
  for (unsigned seed = 0; seed < 4; ++seed) {
    dynamics.update(body.mesh.complex, body.cut_random(10, seed));
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(sum_of_loads(body, dynamics, 5, c), (std::array{3, -5, 7})[c], 1e-13);
  }
}

std::vector<Dart> boundary_faces(Body& body) {
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * body.mesh.complex.element_count(); d += 4)
    if (body.mesh.complex.beta3(d) == none) faces.push_back(d);
  return faces;
}

TEST(Loads, TractionHasTheRestAreaAndPressureFollows) {
  Body body(box(3, 2, 2), true);
  body.add(spring_model::defaults());
  body.initialise();
  Dynamics dynamics(*body.attributes, body.mesh.complex, {});
  const auto faces = boundary_faces(body);
  dynamics.loads().add_pressure(body.mesh.complex, faces, 1000, {});
  // A closed surface is in equilibrium under pressure, however it is deformed.
  body.shake(0.02, 11);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sum_of_loads(body, dynamics, 0, c), 0, 1e-11);
  // Power of a uniform expansion x' = x: - 3 p V, here with p = 1000.
  std::vector<double> rows(4 * body.attributes->vertex_count());
  dynamics.loads().add_to(rows.data(), body.attributes->position().rows(), 0);
  double power = 0, volume = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    power += rows[i] * body.attributes->position().rows()[i];
  for (Index e = 0; e < body.mesh.complex.element_count(); ++e) {
    HexahedronNodes x;
    for (std::size_t n = 0; n < 8; ++n)
      for (int c = 0; c < 3; ++c)
        x[n][static_cast<std::size_t>(c)] =
            body.attributes->position().get(body.mesh.complex.vertices_of(e)[n], c);
    volume += hexahedron_volume(x);
  }
  EXPECT_NEAR(power, -3 * 1000 * volume, 1e-9 * 3000 * volume);

  Body block(box(3, 2, 2));
  block.add(spring_model::defaults());
  block.initialise();
  Dynamics other(*block.attributes, block.mesh.complex, {});
  other.loads().add_traction(block.mesh.complex, *block.attributes, boundary_faces(block),
                             {0, 10, 0}, {});
  EXPECT_NEAR(sum_of_loads(block, other, 0, 1), 10 * 2 * (0.06 + 0.06 + 0.04), 1e-12);
}

TEST(Dynamics, ChecksNameWhatIsWrong) {
  Body body(box(3, 3, 3));
  body.add(spring_model::defaults());
  body.initialise();
  Dynamics dynamics(*body.attributes, body.mesh.complex, {});
  dynamics.start();
  EXPECT_TRUE(dynamics.inverted_elements().empty());
  const Index vertex = vertices_at(body, 0, 0.1)[3];
  body.attributes->position().set(vertex, 0, 0.75);  // through the element in front
  const std::vector<Index> found = dynamics.inverted_elements();
  EXPECT_FALSE(found.empty());
  EXPECT_TRUE(std::ranges::is_sorted(found));
  std::vector<Dart> star;
  body.mesh.complex.star(0, vertex, star);
  for (const Index e : found)
    EXPECT_TRUE(std::ranges::any_of(star, [&](Dart d) { return d / 24 == e; })) << e;
  body.attributes->velocity().set(vertex, 1, std::nan(""));
  try {
    dynamics.step(1e-4, 1e-4);
    FAIL() << "no error";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("vertex " + std::to_string(vertex)), std::string::npos)
        << error.what();
  }
}

TEST(RestSearch, FindsTheEquilibriumOfAHangingBlock) {
  DynamicsOptions options;
  options.gravity = {9.8, 0, 0};
  options.gravity_ramp = {0, 0.5, false};
  Body body(box(6, 2, 2));
  auto parameters = spring_model::defaults();
  parameters[spring_model::edge_stiffness] = 4000;
  parameters[spring_model::diagonal_stiffness] = 0;
  body.add(parameters);
  body.initialise();
  Dynamics dynamics(*body.attributes, body.mesh.complex, options);
  dynamics.constraints().add(vertices_at(body, 0, 0), 7, {}, *body.attributes);
  std::vector<Index> all;
  for (Index v = 0; v < body.attributes->vertex_count(); ++v) all.push_back(v);
  dynamics.constraints().add(all, 6, {}, *body.attributes);
  dynamics.start();
  const double dt = 0.8 * dynamics.bounds().dt;
  RestSearch search(1e-8, true);
  int steps = 0;
  while (!search.at_rest(dynamics) && steps < 20000) {
    dynamics.step(dt, (steps + 1) * dt);
    ++steps;
  }
  EXPECT_LT(steps, 5000);
  EXPECT_GT(dynamics.time(), 0.5);
  // Springs in a row: spring i carries the plates behind it. Sections of 4 cells,
  // k per section 4 x k, mass of a plate 4 cells but half at the end.
  const double plate = 4 * 1.0, k = 4 * 4000;
  double expected = 0;
  for (int i = 0; i < 6; ++i) expected += 9.8 * plate * (5.5 - i) / k;
  const Index end = vertices_at(body, 0, 0.6)[0];
  EXPECT_NEAR(body.attributes->position().get(end, 0) - 0.6, expected, 1e-7 * expected);
}

}  // namespace
