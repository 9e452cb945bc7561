// SPDX-License-Identifier: GPL-3.0-or-later
//
// The element that does not lock, through two plugins: tm-faure (half of F') and neo-hooke
// (both halves, moduli from the energy alone), for every instruction set.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/plugins/plugin_batch.hpp"
#include "tests/sdk/enhanced_reference.hpp"

namespace {

using namespace suture::test;
using Batch = suture::AlignedVector<double>;

constexpr double young = 100, poisson = 0.3, size = 0.5;
constexpr double force_scale = young * size * size;
const char* const boxes = "parallelepipeds, mean gradient";
const char* const general = "general hexahedra, mean gradient";
enum Form { box, parallelepiped, distorted };

struct Use {
  std::string isa, law;
};
std::vector<Use> uses() {
  std::vector<Use> all;
  for (const auto& isa : runnable_isas())
    for (const char* law : {"tm-faure", "neo-hooke"}) all.push_back({isa, law});
  return all;
}

Hexahedron box_of(double a, double b, double c) {
  Hexahedron X;
  for (int n = 0; n < 8; ++n) X[n] = {(n & 1) * a, ((n >> 1) & 1) * b, (n >> 2) * c};
  return X;
}
Hexahedron mapped(const Hexahedron& X, const Eigen::Matrix3d& A) {
  Hexahedron x;
  for (int n = 0; n < 8; ++n)
    for (int i = 0; i < 3; ++i) x[n][i] = A(i, 0) * X[n][0] + A(i, 1) * X[n][1] + A(i, 2) * X[n][2];
  return x;
}

/// The stiffness -df/dx of each lane, from the tangent.
std::array<Stiffness, 8> stiffness(HexahedronBatch& batch) {
  std::array<Stiffness, 8> K;
  for (int j = 0; j < 24; ++j) {
    Batch dx(192, 0.0);
    for (int lane = 0; lane < 8; ++lane) dx[j * 8 + lane] = 1;
    const Batch df = batch.tangent(dx);
    for (int i = 0; i < 24; ++i)
      for (int lane = 0; lane < 8; ++lane) K[lane](i, j) = -df[i * 8 + lane];
  }
  return K;
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& K) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>((K + K.transpose()) / 2).eigenvalues();
}

class MeanGradient : public testing::TestWithParam<Use> {
 protected:
  const suture_model& model() { return model(GetParam().law); }
  const suture_model& model(const std::string& law) {
    const bool own = law == "neo-hooke";
    return load_plugin(own ? SUTURE_PLUGIN_FOLDER : SUTURE_BUILT_PLUGINS, law, GetParam().isa)
        .models[0];
  }
  std::vector<double> parameters(double E = young, double nu = poisson) {
    const Stvk law(E, nu);
    if (GetParam().law == "neo-hooke") return {law.mu, law.lambda, 1, 1};
    return {E, nu, 1, 0, 0, 1};
  }
  double uniform(double a) { return std::uniform_real_distribution<>(-a, a)(random); }
  Hexahedron disturbed(Hexahedron x, double amplitude) {
    for (auto& p : x)
      for (auto& c : p) c += uniform(amplitude);
    return x;
  }
  Eigen::Matrix3d near_identity(double amplitude) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 9; ++i) A(i) += uniform(amplitude);
    return A;
  }
  std::array<Hexahedron, 8> elements(Form form) {
    std::array<Hexahedron, 8> all;
    for (auto& X : all) {
      X = box_of(size * (1 + uniform(.3)), size * (1 + uniform(.3)), size * (1 + uniform(.3)));
      if (form == parallelepiped) X = mapped(X, near_identity(.3));
      if (form == distorted) X = disturbed(X, 0.15 * size);
    }
    return all;
  }

  std::mt19937 random{20261122};
};

const char* functor_of(Form form) { return form == distorted ? general : boxes; }
constexpr Form forms[] = {box, parallelepiped, distorted};

// For a constant gradient P is constant, and the trilinear element integrates grad N exactly.
TEST_P(MeanGradient, HasTheForcesOfTheTrilinearElementUnderConstantGradients) {
  for (const Form form : forms) {
    ModelInstance instance(model(), parameters());
    const auto rest = elements(form);
    HexahedronBatch batch(instance, instance.functor(functor_of(form)), rest);
    const char* const trilinear =
        form == distorted ? "general hexahedra, geometry stored" : "parallelepipeds";
    HexahedronBatch full(instance, instance.functor(trilinear), rest);
    for (int lane = 0; lane < 8; ++lane) {
      const Hexahedron x = mapped(rest[lane], near_identity(.3));
      batch.move(lane, x);
      full.move(lane, x);
    }
    ASSERT_EQ(batch.force(), SUTURE_OK) << instance.error.text;
    ASSERT_EQ(full.force(), SUTURE_OK);
    const auto energy = batch.energy(), energy_of_full = full.energy();
    const auto stress = batch.field("stress"), stress_of_full = full.field("stress");
    for (int i = 0; i < 192; ++i)
      EXPECT_NEAR(batch.batch.force[i], full.batch.force[i], 1e-12 * force_scale) << form;
    for (int i = 0; i < 48; ++i) EXPECT_NEAR(stress[i], stress_of_full[i], 1e-12 * young);
    for (int lane = 0; lane < 8; ++lane) EXPECT_NEAR(energy[lane] / energy_of_full[lane], 1, 1e-12);
  }
}

TEST_P(MeanGradient, PassesThePatchTest) {
  Point inner{size * .9, size * 1.15, size * 1.05};
  std::array<Hexahedron, 8> rest;
  for (int e = 0; e < 8; ++e)
    for (int n = 0; n < 8; ++n) {
      for (int c = 0; c < 3; ++c) rest[e][n][c] = size * (((e >> c) & 1) + ((n >> c) & 1));
      if (n == 7 - e) rest[e][n] = inner;
    }
  ModelInstance instance(model(), parameters());
  HexahedronBatch batch(instance, instance.functor(general), rest);
  const Eigen::Matrix3d F = near_identity(.3);
  for (int e = 0; e < 8; ++e) batch.move(e, mapped(rest[e], F));
  ASSERT_EQ(batch.force(), SUTURE_OK) << instance.error.text;
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (int e = 0; e < 8; ++e) sum += batch.force_at(e, 7 - e, c);
    EXPECT_NEAR(sum, 0, 1e-12 * force_scale);
  }
}

TEST_P(MeanGradient, ForceAndTangentAreDerivativesOfTheEnergy) {
  for (const Form form : forms) {
    ModelInstance instance(model(), parameters());
    const auto rest = elements(form);
    HexahedronBatch batch(instance, instance.functor(functor_of(form)), rest);
    for (int lane = 0; lane < 8; ++lane) batch.move(lane, disturbed(rest[lane], 0.15 * size));
    const auto K = stiffness(batch);
    for (const Stiffness& k : K) EXPECT_LT((k - k.transpose()).norm(), 1e-13 * k.norm());
    ASSERT_EQ(batch.force(), SUTURE_OK) << instance.error.text;
    const Batch force(batch.batch.force, batch.batch.force + 192);
    const double h = 1e-5 * size;
    for (int i = 0; i < 24; ++i) {
      const auto at = [&](double step) {
        for (int lane = 0; lane < 8; ++lane) batch.position(lane, i / 3, i % 3) += step;
        EXPECT_EQ(batch.force(), SUTURE_OK);
        return std::pair(Batch(batch.batch.force, batch.batch.force + 192), batch.energy());
      };
      const auto high = at(h), low = at(-2 * h);
      at(h);
      for (int lane = 0; lane < 8; ++lane) {
        EXPECT_NEAR((low.second[lane] - high.second[lane]) / (2 * h), force[i * 8 + lane],
                    1e-8 * force_scale);
        for (int j = 0; j < 24; ++j)
          EXPECT_NEAR((low.first[j * 8 + lane] - high.first[j * 8 + lane]) / (2 * h), K[lane](j, i),
                      1e-8 * young * size);
      }
    }
  }
}

TEST_P(MeanGradient, IsObjective) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix();
  for (const Form form : forms) {
    ModelInstance instance(model(), parameters());
    const auto rest = elements(form);
    HexahedronBatch batch(instance, instance.functor(functor_of(form)), rest);
    std::array<Hexahedron, 8> x;
    for (int lane = 0; lane < 8; ++lane) batch.move(lane, x[lane] = disturbed(rest[lane], 0.1));
    ASSERT_EQ(batch.force(), SUTURE_OK) << instance.error.text;
    const Batch force(batch.batch.force, batch.batch.force + 192);
    const auto energy = batch.energy();
    for (int lane = 0; lane < 8; ++lane) batch.move(lane, mapped(x[lane], R));
    ASSERT_EQ(batch.force(), SUTURE_OK);
    const auto turned = batch.energy();
    for (int lane = 0; lane < 8; ++lane) {
      EXPECT_NEAR(turned[lane] / energy[lane], 1, 1e-12);
      for (int n = 0; n < 8; ++n)
        for (int i = 0; i < 3; ++i) {
          double expected = 0;
          for (int j = 0; j < 3; ++j) expected += R(i, j) * force[(n * 3 + j) * 8 + lane];
          EXPECT_NEAR(batch.force_at(lane, n, i), expected, 1e-12 * force_scale);
        }
    }
  }
}

TEST_P(MeanGradient, EqualsTheEnhancedElementAtRest) {
  for (const double nu : {-0.3, 0.0, 0.3, 0.499})
    for (const Form form : {box, parallelepiped}) {
      ModelInstance instance(model(), parameters(young, nu));
      const auto rest = elements(form);
      HexahedronBatch batch(instance, instance.functor(boxes), rest);
      const auto K = stiffness(batch);
      for (int lane = 0; lane < 8; ++lane) {
        const Stiffness expected = enhanced_stiffness(rest[lane], Stvk(young, nu));
        EXPECT_LT((K[lane] - expected).norm(), 1e-12 * expected.norm()) << "nu " << nu << form;
      }
    }
}

TEST_P(MeanGradient, ResistsEveryMotionButRigidOnesOnDistortedElements) {
  for (const double nu : {0.0, 0.3, 0.499}) {
    ModelInstance instance(model(), parameters(young, nu));
    const auto rest = elements(distorted);
    HexahedronBatch batch(instance, instance.functor(general), rest);
    const auto K = stiffness(batch);
    for (int lane = 0; lane < 8; ++lane) {
      const auto values = eigenvalues(K[lane]);
      const auto expected = eigenvalues(enhanced_stiffness(rest[lane], Stvk(young, nu)));
      EXPECT_NEAR(values[5], 0, 1e-12 * values[23]);
      EXPECT_GT(values[6], 0.7 * expected[6]);
      EXPECT_LT(values[6], 1.4 * expected[6]);
    }
  }
}

TEST_P(MeanGradient, StoresTheHourglassEnergyInItsField) {
  ModelInstance instance(model(), parameters());
  const auto rest = elements(distorted);
  HexahedronBatch batch(instance, instance.functor(general), rest);
  for (int lane = 0; lane < 8; ++lane) batch.move(lane, disturbed(rest[lane], 0.1));
  const auto energy = batch.energy();
  const auto density = batch.field("energy_density");
  for (int lane = 0; lane < 8; ++lane) {
    const double volume = stvk_reference(rest[lane], rest[lane], Stvk(1, 0), 2).volume;
    EXPECT_NEAR(density[lane] * volume / energy[lane], 1, 1e-12);
  }
}

TEST_P(MeanGradient, EndsAtPositionsThatAreNotFinite) {
  ModelInstance instance(model(), parameters());
  const auto rest = elements(distorted);
  HexahedronBatch batch(instance, instance.functor(general), rest);
  batch.position(3, 6, 1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(batch.force(), SUTURE_STOP);
  EXPECT_EQ(instance.error.cell, 13u);
}

INSTANTIATE_TEST_SUITE_P(Isa, MeanGradient, testing::ValuesIn(uses()), [](const auto& use) {
  return use.param.isa + (use.param.law == "tm-faure" ? "TmFaure" : "NeoHooke");
});

// ---------------------------------------------------------------- one law --

const suture_model& best(const std::string& law) {
  return load_plugin(law == "tm-faure" ? SUTURE_BUILT_PLUGINS : SUTURE_PLUGIN_FOLDER, law,
                     runnable_isas().back())
      .models[0];
}

/// The hourglass motions of a cube: four sign patterns for each component, orthonormal.
Eigen::Matrix<double, 24, 12> hourglasses() {
  Eigen::Matrix<double, 24, 12> H = Eigen::Matrix<double, 24, 12>::Zero();
  for (int n = 0; n < 8; ++n) {
    const int x = n & 1 ? 1 : -1, y = n & 2 ? 1 : -1, z = n & 4 ? 1 : -1;
    const int pattern[] = {y * z, z * x, x * y, x * y * z};
    for (int k = 0; k < 4; ++k)
      for (int c = 0; c < 3; ++c) H(3 * n + c, 3 * k + c) = pattern[k] / std::sqrt(8.0);
  }
  return H;
}

struct State {
  const char* name;
  Eigen::Matrix3d F;
};
/// States of constant volume.
std::vector<State> states() {
  const auto stretch = [](double x, double y) -> Eigen::Matrix3d {
    return Eigen::Vector3d(x, y, 1 / (x * y)).asDiagonal();
  };
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = 0.5;
  return {{"rest", stretch(1, 1)},
          {"compression", stretch(0.6, 1 / std::sqrt(0.6))},
          {"tension", stretch(1.5, 1 / std::sqrt(1.5))},
          {"shear", shear},
          {"biaxial", stretch(0.7, 0.7)}};
}

// The trilinear element has negative hourglass eigenvalues in compression and biaxial compression.
TEST(MeanGradientStates, HaveNoNegativeHourglassEigenvalue) {
  const Stvk law(1, 0.49);
  ModelInstance instance(best("neo-hooke"), {law.mu, law.lambda, 1, 1});
  std::array<Hexahedron, 8> rest;
  rest.fill(box_of(1, 1, 1));
  HexahedronBatch batch(instance, instance.functor(boxes), rest);
  HexahedronBatch full(instance, instance.functor("parallelepipeds"), rest);
  const auto H = hourglasses();
  for (const State& state : states()) {
    batch.move(0, mapped(rest[0], state.F));
    full.move(0, mapped(rest[0], state.F));
    const double smallest = eigenvalues(H.transpose() * stiffness(batch)[0] * H)[0];
    const double of_full = eigenvalues(H.transpose() * stiffness(full)[0] * H)[0];
    EXPECT_GT(smallest, 0.05) << state.name;
    EXPECT_GT(smallest, of_full - 1e-3) << state.name;
  }
}

std::string keys(const ModelInstance& instance) {
  std::string all;
  for (const Report& r : instance.reports) all += std::to_string(r.severity) + r.key + ' ';
  return all;
}

TEST(MeanGradientModel, ReportsWhatItCannotUse) {
  EXPECT_EQ(keys(ModelInstance(best("tm-faure"), {1, 0.499, 1, 0, 0, 1})), "");
  EXPECT_EQ(keys(ModelInstance(best("tm-faure"), {1, 0.3, 1, 1, 0, 1})), "1points-not-used ");
  const ModelInstance soft(best("neo-hooke"), {0, 1, 1, 1});
  EXPECT_EQ(keys(soft), "2no-stiffness-at-rest ");
  EXPECT_NE(soft.reports[0].text.find("mu = 0.0"), std::string::npos) << soft.reports[0].text;
  EXPECT_EQ(keys(ModelInstance(best("neo-hooke"), {0, 1, 1, 0})), "");
}

TEST(MeanGradientModel, IsTheDefaultOfLawsThatNameNone) {
  const auto& last = [](const suture_model& m) { return m.parameters[m.parameter_count - 1]; };
  EXPECT_STREQ(last(best("neo-hooke")).name, "element");
  EXPECT_STREQ(last(best("neo-hooke")).choices[1], "mean-gradient");
  EXPECT_EQ(last(best("neo-hooke")).default_value, 1);
  EXPECT_EQ(last(best("tm-faure")).default_value, 0);
}

}  // namespace
