// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/forces/dead_loads.hpp"
#include "kernel/forces/gravity.hpp"
#include "kernel/forces/pressures.hpp"
#include "kernel/spectrum/step_limits.hpp"
#include "tests/forces/spring_model.hpp"

/// What tests of dynamics set up again and again.
namespace rig {

constexpr const char* euler = "symplectic-euler";
constexpr const char* verlet = "velocity-verlet";
constexpr const char* schemes[] = {euler, verlet};

struct Options {
  std::string integrator = euler;
  double damping = 0;
  suture::Vec3 gravity{};
  suture::TimeRamp gravity_ramp{};
  suture::IntegratorOptions solver{};
};

/// The terms of a scene besides the models, dynamics and limits, of a body that is compiled.
struct Rig {
  explicit Rig(suture::Body& owner, const Options& options = {})
      : body(owner),
        gravity(body.add(std::make_unique<suture::Gravity>(body.attributes(), options.gravity,
                                                           options.gravity_ramp))),
        loads(body.add(std::make_unique<suture::DeadLoads>(body.attributes()))),
        pressures(body.add(std::make_unique<suture::Pressures>(body.attributes()))),
        dynamics(body, {options.integrator, options.damping, options.solver}),
        limits(body) {}

  void hold(const std::vector<suture::Index>& vertices, std::uint8_t components,
            const suture::PrescribedMotion& motion = {}) {
    body.constraints().add(vertices, components, motion, body.attributes());
  }
  /// The ledger begins.
  suture::EnergyBalance start() {
    dynamics.start();
    return dynamics.balance();
  }
  void step(double dt) { dynamics.step(dt, dynamics.time() + dt); }
  void run(double dt, int steps) {
    const double begin = dynamics.time();
    for (int i = 1; i <= steps; ++i) dynamics.step(dt, begin + i * dt);
  }
  double stable_step() { return limits.stable_step(dynamics.time()); }

  double x(suture::Index v, int c = 0) const { return body.attributes().position().get(v, c); }
  double shift(suture::Index v, int c = 0) const {
    return x(v, c) - body.attributes().rest().get(v, c);
  }
  double mass() const {
    double sum = 0;
    for (suture::Index v = 0; v < body.attributes().vertex_count(); ++v)
      sum += body.attributes().mass().get(v, 0);
    return sum;
  }
  /// Positions and velocities.
  std::vector<double> state() const {
    std::vector<double> all;
    for (const suture::Column* column :
         {&body.attributes().position(), &body.attributes().velocity()})
      all.insert(all.end(), column->rows(),
                 column->rows() + std::size_t{column->size()} * column->stride());
    return all;
  }

  suture::Body& body;
  suture::Gravity& gravity;
  suture::DeadLoads& loads;
  suture::Pressures& pressures;
  suture::Dynamics dynamics;
  suture::StepLimits limits;
};

/// Springs on edges store energy, springs on diagonals have no suture.energy/1.
struct Springs {
  double edges = 100, viscosity = 0, diagonals = 0;
};

/// A block of springs.
struct SpringBlock : spring_model::Body {
  SpringBlock(const suture::BoxOptions& shape, const Springs& springs, bool distorted,
              unsigned threads)
      : Body(shape, distorted) {
    auto parameters = spring_model::defaults();
    parameters[spring_model::edge_stiffness] = springs.edges;
    parameters[spring_model::edge_damping] = springs.viscosity;
    parameters[spring_model::diagonal_stiffness] = springs.diagonals;
    instance = &add(parameters);
    compile(threads);
  }
  suture::Instance* instance;
};

struct HasBlock {
  SpringBlock block;
};

/// A block of springs with a rig; the ledger begins with start().
struct Moving : HasBlock, Rig {
  explicit Moving(const suture::BoxOptions& shape, const Options& options = {},
                  const Springs& springs = {}, bool distorted = false, unsigned threads = 0)
      : HasBlock{{shape, springs, distorted, threads}}, Rig(block, options) {}
  std::vector<suture::Index> at(int axis, double where) const {
    return spring_model::vertices_at(body, axis, where);
  }
};

/// Two plates of mass M = rho V / 2 = 0.5 kg that move along x only, joined by four springs of
/// k / 4 in parallel, K = 100 N/m; one plate is held: w = sqrt(K / M) = 14.14 / s.
struct Oscillator : Moving {
  explicit Oscillator(const Options& options, const Springs& springs = {})
      : Moving(spring_model::box(1, 1, 1), options, springs) {
    hold(at(0, 0), 7);
    plate = at(0, 0.1);
    hold(plate, 6);
  }
  void displace(double u) {
    for (const suture::Index v : plate) body.attributes().position().set(v, 0, 0.1 + u);
  }
  double u() const { return shift(plate[0]); }
  double velocity() const { return body.attributes().velocity().get(plate[0], 0); }
  static constexpr double m = 0.5, k = 100;
  static double omega() { return std::sqrt(k / m); }
  std::vector<suture::Index> plate;
};

inline void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_EQ(std::memcmp(&a[i], &b[i], sizeof(double)), 0)
        << "number " << i << ": " << a[i] << " and " << b[i];
}

}  // namespace rig
