// SPDX-License-Identifier: GPL-3.0-or-later
//
// The laws of the plugins on continuum.hpp beside their closed forms, derivatives and relaxation,
// for both elements, every form of hexahedra and every instruction set of this processor.
#include "tests/plugins/laws.hpp"

#include <gtest/gtest.h>

#include <random>

#include "suture/single.h"
#include "tests/plugins/plugin_batch.hpp"

namespace {

using namespace suture::test;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Batch = suture::AlignedVector<double>;

constexpr double size[3] = {0.03, 0.04, 0.05};  // of boxes, m
constexpr double force_scale = law::young * size[1] * size[2];
const char* const functors[] = {"parallelepipeds", "parallelepipeds, mean gradient",
                                "general hexahedra, geometry stored",
                                "general hexahedra, mean gradient"};

class Laws : public testing::TestWithParam<std::string> {
 protected:
  ModelInstance instance(const Law& law, int form) {
    std::vector<double> parameters = law.parameters;
    parameters.push_back(form % 2);
    return {load_plugin(SUTURE_PLUGIN_FOLDER, law.model, GetParam()).models[0], parameters};
  }
  double uniform(double a) { return std::uniform_real_distribution<>(-a, a)(random); }
  Matrix3d near_identity(double amplitude) {
    Matrix3d A = Matrix3d::Identity();
    for (int i = 0; i < 9; ++i) A(i) += uniform(amplitude);
    return A;
  }
  /// Boxes, or boxes with moved corners.
  std::array<Hexahedron, 8> elements(int form) {
    std::array<Hexahedron, 8> all;
    for (auto& X : all)
      for (int n = 0; n < 8; ++n)
        for (int c = 0; c < 3; ++c)
          X[n][c] = ((n >> c) & 1) * size[c] + (form >= 2 ? uniform(0.15 * size[0]) : 0);
    return all;
  }
  void disturb(HexahedronBatch& batch, double amplitude) {
    for (int lane = 0; lane < 8; ++lane)
      for (int i = 0; i < 24; ++i) batch.position(lane, i / 3, i % 3) += uniform(amplitude);
  }

  std::mt19937 random{20261122};
};

// Constant gradients, for which both elements have the forces of P and the energy V W.
TEST_P(Laws, HaveTheirClosedForms) {
  for (const Law& law : laws())
    for (const int form : {0, 1}) {
      ModelInstance model = instance(law, form);
      const auto rest = elements(form);
      HexahedronBatch batch(model, model.functor(functors[form]), rest);
      std::array<Matrix3d, 8> F;
      for (int lane = 0; lane < 8; ++lane) {
        F[lane] = near_identity(0.25);
        for (int n = 0; n < 8; ++n) {
          const Vector3d x = F[lane] * Vector3d::Map(rest[lane][n].data());
          for (int c = 0; c < 3; ++c) batch.position(lane, n, c) = x[c];
        }
      }
      ASSERT_EQ(batch.force(), SUTURE_OK) << model.error.text;
      const auto energy = batch.energy();
      for (int lane = 0; lane < 8; ++lane) {
        const Matrix3d P = law.stress(F[lane]);
        EXPECT_GT(P.norm(), 100);
        EXPECT_NEAR(energy[lane], law.energy(F[lane]) * size[0] * size[1] * size[2], 1e-12);
        for (int n = 0; n < 8; ++n) {
          Vector3d outward;
          for (int c = 0; c < 3; ++c)
            outward[c] = ((n >> c) & 1 ? 1 : -1) * size[(c + 1) % 3] * size[(c + 2) % 3] / 4;
          const Vector3d expected = -P * outward;
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(batch.force_at(lane, n, c), expected[c], 1e-12 * force_scale)
                << law.model << " in " << functors[form] << ", lane " << lane;
        }
      }
    }
}

/// The tangent in single precision, of which lane `l + 8` repeats lane l.
std::vector<float> single_tangent(const ModelInstance& model, const suture_functor& functor,
                                  HexahedronBatch& batch, const Batch& dx) {
  const auto& table =
      ModelInstance::extension<suture_tangent_single_1>(functor, SUTURE_TANGENT_SINGLE_1);
  const auto rounded = [](const double* from, std::size_t rows, bool relative) {
    suture::AlignedVector<float> to(rows * 16);
    for (std::size_t i = 0; i < to.size(); ++i) {
      const std::size_t row = i / 16, lane = i % 8;
      to[i] = float(from[row * 8 + lane] - (relative ? from[row % 3 * 8 + lane] : 0));
    }
    return to;
  };
  const auto rest = rounded(batch.rest(), 24, true), x = rounded(batch.batch.position, 24, true),
             direction = rounded(dx.data(), 24, false);
  const suture::AlignedVector<float> none(24 * 16);
  std::vector<suture::AlignedVector<float>> columns;
  std::vector<const float*> pointers;
  for (const auto& column : batch.columns())
    if (columns.size() < table.columns)
      columns.push_back(rounded(column.data(), column.size() / 8, false));
  for (const auto& column : columns) pointers.push_back(column.data());
  suture_single_batch single{};
  single.size = sizeof single;
  single.lanes = 16;
  single.nodes = 8;
  single.dt = batch.batch.dt;
  single.rest = rest.data();
  single.position = x.data();
  single.cell_columns = pointers.data();
  suture::AlignedVector<float> df(24 * 16);
  EXPECT_EQ(table.apply(model.context(), &single, direction.data(), none.data(), df.data()),
            SUTURE_OK);
  return {df.begin(), df.end()};
}

// In a step, so that a law with a state relaxes within it.
TEST_P(Laws, HaveTheTangentsOfTheirForces) {
  for (const Law& law : laws())
    for (int form = 0; form < 4; ++form) {
      ModelInstance model = instance(law, form);
      HexahedronBatch batch(model, model.functor(functors[form]), elements(form));
      batch.batch.dt = 0.01;
      disturb(batch, 0.2 * size[0]);
      Batch dx(192);
      for (double& d : dx) d = uniform(size[0]);
      const Batch df = batch.tangent(dx);
      std::vector<float> single;  // mean-gradient elements have none
      if (form % 2 == 0) single = single_tangent(model, model.functor(functors[form]), batch, dx);
      const auto moved = [&](double h) {
        for (int i = 0; i < 192; ++i) batch.position(i % 8, i / 24, i / 8 % 3) += h * dx[i];
        EXPECT_EQ(batch.force(), SUTURE_OK);
        Batch f(192);
        for (int i = 0; i < 192; ++i) f[i] = batch.force_at(i % 8, i / 24, i / 8 % 3);
        return f;
      };
      const double h = 1e-6;
      const Batch up = moved(h), down = moved(-2 * h);
      double scale = 0;
      for (const double d : df) scale = std::max(scale, std::abs(d));
      EXPECT_GT(scale, 1e-2);
      for (int i = 0; i < 192; ++i) {
        EXPECT_NEAR(df[i], (up[i] - down[i]) / (2 * h), 2e-7 * scale)
            << law.model << " in " << functors[form];
        if (!single.empty()) {
          EXPECT_NEAR(single[i / 8 * 16 + i % 8], df[i], 2e-4 * scale)
              << law.model << " in " << functors[form];
        }
      }
    }
}

TEST_P(Laws, HaveForcesThatAreMinusTheGradientsOfTheirEnergies) {
  for (const Law& law : laws())
    for (int form = 0; form < 4; ++form) {
      ModelInstance model = instance(law, form);
      HexahedronBatch batch(model, model.functor(functors[form]), elements(form));
      disturb(batch, 0.2 * size[0]);
      ASSERT_EQ(batch.force(), SUTURE_OK);
      Batch force(192);
      for (int i = 0; i < 192; ++i) force[i] = batch.force_at(i % 8, i / 24, i / 8 % 3);
      const double h = 1e-6 * size[0];
      for (int i = 0; i < 24; ++i) {
        const auto energy_at = [&](double step) {
          for (int lane = 0; lane < 8; ++lane) batch.position(lane, i / 3, i % 3) += step;
          return batch.energy();
        };
        const auto up = energy_at(h), down = energy_at(-2 * h);
        energy_at(h);
        for (int lane = 0; lane < 8; ++lane)
          EXPECT_NEAR(force[i * 8 + lane], (down[lane] - up[lane]) / (2 * h), 1e-6 * force_scale)
              << law.model << " in " << functors[form];
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Isa, Laws, testing::ValuesIn(runnable_isas()),
                         [](const auto& isa) { return isa.param; });

// ------------------------------------------------------------------ relaxation --

std::array<Hexahedron, 8> unit_cubes() {
  std::array<Hexahedron, 8> all;
  for (auto& X : all)
    for (int n = 0; n < 8; ++n) X[n] = {double(n & 1), double(n >> 1 & 1), double(n >> 2)};
  return all;
}

/// Stretches unit cubes along x to the length `s`. Returns the force on the ends, N.
double pull(HexahedronBatch& batch, double s) {
  for (int lane = 0; lane < 8; ++lane)
    for (int n = 0; n < 8; ++n) batch.position(lane, n, 0) = s * (n & 1);
  EXPECT_EQ(batch.force(), SUTURE_OK);
  double sum = 0;
  for (const int n : {1, 3, 5, 7}) sum -= batch.force_at(3, n, 0);
  return sum;
}

/// Simple shear of a unit cube of visco.
class Relaxation {
 public:
  explicit Relaxation(const std::string& isa)
      : model_(load_plugin(SUTURE_PLUGIN_FOLDER, "visco", isa).models[0],
               {law::stiffness, law::exponent, 1e5, 1000, law::shortest}),
        batch_(model_, model_.functor("parallelepipeds, mean gradient"), unit_cubes()) {}

  /// The shear stress after a step to the shear `gamma`, Pa.
  double step(double dt, double gamma) {
    batch_.batch.dt = dt;
    for (int lane = 0; lane < 8; ++lane)
      for (int n = 0; n < 8; ++n) batch_.position(lane, n, 0) = (n & 1) + gamma * ((n >> 1) & 1);
    EXPECT_EQ(batch_.force(), SUTURE_OK);
    batch_.accept();
    double top = 0;
    for (const int n : {2, 3, 6, 7}) top -= batch_.force_at(0, n, 0);
    return top;
  }
  double energy() {
    batch_.batch.dt = 0;
    return batch_.energy()[0];
  }

 private:
  ModelInstance model_;
  HexahedronBatch batch_;
};

/// The stress per strain at time t of the terms, of a strain that grows linearly from 0 to dt and
/// stays. The mean of exp(-(t - s) / tau) over 0 < s < dt is
///   exp(-(t - dt) / tau) (1 - exp(-dt / tau)) tau / dt
double modulus(double t, double dt) {
  double sum = law::elastic_modulus();
  for (int k = 0; k < 5; ++k) {
    const double tau = law::shortest * std::pow(10, k);
    sum += law::term(k) * std::exp(-(t - dt) / tau) * -std::expm1(-dt / tau) * tau / dt;
  }
  return sum;
}

TEST_P(Laws, ViscoRelaxesAsItsTermsDoWhateverTheSteps) {
  for (const double dt : {1e-4, 0.01, 0.5}) {
    Relaxation shear(GetParam());
    double energy = std::numeric_limits<double>::infinity();
    for (int step = 1; step <= 40; ++step) {
      EXPECT_NEAR(shear.step(dt, 1.3), 1.3 * modulus(step * dt, dt), 1e-9 * law::stiffness) << dt;
      EXPECT_LT(shear.energy(), energy) << "no energy comes from relaxation";
      energy = shear.energy();
    }
  }
}

// The liver of Golec et al. 2015, Fig. 13 and 14: K rate t^(1-n) / Gamma(2-n), to 1.34 at the
// fastest rate.
TEST_P(Laws, ViscoUnderAConstantRateFollowsThePowerLaw) {
  for (const double rate : {0.0151, 0.133, 0.67}) {
    Relaxation shear(GetParam());
    const double dt = 1e-3;
    for (int step = 1; step <= 2000; ++step) {
      const double t = step * dt, stress = shear.step(dt, rate * t);
      if (step % 500 != 0) continue;
      const double expected =
          law::stiffness * rate * std::pow(t, 1 - law::exponent) / std::tgamma(2 - law::exponent);
      EXPECT_NEAR(stress / expected, 1, 0.01) << rate << " 1/s, " << t << " s";
    }
  }
}

// --------------------------------------------------------------------- damage --

/// Springs of a unit cube stretched along x by s: their energy and its derivative, over G.
std::array<double, 2> stretched_springs(double s) {
  double energy = 0, slope = 0;
  const auto add = [&](int count, double k, double across2) {
    const double now = std::sqrt(s * s + across2), rest = std::sqrt(1 + across2);
    energy += count * k / 2 * (now - rest) * (now - rest);
    slope += count * k * (now - rest) * s / now;
  };
  add(4, 11 / 28., 0);
  add(8, 3 / 14., 1);
  add(4, 3 / 7., 2);
  return {energy, slope};
}

TEST_P(Laws, DamageSpringsWeakenForGood) {
  const double E = 1000, G = 0.4 * E, e0 = 0.02, e1 = 0.1;
  ModelInstance model(load_plugin(SUTURE_PLUGIN_FOLDER, "damage-springs", GetParam()).models[0],
                      {E, 1000, e0, e1});
  HexahedronBatch batch(model, model.functor("damage-springs"), unit_cubes());
  double largest = e0;
  for (const double s : {1.01, 1.05, 1.2, 1.05, 0.9, 1.2, 1.3}) {
    const double untouched = pull(batch, 1.02);
    pull(batch, 2);  // not accepted
    EXPECT_EQ(pull(batch, 1.02), untouched);
    const auto [energy, slope] = stretched_springs(s);
    largest = std::max(largest, std::sqrt(2 * G * energy / E));
    const double left = e0 / largest * std::exp((e0 - largest) / e1);
    EXPECT_NEAR(pull(batch, s), left * G * slope, 1e-10 * E) << s;
    EXPECT_NEAR(batch.energy()[0], left * G * energy, 1e-10 * E);
    EXPECT_NEAR(batch.field("damage")[0], 1 - left, 1e-12);
    batch.accept();
  }
  EXPECT_GT(largest, 5 * e0);
}

// Uniaxial strain: the stress is that of the undamaged law times what is left.
TEST_P(Laws, DamageWeakensASolidForGood) {
  const double e0 = 0.05, e1 = 0.2;
  ModelInstance model(load_plugin(SUTURE_PLUGIN_FOLDER, "damage", GetParam()).models[0],
                      {law::mu, law::lambda, 1000, e0, e1});
  HexahedronBatch batch(model, model.functor("parallelepipeds, mean gradient"), unit_cubes());
  double largest = e0;
  for (const double s : {1.01, 1.1, 1.3, 1.1, 0.9, 1.4}) {
    const double untouched = pull(batch, 1.02);
    pull(batch, 2);  // not accepted
    EXPECT_EQ(pull(batch, 1.02), untouched);
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    F(0, 0) = s;
    const double intact = law::neo_hookean_energy(F, law::mu);
    largest = std::max(largest, std::sqrt(2 * intact / law::mu));
    const double left = e0 / largest * std::exp((e0 - largest) / e1);
    EXPECT_NEAR(pull(batch, s), left * law::neo_hookean(F, law::mu)(0, 0), 1e-10 * law::mu) << s;
    EXPECT_NEAR(batch.energy()[0], left * intact, 1e-10 * law::mu);
    EXPECT_NEAR(batch.field("largest")[0], largest, 1e-12);
    batch.accept();
  }
  EXPECT_GT(largest, 5 * e0);
}

}  // namespace
