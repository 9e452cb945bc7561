// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/multigrid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "kernel/base/vec3.hpp"
#include "kernel/solvers/cell_projection.hpp"
#include "kernel/solvers/choice.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"
#include "kernel/solvers/direct.hpp"
#include "kernel/solvers/galerkin.hpp"
#include "tests/solvers/solver_body.hpp"

namespace suture::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

Matrix dense(const Preconditioner& b, const TangentMatrix& a) {
  const auto size = static_cast<Eigen::Index>(a.size());
  Matrix result = Matrix::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    if (a.free()[static_cast<std::size_t>(i)])
      b.apply(Vector(Vector::Unit(size, i)).data(), result.col(i).data());
  return result;
}

Matrix dense(const TangentMatrix& a) {
  const auto size = static_cast<Eigen::Index>(a.size());
  Matrix result = Matrix::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    if (a.free()[static_cast<std::size_t>(i)])
      a.apply(Vector(Vector::Unit(size, i)).data(), result.col(i).data());
  return result;
}

Matrix dense(const Interpolation& p, Index coarse_nodes) {
  Matrix result = Matrix::Zero(p.fine_nodes() * 3, coarse_nodes * 3);
  for (Index v = 0; v < p.fine_nodes(); ++v)
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
      for (Index c = 0; c < 3; ++c) result(v * 3 + c, p.node[i] * 3 + c) = double{p.weight[i]};
  return result;
}

Matrix dense(const BlockRows<double>& a) {
  const BlockPattern& pattern = a.pattern();
  Matrix result = Matrix::Zero(pattern.rows() * 3, pattern.rows() * 3);
  for (Index row = 0; row < pattern.rows(); ++row)
    for (Index i = pattern.begin[row]; i < pattern.begin[row + 1]; ++i)
      result.block<3, 3>(row * 3, pattern.column[i] * 3) =
          Eigen::Map<const Eigen::Matrix3d>(a.block(i));
  return result;
}

/// Iterations to 1e-8.
unsigned iterations(const Preconditioner& b, SolverBody& body, const std::vector<double>& load) {
  std::vector<double> x(load.size());
  const LinearSolve solve = ConjugateGradients().solve(body.matrix(), b, load, x, 1e-8, 500);
  EXPECT_EQ(solve.outcome, LinearSolve::Outcome::converged);
  return solve.iterations;
}

unsigned iterations(SolverBody& body) {
  const auto multigrid = make_multigrid(body.complex(), body.attributes());
  multigrid->build(body.matrix());
  return iterations(*multigrid, body, body.weight());
}

TEST(Multigrid, IsSymmetricAndPositiveDefinite) {
  SolverBody body(unit_box({4, 2, 8}), {.is_cut = slit});
  const auto multigrid = make_multigrid(body.complex(), body.attributes(), {.coarsest_nodes = 20});
  multigrid->build(body.matrix());
  const Matrix b = dense(*multigrid, body.matrix());
  EXPECT_LT((b - b.transpose()).norm(), 1e-5 * b.norm());
  const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(b).eigenvalues();
  const auto held = std::ranges::count(body.matrix().free(), 0);
  EXPECT_GT(values[held], 1e-6 * values[values.size() - 1]);
}

TEST(Multigrid, CoarseOperatorsAreProjections) {
  for (const double mass : {0.0, 1e3}) {
    SolverBody body(unit_box({4, 2, 8}), {.is_cut = slit});
    body.matrix().set(0, mass);
    const Coarsening one = coarsen(vertex_graph(body.complex(), body.attributes()));
    const Coarsening two = coarsen(one.coarse);
    const BlockPattern first = pattern_of(one.coarse), second = pattern_of(two.coarse);
    const BlockRows<double> coarse = project(body.matrix(), one.interpolation, first);
    const BlockRows<double> coarser = project(coarse, two.interpolation, second);
    const Matrix p = dense(one.interpolation, one.coarse.nodes());
    const Matrix expected = p.transpose() * dense(body.matrix()) * p;
    EXPECT_LT((dense(coarse) - expected).norm(), 1e-12 * expected.norm());
    const Matrix q = dense(two.interpolation, two.coarse.nodes());
    const Matrix next = q.transpose() * expected * q;
    EXPECT_LT((dense(coarser) - next).norm(), 1e-12 * next.norm());
  }
}

// ---------------------------------------------------------------- iterations --

const std::array<Index, 3> beam{10, 10, 40};

struct Case {
  const char* name;
  unsigned most;
  std::function<Mesh()> mesh;
  SolverBody::Options options{};
};
void PrintTo(const Case& what, std::ostream* out) { *out << what.name; }

bool zigzag(const Vec3& a, const Vec3& b) {
  const auto side = [](const Vec3& p) { return p[0] > 3 + std::abs(std::fmod(p[2], 8) - 4); };
  return side(a) != side(b) && std::max(a[1], b[1]) < 8 && std::min(a[2], b[2]) > 5;
}
/// Slits every 4 elements, from both sides in turn.
bool comb(const Vec3& a, const Vec3& b) {
  const double slit = std::floor(std::max(a[2], b[2]) / 4);
  if (slit == std::floor(std::min(a[2], b[2]) / 4)) return false;
  return std::fmod(slit, 2) == 0 ? a[0] < 8 : a[0] > 2;
}
/// Slits every 4 elements, which end between coarse nodes of every level.
bool notches(const Vec3& a, const Vec3& b) {
  return std::floor(a[2] / 4) != std::floor(b[2] / 4) && std::min(a[1], b[1]) > 5;
}
IsCut random_cuts(double part) {
  return [part, random = std::mt19937(1)](const Vec3&, const Vec3&) mutable {
    return std::uniform_real_distribution<double>()(random) < part;
  };
}
/// Voxels of a ball between two radii, relative to that of 8.
Mesh ball(double inner, double outer) {
  return part_of(unit_box({16, 16, 16}), [=](const Vec3& centre) {
    const Vec3 from = minus(centre, {8, 8, 8});
    const double radius = std::sqrt(dot(from, from)) / 8;
    return radius >= inner && radius < outer;
  });
}

class Iterations : public testing::TestWithParam<Case> {};

TEST_P(Iterations, AreFew) {
  SolverBody body(GetParam().mesh(), GetParam().options);
  EXPECT_LE(iterations(body), GetParam().most);
}

INSTANTIATE_TEST_SUITE_P(
    Multigrid, Iterations,
    testing::Values(
        Case{"beam", 15, [] { return unit_box(beam); }},
        Case{"zig_zag", 30, [] { return unit_box(beam); }, {.is_cut = zigzag}},
        Case{"comb", 30, [] { return unit_box(beam); }, {.is_cut = comb}},
        Case{"notches", 18, [] { return unit_box(beam); }, {.is_cut = notches}},
        Case{"random_cuts", 30, [] { return unit_box(beam); }, {.is_cut = random_cuts(0.1)}},
        Case{"nu_045", 30, [] { return unit_box(beam); }, {.nu = 0.45}},
        Case{"nu_049", 50, [] { return unit_box(beam); }, {.nu = 0.49}},
        Case{"long_boxes", 40,
             [] {
               return unit_box({8, 8, 32}, {1, 1, 10});
             }},
        Case{"flat_boxes", 40,
             [] {
               return unit_box({8, 8, 32}, {10, 10, 1});
             }},
        Case{"plate", 40,
             [] {
               return unit_box({1, 20, 40});
             }},
        Case{"ball", 15, [] { return ball(0, 1); }, {.held = 2}},
        Case{"shell", 30, [] { return ball(0.75, 1); }, {.held = 2}},
        Case{"distorted", 40, [] { return distorted(unit_box(beam), 0.2); }, {.held = 0.3}},
        Case{"springs", 80, [] { return unit_box(beam); }, {.model = "mss-baudet"}}),
    [](const auto& test) { return test.param.name; });

/// A quarter of all faces: dozens of pieces float.
TEST(Multigrid, PiecesThatFloatDoNotDisturbIt) {
  SolverBody body(unit_box(beam), {.is_cut = random_cuts(0.25)});
  const auto multigrid = make_multigrid(body.complex(), body.attributes());
  multigrid->build(body.matrix());
  EXPECT_LE(iterations(*multigrid, body, body.balanced_load()), 40u);
}

TEST(Multigrid, TheMassTermOfAnImplicitStepHelps) {
  SolverBody body(unit_box(beam));
  const unsigned at_rest = iterations(body);
  body.matrix().set(0, 1e4);
  EXPECT_LT(iterations(body), at_rest);
}

TEST(Multigrid, UnitsDoNotMatter) {
  const std::array<Index, 3> cells{6, 6, 24};
  SolverBody metres(unit_box(cells)), microns(unit_box(cells, {1e-6, 1e-6, 1e-6}), {.held = 1e-12});
  EXPECT_EQ(iterations(metres), iterations(microns));
}

/// A side that slides: components are held one by one.
TEST(Multigrid, SidesMaySlide) {
  SolverBody body(unit_box(beam));
  std::vector<Index> side;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    if (body.attributes().rest().get(v, 0) == 0 && body.attributes().rest().get(v, 2) > 0)
      side.push_back(v);
  body.body().constraints().add(side, 1, {}, body.attributes());
  body.matrix().set(0);
  EXPECT_LE(iterations(body), 15u);
}

TEST(Multigrid, SmallAndSolidBodiesAreFactored) {
  for (const std::array<Index, 3>& cells : {std::array<Index, 3>{1, 1, 1}, {2, 2, 2}, {4, 4, 7}}) {
    SolverBody body(unit_box(cells));
    const auto multigrid = make_multigrid(body.complex(), body.attributes());
    multigrid->build(body.matrix());
    EXPECT_EQ(multigrid->name(), "direct");
    EXPECT_LE(iterations(*multigrid, body, body.weight()), 2u);
  }
}

TEST(Multigrid, ABodyThatIsHeldEverywhereHasNothingToSolve) {
  SolverBody body(unit_box({6, 6, 12}), {.held = 12});
  EXPECT_EQ(iterations(body), 0u);
  const auto multigrid = make_multigrid(body.complex(), body.attributes());
  multigrid->build(body.matrix());
  std::vector<double> z(body.matrix().size(), 1);
  multigrid->apply(body.weight().data(), z.data());
  EXPECT_EQ(z, std::vector<double>(z.size()));
}

// -------------------------------------------------------------------- states --

std::vector<double> applied(const Preconditioner& b, const std::vector<double>& load) {
  std::vector<double> z(load.size());
  b.apply(load.data(), z.data());
  return z;
}

TEST(Multigrid, BuiltAgainFromTheSameMatrixItIsTheSame) {
  SolverBody body(unit_box({6, 6, 12}));
  body.cut(slit);
  body.matrix().set(0);
  const auto old = make_multigrid(body.complex(), body.attributes());
  old->build(body.matrix());
  old->build(body.matrix());
  const auto fresh = make_multigrid(body.complex(), body.attributes());
  fresh->build(body.matrix());
  EXPECT_EQ(applied(*old, body.weight()), applied(*fresh, body.weight()));
}

/// Where coarsening ends depends on the matrix of the first build: a run that is resumed knows.
TEST(Multigrid, OfAKnownNumberOfLevelsItIsTheSame) {
  SolverBody body(unit_box(beam), {.is_cut = comb, .nu = 0.49});
  const auto old = make_multigrid(body.complex(), body.attributes());
  EXPECT_EQ(old->levels(), 0u);
  old->build(body.matrix());
  SolverBody whole(unit_box(beam));
  const auto other = make_multigrid(whole.complex(), whole.attributes());
  other->build(whole.matrix());
  EXPECT_LT(old->levels(), other->levels());
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    body.attributes().position().set(v, 2, 1.01 * body.attributes().position().get(v, 2));
  old->build(body.matrix());
  const auto fresh = make_multigrid(body.complex(), body.attributes(), {.levels = old->levels()});
  fresh->build(body.matrix());
  EXPECT_EQ(fresh->levels(), old->levels());
  EXPECT_EQ(applied(*old, body.weight()), applied(*fresh, body.weight()));
}

/// What a first build that fails leaves behind is not taken for a hierarchy.
TEST(Multigrid, IsBuiltFromScratchAfterAFailure) {
  SolverBody body(unit_box(beam), {.is_cut = comb});
  const double x = body.attributes().position().get(100, 0);
  body.attributes().position().set(100, 0, std::nan(""));
  const auto multigrid = make_multigrid(body.complex(), body.attributes());
  EXPECT_THROW(multigrid->build(body.matrix()), NumericalError);
  EXPECT_EQ(multigrid->levels(), 0u);
  body.attributes().position().set(100, 0, x);
  multigrid->build(body.matrix());
  const auto fresh = make_multigrid(body.complex(), body.attributes());
  fresh->build(body.matrix());
  EXPECT_EQ(applied(*multigrid, body.weight()), applied(*fresh, body.weight()));
}

/// Large enough that every loop is shared: products, operators and vectors.
TEST(Multigrid, AndSolutionsAreTheSameForEveryNumberOfThreads) {
  for (const double distortion : {0.0, 0.2})
    for (const char* model : {"tm-faure", "mss-baudet"}) {
      std::vector<std::vector<double>> results;
      for (const unsigned threads : {1u, 2u, 3u}) {
        SolverBody body(distorted(unit_box({12, 12, 60}), distortion),
                        {.is_cut = slit, .model = model, .held = 0.3, .threads = threads});
        const auto multigrid = make_multigrid(body.complex(), body.attributes());
        multigrid->build(body.matrix());
        std::vector<double> x(body.matrix().size());
        const LinearSolve solve =
            ConjugateGradients().solve(body.matrix(), *multigrid, body.weight(), x, 1e-6, 200);
        EXPECT_EQ(solve.outcome, LinearSolve::Outcome::converged);
        results.push_back(applied(*multigrid, body.weight()));
        results.back().insert(results.back().end(), x.begin(), x.end());
        EXPECT_EQ(results.back(), results.front()) << model << ", " << threads << " threads";
      }
    }
}

/// Compressed to 60 % of its length, a beam buckles.
TEST(Multigrid, RaisesTheDiagonalOfAnIndefiniteMatrix) {
  SolverBody body(unit_box({4, 4, 32}));
  const auto multigrid = make_multigrid(body.complex(), body.attributes());
  multigrid->build(body.matrix());
  EXPECT_EQ(multigrid->shift(), 0);
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    body.attributes().position().set(v, 2, 0.6 * body.attributes().position().get(v, 2));
  multigrid->build(body.matrix());
  EXPECT_GT(multigrid->shift(), 0);
  std::vector<double> x(body.matrix().size());
  const LinearSolve solve =
      ConjugateGradients().solve(body.matrix(), *multigrid, body.weight(), x, 1e-8, 500);
  EXPECT_EQ(solve.outcome, LinearSolve::Outcome::indefinite);
  EXPECT_GT(dot(x, body.weight()), 0);
}

TEST(Multigrid, RefusesAMatrixThatIsNotFinite) {
  SolverBody body(unit_box({6, 6, 12}));
  body.attributes().position().set(100, 0, std::nan(""));
  const auto multigrid = make_multigrid(body.complex(), body.attributes());
  EXPECT_THROW(multigrid->build(body.matrix()), NumericalError);
}

// -------------------------------------------------------------------- choice --

TEST(Direct, SolvesInOneIterationAndACorrection) {
  SolverBody body(unit_box({4, 4, 8}), {.is_cut = slit, .nu = 0.499});
  const auto direct = make_direct(body.complex(), body.attributes());
  direct->build(body.matrix());
  EXPECT_LE(iterations(*direct, body, body.weight()), 2u);
}

TEST(Direct, SkipsRemovedVertices) {
  SolverBody body(unit_box({3, 3, 6}));
  body.body().pierce({53, 52});
  body.matrix().set(0);
  const auto direct = make_direct(body.complex(), body.attributes());
  direct->build(body.matrix());
  EXPECT_LE(iterations(*direct, body, body.weight()), 2u);
}

TEST(PreconditionerChoice, FollowsSizeAndMass) {
  const auto choose = [](const std::array<Index, 3>& cells, double mass) {
    SolverBody body(unit_box(cells));
    body.matrix().set(0, mass);
    const auto choice = choose_preconditioner(body.complex(), body.attributes(), body.matrix());
    return choice.preconditioner->name() + ' ' + choice.reason;
  };
  EXPECT_EQ(choose({2, 2, 4}, 0), "direct because a body of 16 elements is small");
  EXPECT_EQ(choose({6, 6, 12}, 0), "multigrid for 432 elements");
  EXPECT_EQ(choose({6, 6, 12}, 10), "multigrid for 432 elements");
  EXPECT_EQ(choose({6, 6, 12}, 1e6), "block Jacobi because the mass term dominates the matrix");
}

}  // namespace
}  // namespace suture::test
