// SPDX-License-Identifier: GPL-3.0-or-later
//
// Equilibria beside closed forms: homogeneous deformations of every law, torsion, and a bar that
// hangs.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "kernel/dynamics/hourglass.hpp"
#include "tests/run/equilibrium.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double young = 400e3, poisson = 0.3;
constexpr double mu = young / (2 * (1 + poisson));
constexpr double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));

/// Solved as far as the closed forms are compared.
Scene precise(Scene scene) {
  scene.solver.step_tolerance = 1e-10;
  return scene;
}

// ------------------------------------------------------------------- homogeneous --

// First Piola-Kirchhoff stresses at a gradient F, Pa.

Matrix3d st_venant_kirchhoff(const Matrix3d& F) {
  const Matrix3d E = (F.transpose() * F - Matrix3d::Identity()) / 2;
  return F * (lambda * E.trace() * Matrix3d::Identity() + 2 * mu * E);
}

Matrix3d neo_hooke(const Matrix3d& F) {
  const Matrix3d inverse = F.inverse().transpose();
  return mu * (F - inverse) + lambda * std::log(F.determinant()) * inverse;
}

/// Springs along `rest` of a unit cube whose stiffnesses sum to k: k/2 (|F rest| - |rest|)^2.
Matrix3d springs(const Matrix3d& F, const Vector3d& rest, double k) {
  const Vector3d now = F * rest;
  return k * (1 - rest.norm() / now.norm()) * now * rest.transpose();
}

/// Baudet's cube: four edges along each axis, four inner diagonals.
Matrix3d baudet(const Matrix3d& F) {
  const double inner = 3 * young / (8 * (1 + poisson)),
               edge = young * (1 + 4 * poisson) / (8 * (1 + poisson));
  Matrix3d P = Matrix3d::Zero();
  for (int a = 0; a < 3; ++a) P += springs(F, Vector3d::Unit(a), 4 * edge);
  for (const double y : {-1.0, 1.0})
    for (const double z : {-1.0, 1.0}) P += springs(F, {1, y, z}, inner);
  return P;
}

/// Springs between all nodes of a cube, and its volume.
Matrix3d golec(const Matrix3d& F) {
  const double inner = 3 * mu / 7, J = F.determinant();
  Matrix3d P = (lambda - mu) * (J - 1) * J * F.inverse().transpose();
  for (int a = 0; a < 3; ++a) {
    P += springs(F, Vector3d::Unit(a), 4 * 11 * mu / 28);
    for (const double sign : {-1.0, 1.0})
      P += springs(F, Vector3d::Unit(a) + sign * Vector3d::Unit((a + 1) % 3), 2 * inner / 2);
  }
  for (const double y : {-1.0, 1.0})
    for (const double z : {-1.0, 1.0}) P += springs(F, {1, y, z}, inner);
  return P;
}

/// Baudet's cube with the model `volume` beside it.
constexpr double kappa = 10 * young;
Matrix3d baudet_and_volume(const Matrix3d& F) {
  const double J = F.determinant();
  return baudet(F) + kappa * (J - 1) * J * F.inverse().transpose();
}

struct Law {
  const char *name, *model;
  std::map<std::string, double> values;
  Matrix3d (*stress)(const Matrix3d& F);
  bool is_solid = true;
  std::map<std::string, double> of_volume{};  ///< parameters of `volume`; empty: without it
};

void PrintTo(const Law& law, std::ostream* out) { *out << law.name; }

const std::map<std::string, double> engineering{{"E", young}, {"nu", poisson}, {"rho", 1000}},
    of_lame{{"mu", mu}, {"lambda", lambda}, {"rho", 1000}};

std::map<std::string, double> with(std::map<std::string, double> values, const char* name,
                                   double value) {
  values[name] = value;
  return values;
}

const Law laws[] = {
    {"StVenantKirchhoff_trilinear", "tm-faure", with(engineering, "element", 0),
     st_venant_kirchhoff},
    {"StVenantKirchhoff_mean_gradient", "tm-faure", with(engineering, "element", 1),
     st_venant_kirchhoff},
    {"NeoHooke_trilinear", "neo-hooke", with(of_lame, "element", 0), neo_hooke},
    {"NeoHooke_mean_gradient", "neo-hooke", with(of_lame, "element", 1), neo_hooke},
    {"Springs", "mss-baudet", engineering, baudet, false},
    {"SpringsAndVolume", "mss-golec", engineering, golec, false},
};

void add_volume(Scene& scene, const std::map<std::string, double>& values) {
  ModelUse volume = scene.models.front();
  volume.name = "volume";
  volume.model = &host().model("volume");
  volume.parameters = parameters(*volume.model, values);
  scene.models.push_back(volume);
}

class ClosedForm : public testing::TestWithParam<Law> {
 protected:
  /// A unit cube of 2 x 2 x 2 elements.
  Scene cube() const {
    const Law& law = GetParam();
    Scene scene = precise(block(host(), law.model, {1, 1, 1}, {2, 2, 2}, law.values));
    if (!law.of_volume.empty()) add_volume(scene, law.of_volume);
    return scene;
  }
  Matrix3d stress(const Matrix3d& F) const { return GetParam().stress(F); }

  /// The lateral stretch at which the lateral stress vanishes, by Newton's method on slopes by
  /// central differences.
  double lateral_stretch(double stretch) const {
    const auto lateral = [&](double t) {
      return stress(Vector3d(stretch, t, t).asDiagonal())(1, 1);
    };
    double t = 1;
    for (int i = 0; i < 20; ++i) t -= lateral(t) * 2e-6 / (lateral(t + 1e-6) - lateral(t - 1e-6));
    return t;
  }
};

INSTANTIATE_TEST_SUITE_P(Every, ClosedForm, testing::ValuesIn(laws),
                         [](const auto& test) { return test.param.name; });
// What resists hourglasses does not act on uniform deformations of boxes that stay boxes.
INSTANTIATE_TEST_SUITE_P(ClosedFormsOfTwoModels, ClosedForm,
                         testing::Values(Law{"BaudetAndVolume",
                                             "mss-baudet",
                                             engineering,
                                             baudet_and_volume,
                                             false,
                                             {{"kappa", kappa}, {"hourglass", mu}}}),
                         [](const auto& test) { return test.param.name; });

TEST_P(ClosedForm, UniaxialTensionAndCompression) {
  for (const double stretch : {0.85, 1.01, 1.1, 1.3}) {
    Scene scene = cube();
    for (int c = 0; c < 3; ++c) {
      Vec3 plane{any, any, any};
      plane[static_cast<std::size_t>(c)] = 0;
      hold(scene, at(plane), static_cast<std::uint8_t>(1 << c));
    }
    hold(scene, at({1, any, any}), 1, {stretch - 1, 0, 0});
    Equilibrium found(scene);
    const double lateral = lateral_stretch(stretch);
    const Matrix3d F = Vector3d(stretch, lateral, lateral).asDiagonal();
    EXPECT_LT(found.distance([&](const Vector3d& x) -> Vector3d { return F * x; }), 1e-8);
    EXPECT_NEAR(found.reaction(at({1, any, any}))[0], stress(F)(0, 0), 1e-8 * young) << stretch;
  }
}

// u_x = h (-1)^(j + k), which springs of Baudet do not resist: shears of +-2 h / l on two planes,
// whose squares have the mean 4 h^2 / 3 l^2 each.
TEST(ClosedForms, CheckerboardsHaveTheEnergyOfTheirShear) {
  constexpr double h = 1e-5, edge = 0.5;
  const auto energy = [](double hourglass) {
    Scene scene = block(host(), "mss-baudet", {1, 1, 1}, {2, 2, 2}, engineering);
    add_volume(scene, {{"kappa", kappa}, {"hourglass", hourglass}});
    Diagnostics diagnostics;
    BuiltScene built(scene, diagnostics);
    Column& x = built.body().attributes().position();
    for (Index v = 0; v < x.size(); ++v) {
      const auto number = [&](int c) { return std::lround((x.get(v, c) - x.get(0, c)) / edge); };
      x.set(v, 0, x.get(v, 0) + ((number(1) + number(2)) % 2 == 0 ? h : -h));
    }
    return built.body().energy(0);
  };
  const double expected = mu / 2 * 2 * (4 * h * h / (3 * edge * edge));  // of 1 m^3
  EXPECT_LT(energy(0), 1e-3 * expected);
  EXPECT_NEAR(energy(mu) - energy(0), expected, 1e-3 * expected);
}

// The paper's cantilever under its whole weight. Alone, the springs hourglass.
TEST(ClosedForms, SpringsBesideVolumesKeepThemAndStaySmooth) {
  const auto content = [](bool with_volume) {
    Scene scene = beam(host(), "mss-baudet", 12, 3, 9.8, {{"nu", 0.25}});
    if (with_volume) add_volume(scene, {{"kappa", 300 * young}, {"hourglass", 0.4 * young}});
    Equilibrium found(scene);
    Attributes& attributes = found.body().attributes();
    if (with_volume) {
      const Instance& volume = *attributes.instances().back();
      std::vector<double> change(volume.table(3).cells.size());
      EXPECT_TRUE(found.body().models().compute_field(volume, 3, "volume_change", 1, change));
      for (const double c : change) EXPECT_LT(std::abs(c), 1e-3);
    }
    double largest = 0;
    const Hourglass hourglass = measure_hourglass(found.body().complex(), attributes);
    for (Index e = 0; e < hourglass.strain.size(); ++e)
      largest = std::max(largest, hourglass.content(e));
    return largest;
  };
  EXPECT_GT(content(false), 0.5);
  EXPECT_LT(content(true), 0.35);
}

// P = E s (s^2 - 1) / 2 and t^2 = 1 - nu (s^2 - 1); values of an independent program (DOLFINx).
TEST(ClosedForms, StVenantKirchhoffInTensionHasTheValuesOfAnIndependentProgram) {
  const struct {
    double stretch, stress, lateral, energy;
  } expected[] = {{1.01, 4060.2, 0.996980441132, 1.26253125},
                  {1.1, 46200, 0.967987603226, 137.8125},
                  {1.3, 179400, 0.890505474436, 1487.8125}};
  for (const auto& e : expected) {
    Scene scene = precise(block(host(), "tm-faure", {1, 0.25, 0.25}, {4, 1, 1}, engineering));
    scene.solver.step_tolerance = 1e-12;
    hold(scene, at({0, any, any}), 1);
    hold(scene, at({any, 0, any}), 2);
    hold(scene, at({any, any, 0}), 4);
    hold(scene, at({1, any, any}), 1, {e.stretch - 1, 0, 0});
    Equilibrium found(scene);
    const Vector3d end = found.displacement(at({1, 0.25, 0.25}));
    EXPECT_NEAR(found.reaction(at({1, any, any}))[0] / 0.0625, e.stress, 1e-8 * e.stress);
    EXPECT_NEAR(end[1], 0.25 * (e.lateral - 1), 1e-12);
    EXPECT_NEAR(found.energy(), e.energy, 1e-9 * e.energy);
  }
}

// x = X + gamma Y between a fixed and a moved plate; the tractions of the same stress on the two
// sides that are not prescribed.
TEST_P(ClosedForm, SimpleShear) {
  for (const double gamma : {0.01, 0.3}) {
    Matrix3d F = Matrix3d::Identity();
    F(0, 1) = gamma;
    const Matrix3d P = stress(F);
    const Vec3 side{P(0, 0), P(1, 0), P(2, 0)};
    Scene scene = cube();
    load(scene, at({0, any, any}), {-side[0], -side[1], -side[2]});
    load(scene, at({1, any, any}), side);
    hold(scene, at({any, any, 0}), 4);
    hold(scene, at({any, any, 1}), 4);
    hold(scene, at({any, 0, any}), 7);
    hold(scene, at({any, 1, any}), 7, {gamma, 0, 0});
    Equilibrium found(scene);
    EXPECT_LT(found.distance([&](const Vector3d& x) -> Vector3d { return F * x; }), 1e-8);
    const Vector3d top = found.reaction(at({any, 1, any}));
    EXPECT_NEAR(top[0], P(0, 1), 1e-8 * young) << gamma;
    EXPECT_NEAR(top[1], P(1, 1), 1e-8 * young) << gamma;
  }
}

// P12 = mu gamma + (lambda/2 + mu) gamma^3 and P22 = (lambda/2 + mu) gamma^2: what the test above
// compares with is right.
TEST(ClosedForms, StressesOfSimpleShear) {
  const double gamma = 0.3;
  Matrix3d F = Matrix3d::Identity();
  F(0, 1) = gamma;
  const Matrix3d P = st_venant_kirchhoff(F), Q = neo_hooke(F);
  EXPECT_NEAR(P(0, 1), mu * gamma + (lambda / 2 + mu) * std::pow(gamma, 3), 1e-9 * mu);
  EXPECT_NEAR(P(1, 1), (lambda / 2 + mu) * gamma * gamma, 1e-9 * mu);
  EXPECT_NEAR(P(2, 2), lambda / 2 * gamma * gamma, 1e-9 * mu);
  EXPECT_NEAR(Q(0, 1), mu * gamma, 1e-9 * mu);
}

// --------------------------------------------------------------------- torsion --

// Torque over angle of a bar that may warp, with n x n elements over the section: the motion is
// linear along the bar and bilinear over the section but for the warping, so two layers are enough.
double torsional_stiffness(const Law& law, Index n) {
  constexpr double side = 0.25, angle = 1e-5;
  Scene scene = precise(block(host(), law.model, {1, side, side}, {2, n, n}, law.values));
  hold(scene, at({0, any, any}), 6);
  hold(scene, at({0, side / 2, side / 2}), 7);
  Constraint& turned = hold(scene, at({1, any, any}), 6);
  turned.axis = {1, 0, 0};
  turned.centre = {1, side / 2, side / 2};
  turned.angle = angle;
  turned.moves = true;
  return Equilibrium(scene).moment(at({1, any, any}))[0] / angle;
}

// de Saint-Venant: J = a^4 (1/3 - 64/pi^5 sum tanh((2 k + 1) pi / 2) / (2 k + 1)^5) = 0.140577 a^4.
double torsion_constant(double side) {
  double sum = 0;
  for (int k = 0; k < 20; ++k)
    sum += std::tanh((2 * k + 1) * std::numbers::pi / 2) / std::pow(2 * k + 1, 5);
  return std::pow(side, 4) * (1.0 / 3 - 64 / std::pow(std::numbers::pi, 5) * sum);
}

TEST(ClosedForms, TorsionOfASquareBarConvergesToSaintVenants) {
  const double exact = mu * torsion_constant(0.25);
  EXPECT_NEAR(exact, 84.481, 1e-3) << "N m^2";
  for (const Law& law : laws) {
    if (!law.is_solid) continue;
    double stiffness[3];
    for (const Index i : {0u, 1u, 2u}) stiffness[i] = torsional_stiffness(law, 4u << i);
    const auto error = [&](int i) { return std::abs(stiffness[i] / exact - 1); };
    EXPECT_NEAR(std::log2(error(1) / error(2)), 2, 0.1) << law.name;
    EXPECT_NEAR((4 * stiffness[2] - stiffness[1]) / 3, exact, 1e-4 * exact) << law.name;
  }
}

// ---------------------------------------------------------------------- order --

/// A bar of length 1 along x that hangs from a traction, small enough to be linear.
class HangingBar {
 public:
  HangingBar(const Law& law, Index n) : cells_{4 * n, n, n}, found_(scene(law, cells_)) {}

  /// The norm in L2 of the error of the displacements over that of the displacements, with 3^3
  /// points per element.
  double error() {
    const double point = std::sqrt(0.6), points[] = {-point, 0, point},
                 weights[] = {5. / 9, 8. / 9, 5. / 9};
    double error = 0, norm = 0;
    const CellComplex& complex = found_.body().complex();
    for (Index e = 0; e < complex.element_count(); ++e)
      for (int i = 0; i < 27; ++i) {
        const int x = i % 3, y = i / 3 % 3, z = i / 9;
        const auto [place, u] = sample(complex.vertices_of(e), {points[x], points[y], points[z]});
        const double weight = weights[x] * weights[y] * weights[z];
        error += weight * (u - exact(place)).squaredNorm();
        norm += weight * exact(place).squaredNorm();
      }
    return std::sqrt(error / norm);
  }

 private:
  static constexpr double side = 0.25, rho = 1000, g = 1e-3;

  static Scene scene(const Law& law, const std::array<Index, 3>& cells) {
    Scene scene = precise(block(host(), law.model, {1, side, side}, cells, law.values));
    scene.gravity = {g, 0, 0};
    hold(scene, at({any, 0, any}), 2);
    hold(scene, at({any, any, 0}), 4);
    hold(scene, at({0, 0, 0}), 7);
    load(scene, at({0, any, any}), {-rho * g, 0, 0});
    return scene;
  }

  /// sigma_xx = rho g (1 - x), all others zero (Timoshenko and Goodier: Theory of Elasticity, 96).
  static Vector3d exact(const Vector3d& p) {
    const double c = rho * g / young, x = p[0], y = p[1], z = p[2];
    return {c * (x - x * x / 2) - c * poisson / 2 * (y * y + z * z), -c * poisson * (1 - x) * y,
            -c * poisson * (1 - x) * z};
  }

  /// Place and displacement at local coordinates -1 .. 1 of an element.
  std::pair<Vector3d, Vector3d> sample(const Hexahedron& corners, const Vector3d& at) {
    Attributes& attributes = found_.body().attributes();
    std::pair<Vector3d, Vector3d> result{Vector3d::Zero(), Vector3d::Zero()};
    for (unsigned i = 0; i < 8; ++i) {
      double shape = 1;
      for (int c = 0; c < 3; ++c) shape *= (1 + ((i >> c & 1) != 0 ? at[c] : -at[c])) / 2;
      for (int c = 0; c < 3; ++c) {
        const double rest = attributes.rest().get(corners[i], c);
        result.first[c] += shape * rest;
        result.second[c] += shape * (attributes.position().get(corners[i], c) - rest);
      }
    }
    return result;
  }

  std::array<Index, 3> cells_;
  Equilibrium found_;
};

TEST(ClosedForms, TheErrorOfASmoothSolutionFallsWithTheSquareOfTheElements) {
  for (const Law& law : laws) {
    if (!law.is_solid) continue;
    const double coarse = HangingBar(law, 2).error(), fine = HangingBar(law, 4).error();
    EXPECT_LT(coarse, 0.01) << law.name;
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << law.name;
  }
}

}  // namespace
}  // namespace suture::test
