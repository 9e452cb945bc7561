// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lowest mode compared with dense solvers and closed forms, and how a run uses it.
#include "kernel/spectrum/modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/run/modal_run.hpp"
#include "kernel/spectrum/natural_modes.hpp"
#include "tests/reference/beam.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

LowestMode lowest_mode(BuiltScene& w, unsigned products = 600) {
  return find_lowest_mode(w.body(), w.dynamics().time(), products);
}

/// Eigenvalues of M^-1/2 K M^-1/2 on the free components, ascending, by a dense solver.
Eigen::VectorXd eigenvalues(BuiltScene& w) {
  const std::size_t size = 3 * std::size_t{w.body().attributes().vertex_count()};
  std::vector<double> direction(size), image(size);
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < size; ++i) {
    const auto v = static_cast<Index>(i / 3);
    const auto fixed = static_cast<int>(w.body().attributes().fixed().get(v, 0));
    if (w.body().attributes().mass().get(v, 0) > 0 && !(fixed >> i % 3 & 1)) free.push_back(i);
  }
  const auto root = [&](std::size_t i) {
    return std::sqrt(w.body().attributes().mass().get(static_cast<Index>(i / 3), 0));
  };
  Eigen::MatrixXd matrix(free.size(), free.size());
  for (std::size_t column = 0; column < free.size(); ++column) {
    direction.assign(size, 0);
    image.assign(size, 0);
    direction[free[column]] = 1;
    w.body().models().add_tangent(direction.data(), 1, 0, 0, image.data());
    for (std::size_t row = 0; row < free.size(); ++row)
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          -image[free[row]] / (root(free[row]) * root(free[column]));
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

/// Every vertex where `place` puts its rest position.
template <class Place>
void deform(BuiltScene& w, Place place) {
  for (Index v = 0; v < w.body().attributes().vertex_count(); ++v) {
    if (!w.body().complex().exists(0, v)) continue;
    const Column& rest = w.body().attributes().rest();
    const Vec3 x = place(Vec3{rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)});
    for (int c = 0; c < 3; ++c)
      w.body().attributes().position().set(v, c, x[static_cast<std::size_t>(c)]);
  }
  w.dynamics().motion().forget_forces();  // not start(): what is held is moved too
}

TEST(Tangent, InDoubleIsTheDerivativeOfTheForces) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    const Scene scene = beam(host(), model, 3, 2, 0);
    Diagnostics diagnostics;
    BuiltScene w(scene, diagnostics);
    w.dynamics().start();
    const std::size_t size = 3 * std::size_t{w.body().attributes().vertex_count()};
    std::mt19937 random(1);
    std::vector<double> direction(size), image(size);
    for (double& d : direction) d = random() / 4294967296.0 - 0.5;
    const auto forces_at = [&](double h) {
      std::size_t i = 0;
      deform(w, [&](Vec3 x) {
        for (double& c : x) c += h * direction[i++] + 0.02 * std::sin(10 * c);
        return x;
      });
      std::vector<double> force(size);
      Column& column = w.body().attributes().force();
      std::fill_n(column.rows(), std::size_t{column.size()} * 4, 0.0);
      w.body().models().add_forces(0, 0);
      for (std::size_t k = 0; k < size; ++k)
        force[k] = column.get(static_cast<Index>(k / 3), static_cast<int>(k % 3));
      std::fill_n(column.rows(), std::size_t{column.size()} * 4, 0.0);
      return force;
    };
    const double h = 1e-5;
    const std::vector<double> above = forces_at(h), below = forces_at(-h);
    forces_at(0);
    w.body().models().add_tangent(direction.data(), 1, 0, 0, image.data());
    double worst = 0, scale = 0;
    for (std::size_t k = 0; k < size; ++k) {
      worst = std::max(worst, std::abs((above[k] - below[k]) / (2 * h) - image[k]));
      scale = std::max(scale, std::abs(image[k]));
    }
    ASSERT_GT(scale, 1);
    EXPECT_LT(worst / scale, 1e-7) << model;
  }
}

struct State {
  const char* name;
  const char* model;
  double squeeze;  ///< stretch along x
  double bend;     ///< curvature, 1/m
  bool pierced;
};

class Modes : public testing::TestWithParam<State> {};
INSTANTIATE_TEST_SUITE_P(States, Modes,
                         testing::Values(State{"TensorMassAtRest", "tm-faure", 1, 0, false},
                                         State{"TensorMassPierced", "tm-faure", 1, 0, true},
                                         State{"TensorMassBent", "tm-faure", 1, 0.5, false},
                                         State{"TensorMassSqueezed", "tm-faure", 0.7, 0, false},
                                         State{"TensorMassSqueezedALittle", "tm-faure", 0.97, 0,
                                               false},
                                         State{"SpringsAtRest", "mss-baudet", 1, 0, false},
                                         State{"SpringsBent", "mss-baudet", 1, 1, false},
                                         State{"SpringsSqueezed", "mss-baudet", 0.9, 0, false},
                                         State{"SpringsPulled", "mss-baudet", 1.2, 0, true}),
                         [](const auto& state) { return std::string(state.param.name); });

// Also the checkerboards of bent and squeezed springs, of which the smooth motions have none.
TEST_P(Modes, TheLowestIsThatOfADenseSolver) {
  const State& state = GetParam();
  const Scene scene = beam(host(), state.model, 10, 4, 0);
  Diagnostics diagnostics;
  BuiltScene w(scene, diagnostics);
  w.dynamics().start();
  if (state.pierced) {
    std::vector<Index> gone;
    std::mt19937 random(7);
    for (Index e = 0; e < w.body().complex().element_count(); ++e)
      if (random() % 5 == 0) gone.push_back(e);
    w.body().pierce(gone);
  }
  deform(w, [&](const Vec3& x) {
    if (state.bend == 0) return Vec3{x[0] * state.squeeze, x[1], x[2]};
    const double angle = state.bend * x[0], radius = 1 / state.bend - x[1] + 0.125;
    return Vec3{radius * std::sin(angle), 1 / state.bend - radius * std::cos(angle), x[2]};
  });
  const LowestMode mode = lowest_mode(w);
  const double expected = eigenvalues(w)[0];
  EXPECT_LE(mode.products, 601u);
  EXPECT_EQ(mode.negative(), expected < -mode.noise) << mode.eigenvalue << ", " << expected;
  EXPECT_NEAR(mode.eigenvalue, expected, 0.2 * std::abs(expected) + mode.noise);
  double longest = 0;
  for (const Vec3& u : mode.shape) longest = std::max(longest, std::hypot(u[0], u[1], u[2]));
  EXPECT_NEAR(longest, 1, 1e-12);
}

TEST(Modes, OfAFreeBodyAtRestAreRigid) {
  Scene scene = beam(host(), "tm-faure", 6, 3, 0);
  scene.constraints.clear();
  Diagnostics diagnostics;
  BuiltScene w(scene, diagnostics);
  w.dynamics().start();
  const LowestMode mode = lowest_mode(w);
  EXPECT_FALSE(mode.negative());
  EXPECT_LT(std::abs(mode.eigenvalue), 10 * mode.noise);
}

TEST(Modes, OfABodyWithoutAFreeComponentThereAreNone) {
  Scene scene = beam(host(), "tm-faure", 2, 1, 0);
  scene.constraints[0].where.what = Selection::All{};
  Diagnostics diagnostics;
  BuiltScene w(scene, diagnostics);
  w.dynamics().start();
  EXPECT_FALSE(lowest_mode(w).negative());
}

/// A straight column, clamped at the foot, under `factor` times its Euler load.
Scene column(Index nx, Index n, double factor) {
  Scene scene = beam(host(), "tm-faure", nx, n, 0, {{"E", 1e6}});
  scene.mesh.box->size = {1, 0.1, 0.1};
  const double euler = std::pow(std::numbers::pi / 2, 2) * 1e6 * 1e-4 / 12;  // N
  Load load;
  load.kind = Load::Kind::traction;
  load.value = {-factor * euler / 0.01, 0, 0};
  load.where.what = Selection::Named{"x1"};
  load.ramp = {0, 1, false};
  scene.loads.push_back(load);
  scene.solver.until_rest = true;
  scene.solver.automatic_damping = true;
  scene.solver.threads = 1;
  return scene;
}

struct Result {
  RunSummary summary;
  std::string warnings;
  double deflection;
};

Result run(const Scene& scene) {
  TestSimulation simulation(scene);
  Result result{simulation.run(), {}, 0};
  for (const auto& warning : simulation.diagnostics.warnings()) result.warnings += warning + "\n";
  Selection end;
  end.what = Selection::Named{"x1"};
  const Vec3 tip = simulation.mean_displacement(end);
  result.deflection = std::hypot(tip[1], tip[2]);
  return result;
}

// A slender beam under the share p of its Euler load has w^2 = w1^2 (1 - p), very nearly,
// w1 = 3.516 sqrt(EI / rho A) / L; the mesh is up to a fifth too stiff.
TEST(Column, IsStableBelowItsEulerLoadAndUnstableAbove) {
  const double first = std::pow(3.516, 2) * 1e6 * 0.01 / 12 / 1000;
  for (const Index n : {2u, 4u})
    for (const double factor : {0.8, 1.7, 3.0, 10.0}) {
      const Result result = run(column(5 * n, n, factor));
      ASSERT_TRUE(result.summary.lowest_eigenvalue);
      const double value = *result.summary.lowest_eigenvalue;
      EXPECT_EQ(result.summary.outcome, factor < 1 ? RunSummary::Outcome::at_rest
                                                   : RunSummary::Outcome::unstable_equilibrium)
          << n << ", " << factor;
      EXPECT_EQ(result.warnings.find("the equilibrium is unstable") != std::string::npos,
                factor > 1);
      EXPECT_LT(value, first * (1.7 - factor)) << n << ", " << factor;
      if (factor < 1)
        EXPECT_GT(value, 0) << n;
      else
        EXPECT_GT(value, 7 * first * (0.9 - factor)) << n << ", " << factor;
    }
}

TEST(Column, BucklesAfterAKick) {
  Scene scene = column(10, 2, 2.5);
  scene.solver.kick = 1e-3;
  const Result result = run(scene);
  EXPECT_EQ(result.summary.outcome, RunSummary::Outcome::at_rest) << result.warnings;
  EXPECT_GT(*result.summary.lowest_eigenvalue, 0);
  EXPECT_GT(result.deflection, 0.3) << "m";
}

// ------------------------------------------------------------- natural modes --

std::vector<double> frequencies(const NaturalModes& found) {
  std::vector<double> result;
  for (const NaturalMode& mode : found.modes) result.push_back(mode.frequency());
  return result;
}

/// A built scene at rest.
struct AtRest {
  explicit AtRest(const Scene& scene) : built(scene, diagnostics) { built.dynamics().start(); }
  NaturalModes modes(unsigned count) { return find_natural_modes(built.body(), 0, count); }
  Diagnostics diagnostics;
  BuiltScene built;
};

Scene free_beam(const std::string& model, Index nx, Index n) {
  Scene scene = beam(host(), model, nx, n, 0);
  scene.constraints.clear();
  return scene;
}

class CaseF : public testing::TestWithParam<reference::ModalBeam> {};
INSTANTIATE_TEST_SUITE_P(Beams, CaseF, testing::ValuesIn(reference::modal_beams),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(CaseF, FrequenciesAreThoseOfAnIndependentProgram) {
  const reference::ModalBeam& expected = GetParam();
  AtRest beam_at_rest(beam(host(), "tm-faure", static_cast<Index>(expected.cells_x),
                           static_cast<Index>(expected.cells_y), 0));
  const std::vector<double> found = frequencies(beam_at_rest.modes(8));
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_NEAR(found[i] / expected.frequencies[i], 1, 1e-7) << "mode " << i + 1;
}

// A chain of n equal masses, the last one half, and springs: K u = w^2 M u is solved by
// u = sin(k x), k = (2j - 1) pi / (2 L), w = 2 c / h sin(k h / 2), c^2 = (lambda + 2 mu) / rho.
TEST(NaturalModes, OfAConfinedBarHaveAClosedForm) {
  const Index n = 20;
  Scene scene = beam(host(), "tm-faure", n, 1, 0);
  scene.mesh.box->size = {1, 0.02, 0.02};
  Constraint confined = scene.constraints[0];
  confined.where.what = Selection::InBox{{-1, -1, -1}, {2, 2, 2}};
  confined.components = 6;
  scene.constraints.push_back(confined);
  AtRest bar(scene);
  const NaturalModes found = bar.modes(5);
  const double nu = 0.3, speed = std::sqrt(400 * (1 - nu) / ((1 + nu) * (1 - 2 * nu)));
  for (std::size_t j = 0; j < 5; ++j) {
    const double k = (2.0 * static_cast<double>(j) + 1) * std::numbers::pi / 2;
    EXPECT_NEAR(std::sqrt(found.modes[j].eigenvalue) / (2 * speed * n * std::sin(k / (2 * n))), 1,
                1e-8)
        << j;
  }
  const std::vector<Vec3>& shape = found.modes[0].shape;
  const Column& rest = bar.built.body().attributes().rest();
  for (Index v = 0; v < shape.size(); ++v)
    EXPECT_NEAR(shape[v][0], std::sin(rest.get(v, 0) * std::numbers::pi / 2), 1e-3) << v;
}

// Free springs have mechanisms besides the rigid motions.
TEST(NaturalModes, OfAFreeBodyBeginWithZeroes) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    AtRest body(free_beam(model, 8, 3));
    const Eigen::VectorXd expected = eigenvalues(body.built);
    const auto zeroes = (expected.array() < 1e-9 * expected.maxCoeff()).count();
    EXPECT_EQ(zeroes == 6, std::string(model) == "tm-faure") << zeroes;
    const NaturalModes found = body.modes(static_cast<unsigned>(zeroes) + 6);
    for (Eigen::Index i = 0; i < zeroes + 6; ++i) {
      const NaturalMode& mode = found.modes[static_cast<std::size_t>(i)];
      EXPECT_EQ(mode.kind == NaturalMode::Kind::zero, i < zeroes) << model << mode.eigenvalue;
      if (i < zeroes) continue;
      EXPECT_NEAR(mode.eigenvalue / expected[i], 1, 1e-6) << model;
    }
  }
}

struct Notch {
  const char* name;
  double depth;    ///< of the cut at half the length
  double squeeze;  ///< stretch along x
  std::ptrdiff_t zero;
};

class NotchedBeam : public testing::TestWithParam<Notch> {};
INSTANTIATE_TEST_SUITE_P(States, NotchedBeam,
                         testing::Values(Notch{"Whole", 0, 1, 0}, Notch{"Slit", 0.15, 1, 0},
                                         Notch{"CutInTwo", 1, 1, 6},
                                         Notch{"SqueezedALittle", 0.15, 0.97, 0},
                                         Notch{"Squeezed", 0.15, 0.8, 0}),
                         [](const auto& notch) { return std::string(notch.param.name); });

/// Cuts the beam of n x ... elements in the middle down to `depth`.
void cut_in_the_middle(BuiltScene& w, double depth) {
  const CellComplex& complex = w.body().complex();
  const auto centre = [&](Index e, int c) {
    double sum = 0;
    for (const Index v : complex.vertices_of(e)) sum += w.body().attributes().rest().get(v, c) / 8;
    return sum;
  };
  std::vector<Dart> faces;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (int f = 0; f < 6; ++f)
      if (const Index other = complex.neighbour(e, f);
          other != none && centre(e, 0) < 0.5 && centre(other, 0) > 0.5 && centre(e, 1) < depth)
        faces.push_back(24 * e + 4 * static_cast<Dart>(f));
  if (!faces.empty()) w.body().cut(faces);
}

TEST_P(NotchedBeam, HasTheModesOfADenseSolver) {
  AtRest body(beam(host(), "tm-faure", 8, 3, 0));
  cut_in_the_middle(body.built, GetParam().depth);
  deform(body.built, [](const Vec3& x) { return Vec3{x[0] * GetParam().squeeze, x[1], x[2]}; });
  const Eigen::VectorXd expected = eigenvalues(body.built);
  const NaturalModes found = body.modes(10);
  using Kind = NaturalMode::Kind;
  EXPECT_EQ(std::ranges::count(found.modes, Kind::zero, &NaturalMode::kind), GetParam().zero);
  const auto unstable = (expected.head(10).array() < -1e-9 * expected.maxCoeff()).count();
  EXPECT_EQ(unstable > 0, GetParam().squeeze < 1);
  EXPECT_EQ(std::ranges::count(found.modes, Kind::unstable, &NaturalMode::kind), unstable);
  for (std::size_t i = 0; i < 10; ++i) {
    const NaturalMode& mode = found.modes[i];
    if (mode.kind != Kind::zero) {
      EXPECT_NEAR(mode.eigenvalue / expected[static_cast<Eigen::Index>(i)], 1, 1e-6) << i;
    }
    double largest = 0;
    for (const Vec3& u : mode.shape)
      for (const double component : u)
        if (std::abs(component) > std::abs(largest)) largest = component;
    EXPECT_DOUBLE_EQ(largest, 1);
  }
}

TEST(NaturalModes, CanBeAllOfThem) {
  AtRest body(free_beam("tm-faure", 1, 1));
  const Eigen::VectorXd expected = eigenvalues(body.built);
  const NaturalModes found = body.modes(24);
  for (std::size_t i = 6; i < 24; ++i)
    EXPECT_NEAR(found.modes[i].eigenvalue / expected[static_cast<Eigen::Index>(i)], 1, 1e-8);
}

// w^2 = w1^2 (1 - p) under the share p of the Euler load, very nearly.
TEST(NaturalModes, AboutAnEquilibriumSeeItsLoads) {
  const auto lowest = [](double factor, bool at_equilibrium) {
    Scene scene = column(10, 2, factor);
    Diagnostics diagnostics;
    ModalRun run(scene, host(), diagnostics, {2, at_equilibrium});
    Observer nobody;
    const NaturalMode mode = run.solve(nobody).modes[0];
    EXPECT_EQ(diagnostics.warnings().size(), mode.kind == NaturalMode::Kind::unstable ? 1u : 0u);
    return mode.eigenvalue;
  };
  const double rest = lowest(0.5, false), half = lowest(0.5, true), twice = lowest(2, true);
  EXPECT_GT(half, 0.4 * rest);
  EXPECT_LT(half, 0.7 * rest);
  EXPECT_LT(twice, -0.3 * rest);
  EXPECT_NEAR((rest - twice) / (rest - half), 4, 0.5);
}

}  // namespace
}  // namespace suture::test
