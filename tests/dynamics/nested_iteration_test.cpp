// SPDX-License-Identifier: GPL-3.0-or-later
//
// Newton's method for equilibria far from the start begins on coarse levels, and where loads go on
// as before, at positions that go on as before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernel/implicit/newton.hpp"
#include "tests/dynamics/model_block.hpp"

namespace {

using suture::Index, suture::Vec3, suture::Newton;

constexpr Index across = 8;
constexpr double cell = 0.25 / across;

/// Iterations on coarse levels and on the body.
struct Iterations {
  unsigned coarse = 0, fine = 0;
};

/// The paper's cantilever along z, at rest, with its weight along -y.
struct Beam : rig::Block {
  Beam(const std::string& model, double weight, const suture::TimeRamp& ramp = {},
       double tolerance = 1e-8)
      : Block(model, {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {across, across, 4 * across}, cell,
              {.integrator = "static",
               .gravity = {0, -weight, 0},
               .gravity_ramp = ramp,
               .solver = {tolerance}}) {
    hold(vertices([](const Vec3& x) { return x[2] < 1e-9; }), 7);
    dynamics.newton()->on_iteration = [this](const Newton::Iteration& i) {
      ++(i.coarse_nodes > 0 ? iterations.coarse : iterations.fine);
    };
  }
  /// Slits every 4 cells, from both sides in turn, that leave a quarter of the width.
  void cut_comb(Index first_layer = 4) {
    std::vector<suture::Dart> faces;
    for (Index e = 0; e < complex().element_count(); ++e) {
      const Vec3 low = rest(complex().vertices_of(e)[0]);
      const auto layer = static_cast<Index>(std::lround(low[2] / cell)) + 1;
      const bool from_left = layer % 8 == 0;
      if (layer < first_layer || layer % 4 != 0 || (from_left ? low[0] > 0.18 : low[0] < 0.06))
        continue;
      for (suture::Dart face = 0; face < 6; ++face) {
        const Index other = complex().neighbour(e, static_cast<int>(face));
        if (other != suture::none && rest(complex().vertices_of(other)[0])[2] > low[2] + cell / 2)
          faces.push_back(24 * e + 4 * face);
      }
    }
    cut(faces);
  }
  void solve(int steps = 1) {
    dynamics.start();
    run(1.0 / steps, steps);
  }
  std::vector<double> displacements() {
    std::vector<double> all;
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) all.push_back(shift(v, c));
    return all;
  }
  Iterations iterations;
};

double largest(const std::vector<double>& a) {
  double result = 0;
  for (const double x : a) result = std::max(result, std::abs(x));
  return result;
}

double difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return largest(a);
}

struct Case {
  const char *name, *model;
  bool is_cut;
  double gravity;            ///< m/s^2
  unsigned most_iterations;  ///< on the body; above 25 the start would have been given up
};

class NestedIteration : public testing::TestWithParam<Case> {};

// In steps, only the first one is far from its equilibrium.
TEST_P(NestedIteration, ReachesTheSolutionOfLoadStepsFromCoarseLevels) {
  Beam beam(GetParam().model, GetParam().gravity);
  Beam ramped(GetParam().model, GetParam().gravity, {0, 1, false});
  for (Beam* body : {&beam, &ramped})
    if (GetParam().is_cut) body->cut_comb();
  beam.solve();
  ramped.solve(5);
  const std::vector<double> found = beam.displacements();
  EXPECT_GT(largest(found), 0.02);
  EXPECT_LT(difference(found, ramped.displacements()), 1e-6 * largest(found));
  EXPECT_GT(beam.iterations.coarse, 0u);
  EXPECT_LE(beam.iterations.fine, GetParam().most_iterations);
}

INSTANTIATE_TEST_SUITE_P(Beams, NestedIteration,
                         testing::Values(Case{"Uncut", "tm-faure", false, 2.45, 5},
                                         Case{"Comb", "tm-faure", true, 0.3, 12},
                                         Case{"Springs", "mss-baudet", false, 0.5, 12}),
                         [](const auto& test) { return test.param.name; });

TEST(NestedIterations, AreLeftOutNearTheEquilibrium) {
  Beam beam("tm-faure", 2.45, {0, 1, false});
  beam.dynamics.start();
  beam.run(0.25, 1);
  EXPECT_GT(beam.iterations.coarse, 0u);
  beam.iterations = {};
  beam.run(0.05, 1);
  EXPECT_EQ(beam.iterations.coarse, 0u);
}

/// Iterations on the body in the next steps.
unsigned iterations_of(Beam& beam, double dt, int steps) {
  beam.iterations = {};
  beam.run(dt, steps);
  return beam.iterations.fine;
}

TEST(PredictedEquilibria, TakeOneIterationAlsoAfterACut) {
  constexpr suture::TimeRamp ramp{0, 1, false};
  Beam beam("tm-faure", 0.3, ramp, 1e-4), at_once("tm-faure", 0.3, ramp, 1e-4);
  beam.dynamics.start();
  at_once.dynamics.start();
  EXPECT_GT(iterations_of(beam, 0.02, 1), 1u) << "nothing is known";
  beam.run(0.02, 4);
  EXPECT_EQ(iterations_of(beam, 0.02, 6), 6u);
  beam.cut_comb(4 * across - 4);
  at_once.cut_comb(4 * across - 4);
  beam.run(0, 1);  // the equilibrium after the cut
  EXPECT_EQ(iterations_of(beam, 0.02, 1), 1u) << "copies of vertices go on";
  at_once.run(beam.dynamics.time(), 1);
  EXPECT_LT(difference(beam.displacements(), at_once.displacements()),
            1e-3 * largest(at_once.displacements()));
}

TEST(PredictedEquilibria, DoNotRepeatWhatACutReleased) {
  Beam beam("tm-faure", 1, {0, 1, false}, 1e-4);
  beam.dynamics.start();
  beam.run(0.02, 10);
  beam.cut_comb(5 * across / 2);
  EXPECT_GT(iterations_of(beam, 0.02, 1), 3u) << "the cut is a part of this step";
  EXPECT_LE(iterations_of(beam, 0.02, 1), 2u);
}

TEST(PredictedEquilibria, AreDroppedWhereTheLoadStays) {
  Beam beam("tm-faure", 0.3, {0, 1, false});
  beam.dynamics.start();
  beam.run(0.1, 10);
  const std::vector<double> before = beam.displacements();
  EXPECT_EQ(iterations_of(beam, 0.1, 1), 0u);
  EXPECT_EQ(beam.displacements(), before);
}

}  // namespace
