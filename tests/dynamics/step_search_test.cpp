// SPDX-License-Identifier: GPL-3.0-or-later
//
// The largest stable step of various bodies, compared with a dense solver.
#include "kernel/spectrum/step_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "tests/dynamics/model_block.hpp"

namespace {

using namespace suture;
using namespace rig;

struct Subject {
  const char* name;
  const char* model;
  double viscosity;
};

/// Springs that tie every vertex to its place, and dashpots: a stiff term beside the models.
class Ties final : public ForceTerm, public TangentTerm {
 public:
  Ties(Attributes& attributes, double k, double c) : attributes_(attributes), k_(k), c_(c) {}
  const char* name() const override { return "ties"; }
  void add_forces(double, const LiveMask&, double*) override {}
  void add_forces_at(const VertexSelection&, std::span<const Index>, double,
                     std::vector<Vec3>&) override {}
  void add_tangent(const double* d, double dx, double dv, const TangentTime&,
                   double* out) override {
    for (std::size_t i = 0; i < 3 * std::size_t{attributes_.vertex_count()}; ++i)
      out[i] -= (dx * k_ + dv * c_) * d[i];
  }

 private:
  Attributes& attributes_;
  double k_, c_;
};

/// M^-1/2 (stiffness K + damping C) M^-1/2 on the free components, column by column.
Eigen::MatrixXd matrix_of(suture::Body& body, double stiffness, double damping) {
  Attributes& attributes = body.attributes();
  const std::size_t size = 3 * std::size_t{attributes.vertex_count()};
  std::vector<double> direction(size), image(size), roots(size);
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < size; ++i) {
    const auto v = static_cast<Index>(i / 3);
    roots[i] = std::sqrt(attributes.mass().get(v, 0));
    if (roots[i] > 0 && !(static_cast<int>(attributes.fixed().get(v, 0)) >> i % 3 & 1))
      free.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index column = 0; column < count; ++column) {
    direction.assign(size, 0);
    image.assign(size, 0);
    direction[free[column]] = 1;
    body.add_tangent(direction.data(), stiffness, damping, 0, image.data());
    for (Eigen::Index row = 0; row < count; ++row)
      matrix(row, column) = -image[free[row]] / (roots[free[row]] * roots[free[column]]);
  }
  return matrix;
}

double largest_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

/// The step at which the largest eigenvalue of dt^2/4 K + dt/2 C is 1, by bisection.
double exact_step(suture::Body& body) {
  const Eigen::MatrixXd k = matrix_of(body, 1, 0);
  const double undamped = 2 / std::sqrt(largest_eigenvalue(k));
  if (!body.models().reads_velocity()) return undamped;
  const Eigen::MatrixXd c = matrix_of(body, 0, 1);
  double low = 0, high = undamped;
  while (high - low > 1e-4 * high) {
    const double dt = (low + high) / 2;
    (largest_eigenvalue(dt * dt / 4 * k + dt / 2 * c) < 1 ? low : high) = dt;
  }
  return low;
}

class Search : public testing::TestWithParam<Subject> {
 protected:
  Search() : trace_(__FILE__, __LINE__, "seed " + std::to_string(seed_)) { hold(); }
  void hold() {
    block.hold(block.vertices([](const Vec3& x) { return x[0] < 1e-9; }), 7);
    block.hold(block.vertices([](const Vec3& x) { return x[1] < 1e-9; }), 2);
  }
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  void shake(double amplitude = 5e-4) {
    Column& position = block.attributes().position();
    for (Index v = 0; v < block.attributes().vertex_count(); ++v)
      for (int c = 0; c < 3 && block.complex().exists(0, v); ++c)
        position.set(v, c, position.get(v, c) + amplitude * number());
  }
  /// Calls between() between two portions.
  template <class Between>
  StepLimits::Found spread(StepLimits::Aim aim, Between between) {
    block.limits.begin(aim);
    for (int call = 0; call < 400; ++call) {
      if (const auto found = block.limits.advance(0)) return *found;
      between(call);
    }
    ADD_FAILURE() << "does not end";
    return {};
  }
  void operate(int round) {
    CellComplex& complex = block.complex();
    if (round % 3 == 0) {
      cut_.clear();
      for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
        if (complex.exists(3, d / 24) && complex.can_cut(d) && d < complex.beta3(d) &&
            random_() % 4 == 0)
          cut_.push_back({d, complex.beta3(d)});
      std::vector<Dart> faces;
      for (const Seam& seam : cut_) faces.push_back(seam.one);
      block.cut(faces);
    } else if (round % 3 == 1) {
      const Index e = random_() % complex.element_count();
      if (complex.exists(3, e)) block.pierce({e});
    } else {
      std::erase_if(cut_, [&](const Seam& s) { return !complex.can_sew(s.one, s.other); });
      block.sew({cut_.begin(), cut_.begin() + static_cast<std::ptrdiff_t>(cut_.size() / 2)});
    }
  }
  static std::map<std::string, double> material() {
    return {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}, {"viscosity", GetParam().viscosity}};
  }
  Block block{GetParam().model, material(), {4, 3, 3}, 0.02, {}};
  const unsigned seed_ = std::random_device{}();
  std::mt19937 random_{seed_};
  testing::ScopedTrace trace_;
  std::vector<Seam> cut_;
};
INSTANTIATE_TEST_SUITE_P(Models, Search,
                         testing::Values(Subject{"tm", "tm-faure", 0},
                                         Subject{"ms", "mss-baudet", 0},
                                         Subject{"viscous", "mss-baudet", 1}),
                         [](const auto& one) { return std::string(one.param.name); });

// 1.5 % too short at most, 3 % where C limits it. Of 2,400 searches one came out 2.0 % too long; of
// many more with C, one 3.53 %.
TEST_P(Search, FromRandomIsThatOfADenseSolver) {
  const bool is_damped = GetParam().viscosity > 0;
  const double band = is_damped ? 0.035 : 0.0175, above = is_damped ? 0.06 : 0.035;
  shake();
  for (int round = 0; round < 6; ++round) {
    operate(round);
    const double exact = exact_step(block), found = StepSearch(block).largest(0);
    EXPECT_GT(found, (1 - band) * exact) << round;
    EXPECT_LT(found, (1 + above) * exact) << round;
  }
}

// 11 % too long in one of thousands.
TEST_P(Search, GoesOnThroughOperations) {
  StepLimits& limits = block.limits;
  limits.stable_step(0);
  shake();
  for (int round = 0; round < 9; ++round) {
    operate(round);
    const double exact = exact_step(block), found = limits.stable_step(0);
    EXPECT_GT(found, 0.96 * exact) << round;
    EXPECT_LT(found, 1.12 * exact) << round;
  }
}

// Which moves between two portions.
TEST_P(Search, SpreadOverStepsIsThatOfTheStateAtItsEnd) {
  const double band = GetParam().viscosity > 0 ? 0.035 : 0.0175;
  shake();
  for (int round = 0; round < 3; ++round) {
    operate(round);
    block.limits.bounds_of_changes(0);
    const double fresh = StepSearch(block).largest(0);
    const double found = spread(StepLimits::Aim::stable_step, [&](int) { shake(2e-6); }).stable;
    const double exact = exact_step(block);
    ASSERT_NE(found, fresh) << "it has not moved";
    EXPECT_GT(found, (1 - band) * exact) << round;
    EXPECT_LT(found, (round == 0 ? 1.035 : 1.12) * exact) << round;
  }
  const StepLimits::Found both = spread(StepLimits::Aim::both, [](int) {});
  EXPECT_GT(both.stable, both.bound);
  EXPECT_NEAR(both.bound, block.limits.bounds(0).dt, 1e-12 * both.bound);
  EXPECT_EQ(spread(StepLimits::Aim::bound, [](int) {}).stable, both.bound);
}

// What is cut under way may carry a mode that the search does not begin with: the caller takes the
// bound of the changed vertices.
TEST_P(Search, SpreadOverStepsGoesOnThroughOperations) {
  shake();
  for (int round = 0; round < 3; ++round) {
    double changed = 1;
    const double found = spread(StepLimits::Aim::stable_step, [&](int call) {
                           if (call != 3) return;
                           operate(round);
                           changed = block.limits.bounds_of_changes(0).dt;
                         }).stable;
    const double exact = exact_step(block);
    EXPECT_GT(found, 0.96 * exact) << round;
    EXPECT_LT(std::min(found, changed), 1.12 * exact) << round;
  }
}

TEST_P(Search, SpreadOverStepsGoesOnFromItsState) {
  StepSearch search(block), twin(block);
  search.begin();
  for (int call = 0; call < 5; ++call) {
    shake(2e-6);
    ASSERT_FALSE(search.advance(0));
  }
  StateTree tree;
  save_state(tree, search);
  load_state(tree, twin);
  bool ends = false;
  while (!ends) {
    shake(2e-6);
    ends = search.advance(0);
    ASSERT_EQ(twin.advance(0), ends);
  }
  EXPECT_EQ(search.result(), twin.result());
  EXPECT_EQ(search.largest(0), twin.largest(0));
}

TEST_P(Search, SeesOtherTermsThanTheModels) {
  const double before = StepSearch(block).largest(0);
  const double mass = block.attributes().mass().get(block.vertices([](const Vec3& x) {
    return x[0] > 0.03 && x[0] < 0.05 && x[1] > 0.03 && x[2] > 0.01 && x[2] < 0.05;
  })[0],
                                                    0);
  const double k = 8 * mass / (before * before);
  block.add(std::make_unique<Ties>(block.attributes(), k, GetParam().viscosity > 0 ? 1e-3 : 0.0));
  const double exact = exact_step(block), found = StepSearch(block).largest(0);
  EXPECT_LT(found, 0.9 * before);
  EXPECT_NEAR(found, exact, 0.035 * exact);
}

TEST_P(Search, IsInfiniteWhereNothingMoves) {
  block.hold(spring_model::all_vertices(block), 7);
  EXPECT_TRUE(std::isinf(block.limits.stable_step(0)));
}

// Everything that the next searches go by.
TEST_P(Search, GoesOnFromItsState) {
  shake();
  StepSearch search(block), twin(block);
  search.largest(0);
  StateTree tree;
  save_state(tree, search);
  load_state(tree, twin);
  for (int i = 0; i < 18; ++i) {  // a random start among them
    shake();
    ASSERT_EQ(search.largest(0), twin.largest(0)) << i;
  }
}

}  // namespace
