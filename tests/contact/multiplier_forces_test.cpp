// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contact as forces with multipliers: their tangent, their sums, their symmetry.
#include "kernel/contact/multiplier_forces.hpp"

#include <gtest/gtest.h>

#include <random>

#include "kernel/implicit/newton.hpp"
#include "tests/dynamics/model_block.hpp"

namespace suture {
namespace {

/// A block of 3 x 3 x 4 elements of 0.1 m, cut in half and pressed together, sheared and twisted.
struct Halves : rig::Block {
  explicit Halves(double friction)
      : Block("tm-faure", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}, {3, 3, 4}, 0.1,
              {"static", 0, {}, {}}),
        contact(body.add_contact({}, 0)) {
    contact.touch_pieces({friction});
    forces = &body.add(
        std::make_unique<MultiplierForces>(contact, body.attributes(), body.models(), true));
    const CellComplex& complex = body.complex();
    std::vector<Dart> faces;
    for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
      if (complex.can_cut(d) && d / 24 / 9 == 1 && complex.beta3(d) / 24 / 9 == 2)
        faces.push_back(d);
    body.cut(faces);
    hold(vertices([](const Vec3& x) { return x[2] < 1e-9; }), 7);
    PrescribedMotion motion;
    motion.translation = {0.02, 0.03, -0.008};
    motion.ramp = {0, 1, true};
    hold(vertices([](const Vec3& x) { return x[2] > 0.4 - 1e-9; }), 7, motion);
    dynamics.newton()->on_iteration = [this](const Newton::Iteration& iteration) {
      linear_iterations.push_back(iteration.linear_iterations);
    };
    start();
    step(1);
  }
  std::size_t size() { return 3 * std::size_t{body.attributes().vertex_count()}; }
  std::vector<double> contact_forces() {
    std::vector<double> rows(size() / 3 * 4);
    forces->add_forces(dynamics.time(), body.attributes().kernel(0).cells.live(), rows.data());
    return rows;
  }
  std::vector<double> random_direction(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    std::vector<double> d(size());
    for (double& c : d) c = any(random);
    return d;
  }
  std::vector<double> tangent(const std::vector<double>& d) {
    std::vector<double> image(size());
    forces->add_tangent(d.data(), 1, 0, dynamics.time(), image.data());
    return image;
  }
  Contact& contact;
  MultiplierForces* forces;
  std::vector<unsigned> linear_iterations;  ///< of each iteration of Newton's method
};

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

TEST(MultiplierForces, HaveTheTangentOfTheirDifferences) {
  for (const double friction : {0.0, 0.1, 10.0}) {
    Halves halves(friction);
    EXPECT_GT(halves.contact.touches().size(), 20u);
    double* x = halves.attributes().position().rows();
    const std::vector<double> d = halves.random_direction(1);
    const auto forces_at = [&](double way) {
      for (std::size_t i = 0; i < d.size(); ++i) x[i / 3 * 4 + i % 3] += way * d[i];
      const std::vector<double> forces = halves.contact_forces();
      for (std::size_t i = 0; i < d.size(); ++i) x[i / 3 * 4 + i % 3] -= way * d[i];
      return forces;
    };
    std::vector<double> image = halves.tangent(d);
    halves.forces->add_skew_tangent(d.data(), 1, halves.dynamics.time(), image.data());
    constexpr double h = 1e-9;
    const std::vector<double> ahead = forces_at(h), behind = forces_at(-h);
    double largest = 0;
    for (const double f : image) largest = std::max(largest, std::abs(f));
    EXPECT_GT(largest, 1000);
    for (std::size_t i = 0; i < d.size(); ++i)
      EXPECT_NEAR((ahead[i / 3 * 4 + i % 3] - behind[i / 3 * 4 + i % 3]) / (2 * h), image[i],
                  1e-4 * largest)
          << "friction " << friction << ", component " << i;
  }
}

TEST(MultiplierForces, HaveASymmetricTangent) {
  for (const double friction : {0.0, 0.1}) {
    Halves halves(friction);
    const std::vector<double> a = halves.random_direction(1), b = halves.random_direction(2);
    const double one = product(a, halves.tangent(b)), other = product(b, halves.tangent(a));
    EXPECT_GT(std::abs(one), 1000);
    EXPECT_NEAR(one, other, 1e-12 * std::abs(product(a, halves.tangent(a))));
    EXPECT_EQ(halves.forces->is_conservative(0), friction == 0);
  }
}

/// The factor of so small a body is that of its matrix, with what joins the pieces.
TEST(MultiplierForces, ArePartOfPreconditioners) {
  Halves halves(0);
  unsigned sum = 0;
  for (const unsigned iterations : halves.linear_iterations) sum += iterations;
  EXPECT_LE(sum, 3 * halves.linear_iterations.size());
}

/// Moments: except for gaps that are left and the way since contacts were found, 1e-4 of an edge.
TEST(MultiplierForces, ActEquallyOnBothPieces) {
  for (const double friction : {0.0, 0.3}) {
    Halves halves(friction);
    Vec3 force{}, moment{};
    double size = 0;
    const std::vector<double> forces = halves.contact_forces();
    for (Index v = 0; v < halves.attributes().vertex_count(); ++v) {
      const double* f = &forces[4 * std::size_t{v}];
      const Vec3 on{f[0], f[1], f[2]};
      force = plus(force, on);
      moment = plus(moment, cross({halves.x(v, 0), halves.x(v, 1), halves.x(v, 2)}, on));
      size += norm(on);
    }
    EXPECT_GT(size, 10);
    EXPECT_LT(norm(force), 1e-14 * size);
    EXPECT_LT(norm(moment), 1e-4 * 0.1 * size);
  }
}

}  // namespace
}  // namespace suture
