// SPDX-License-Identifier: GPL-3.0-or-later
//
// tm-faure against the scalar reference, derivatives, rigid motion and closed
// forms, for every instruction set that this processor runs.
#include <gtest/gtest.h>

#include <random>

#include "tests/plugins/plugin_batch.hpp"
#include "tests/plugins/stvk_reference.hpp"

namespace {

using namespace suture::test;

constexpr double young = 4e5, poisson = 0.3, density = 1000;
constexpr double size = 0.05;  // of the test elements, m
constexpr double force_scale = young * size * size;
enum Rule { gauss2 = 0, exact = 1 };
enum Form { box, parallelepiped, distorted };
constexpr Form forms[] = {box, parallelepiped, distorted};

const char* functor_of(Form form) {
  return form == distorted ? "general hexahedra" : "parallelepipeds";
}

Hexahedron affine(const Hexahedron& X, const Matrix& A, const Point& shift = {}) {
  Hexahedron x;
  for (int n = 0; n < 8; ++n)
    for (int i = 0; i < 3; ++i)
      x[n][i] = shift[i] + A[i][0] * X[n][0] + A[i][1] * X[n][1] + A[i][2] * X[n][2];
  return x;
}

Hexahedron box_of(double a, double b, double c) {
  Hexahedron X;
  for (int n = 0; n < 8; ++n) X[n] = {(n & 1) * a, ((n >> 1) & 1) * b, (n >> 2) * c};
  return X;
}

/// About (1,2,2)/3, by Rodrigues' formula.
Matrix rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Point u{1 / 3., 2 / 3., 2 / 3.};
  Matrix R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double spin = i == j ? 0 : ((j - i + 3) % 3 == 1 ? -u[3 - i - j] : u[3 - i - j]);
      R[i][j] = (i == j ? c : 0) + (1 - c) * u[i] * u[j] + s * spin;
    }
  return R;
}

class TmFaure : public testing::TestWithParam<std::string> {
 protected:
  const suture_model& model() {
    return load_plugin(SUTURE_PLUGIN_FOLDER, "tm-faure", GetParam()).models[0];
  }
  std::vector<double> parameters(Rule rule, double nu = poisson) {
    return {young, nu, density, double(rule)};
  }
  double uniform(double a) { return std::uniform_real_distribution<>(-a, a)(random); }
  Hexahedron disturbed(Hexahedron x, double amplitude) {
    for (auto& p : x)
      for (auto& c : p) c += uniform(amplitude);
    return x;
  }
  /// Eight different elements of a form.
  std::array<Hexahedron, 8> elements(Form form) {
    std::array<Hexahedron, 8> all;
    for (auto& X : all) {
      X = box_of(size * (1 + uniform(.3)), size * (1 + uniform(.3)), size * (1 + uniform(.3)));
      if (form == parallelepiped)
        X = affine(X, {{{1, uniform(.3), uniform(.3)},
                        {uniform(.3), 1, uniform(.3)},
                        {uniform(.3), uniform(.3), 1}}});
      if (form == distorted) X = disturbed(X, 0.15 * size);
    }
    return all;
  }

  std::mt19937 random{20261121};
};

TEST_P(TmFaure, ForcesAndEnergyEqualTheScalarReference) {
  for (const Rule rule : {gauss2, exact})
    for (const Form form : forms) {
      ModelInstance instance(model(), parameters(rule));
      const auto rest = elements(form);
      HexahedronBatch batch(instance, instance.functor(functor_of(form)), rest);
      std::array<Hexahedron, 8> x;
      for (int lane = 0; lane < 8; ++lane)
        batch.move(lane, x[lane] = disturbed(rest[lane], 0.2 * size));
      ASSERT_EQ(batch.force(), SUTURE_OK) << instance.error.text;
      const auto energy = batch.energy();
      for (int lane = 0; lane < 8; ++lane) {
        const auto expected =
            stvk_reference(rest[lane], x[lane], Stvk(young, poisson), rule == exact ? 3 : 2);
        EXPECT_NEAR(energy[lane] / expected.energy, 1, 1e-13);
        for (int n = 0; n < 8; ++n)
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(batch.force_at(lane, n, c), expected.force[n][c], 1e-13 * force_scale)
                << "form " << form << " rule " << rule << " lane " << lane << " node " << n;
      }
    }
}

TEST_P(TmFaure, ForceIsMinusTheEnergyGradient) {
  for (const Rule rule : {gauss2, exact})
    for (const Form form : forms) {
      ModelInstance instance(model(), parameters(rule));
      const auto rest = elements(form);
      HexahedronBatch batch(instance, instance.functor(functor_of(form)), rest);
      for (int lane = 0; lane < 8; ++lane) batch.move(lane, disturbed(rest[lane], 0.2 * size));
      ASSERT_EQ(batch.force(), SUTURE_OK);
      const double h = 1e-5 * size;
      for (int n = 0; n < 8; ++n)
        for (int c = 0; c < 3; ++c) {
          const auto energy_at = [&](double step) {
            for (int lane = 0; lane < 8; ++lane) batch.position(lane, n, c) += step;
            return batch.energy();
          };
          const auto up = energy_at(h), down = energy_at(-2 * h);
          energy_at(h);
          for (int lane = 0; lane < 8; ++lane)
            EXPECT_NEAR(batch.force_at(lane, n, c), -(up[lane] - down[lane]) / (2 * h),
                        1e-7 * force_scale)
                << "form " << form << " rule " << rule << " node " << n;
        }
    }
}

TEST_P(TmFaure, TangentIsTheDerivativeOfTheForce) {
  for (const Rule rule : {gauss2, exact})
    for (const Form form : forms) {
      ModelInstance instance(model(), parameters(rule));
      const auto rest = elements(form);
      HexahedronBatch batch(instance, instance.functor(functor_of(form)), rest);
      for (int lane = 0; lane < 8; ++lane) batch.move(lane, disturbed(rest[lane], 0.2 * size));
      suture::AlignedVector<double> dx(192);
      for (auto& d : dx) d = uniform(size);
      const auto df = batch.tangent(dx);
      const double h = 1e-6;
      const auto forces_at = [&](double step) {
        for (int lane = 0; lane < 8; ++lane)
          for (int i = 0; i < 24; ++i)
            batch.position(lane, i / 3, i % 3) += step * dx[i * 8 + lane];
        EXPECT_EQ(batch.force(), SUTURE_OK);
        return std::vector<double>(batch.batch.force, batch.batch.force + 192);
      };
      const auto up = forces_at(h), down = forces_at(-2 * h);
      for (int i = 0; i < 192; ++i)
        EXPECT_NEAR(df[i], (up[i] - down[i]) / (2 * h), 1e-7 * force_scale);
    }
}

TEST_P(TmFaure, RigidMotionGivesNoForce) {
  for (const Rule rule : {gauss2, exact})
    for (const Form form : forms) {
      ModelInstance instance(model(), parameters(rule));
      const auto rest = elements(form);
      HexahedronBatch batch(instance, instance.functor(functor_of(form)), rest);
      for (const double angle : {0.0, 0.4, 1.6, 3.0}) {
        for (int lane = 0; lane < 8; ++lane)
          batch.move(lane, affine(rest[lane], rotation(angle), {0.1, -0.2, 0.3}));
        ASSERT_EQ(batch.force(), SUTURE_OK);
        for (int i = 0; i < 192; ++i)
          EXPECT_LE(std::abs(batch.batch.force[i]), 1e-12 * force_scale);
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Isa, TmFaure, testing::ValuesIn(runnable_isas()),
                         [](const auto& info) { return info.param; });

}  // namespace
