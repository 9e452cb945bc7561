// SPDX-License-Identifier: GPL-3.0-or-later
// The material properties of a lattice of Baudet's springs: closed forms for cubes, homogenised
// stiffness with and without correction, mechanisms, warnings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>

#include "tests/plugins/mss_baudet.hpp"

namespace suture::testing {
namespace {

using ::testing::HasSubstr;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double E = 400e3;
const std::vector<double> ratios{-0.2, 0, 0.1, 0.25, 0.3, 0.4, 0.45, 0.499};

// ---------------------------------------------------------- spring constants --

TEST(MssBaudet, SpringsOfOneCube) {
  const double l = 0.05;
  for (const double nu : ratios) {
    ModelHarness cube(mss_baudet(), {{"E", E}, {"nu", nu}, {"rho", 1000}},
                      box_mesh({1, 1, 1}, {l, l, l}));
    for (const double k : cube.column("stiffness"))
      EXPECT_NEAR(k, E * l * (1 + 4 * nu) / (8 * (1 + nu)), 1e-13 * E * l);
    EXPECT_NEAR(cube.column("inner_stiffness")[0], 3 * E * l / (8 * (1 + nu)), 1e-13 * E * l);
    for (const double length : cube.column("inner_length"))
      EXPECT_NEAR(length, std::sqrt(3) * l, 1e-15);
    for (const double m : cube.mass()) EXPECT_NEAR(m, 1000 * l * l * l / 8, 1e-16);
  }
}

// An edge has the sum of its elements' shares: 1, 2 or 4 cubes around it.
TEST(MssBaudet, EdgesSumOverTheirElements) {
  const double l = 0.1;
  ModelHarness block(mss_baudet(), paper_material(), box_mesh({2, 2, 2}, {l, l, l}));
  const double share = E * l * (1 + 4 * 0.3) / (8 * 1.3);
  std::map<long, int> histogram;
  for (const double k : block.column("stiffness")) ++histogram[std::lround(k / share * 1000)];
  EXPECT_EQ(histogram, (std::map<long, int>{{1000, 24}, {2000, 24}, {4000, 6}}));
  const auto& mass = block.mass();
  EXPECT_NEAR(std::accumulate(mass.begin(), mass.end(), 0.0), 1000 * 8 * l * l * l, 1e-12);
}

// The trilinear element's volume, against the divergence theorem on its faces'
// bilinear patches: int x dA over a patch is exact with 2x2 Gauss points too, but
// shares no code: V = 1/3 sum_faces int x . n dA.
TEST(MssBaudet, MassIsThatOfTheTrilinearElement) {
  auto mesh = box_mesh({1, 1, 1}, {1, 1.2, 0.9});
  mesh.points = shaken(mesh.points, 0.2, 3);
  using V = Eigen::Vector3d;
  const auto at = [&](int n) { return V(mesh.points[n].data()); };
  double volume = 0;
  for (const auto& f : suture_hexahedron_faces)
    for (int q = 0; q < 9; ++q) {
      const double s[3] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
      const double w[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
      const double u = s[q % 3], v = s[q / 3];
      const V a = at(f[0]), b = at(f[1]), c = at(f[2]), d = at(f[3]);
      const V x = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d;
      const V du = (1 - v) * (b - a) + v * (c - d), dv = (1 - u) * (d - a) + u * (c - b);
      volume -= w[q % 3] * w[q / 3] * x.dot(du.cross(dv)) / 3;  // normals point inward
    }
  ModelHarness element(mss_baudet(), paper_material(), mesh);
  for (const double m : element.mass()) EXPECT_NEAR(m, 1000 * volume / 8, 1e-11);
}

// -------------------------------------------------------------- homogenisation --

/// Stiffness (Pa, order XX YY ZZ XY YZ XZ) of the periodic lattice of boxes l, by
/// central differences of the virial stress under affine strain. Also checks that
/// affine strain is equilibrium: no node of the lattice feels a force.
Matrix6 homogenised(const std::map<std::string, double>& parameters, const Vec3& l) {
  const Index n = 3;
  ModelHarness lattice(mss_baudet(), parameters, box_mesh({n, n, n}, l, true));
  const auto& mesh = lattice.mesh();
  const double volume = n * n * n * l[0] * l[1] * l[2], h = 1e-6;
  constexpr int row[] = {0, 1, 2, 0, 1, 0}, column[] = {0, 1, 2, 1, 2, 2};
  const auto stress = [&](int mode, double size) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    F(row[mode], column[mode]) += size / 2;
    F(column[mode], row[mode]) += size / 2;
    auto x = mesh.points;
    for (auto& p : x)
      Eigen::Map<Eigen::Vector3d>(p.data()) = F * Eigen::Map<Eigen::Vector3d>(p.data());
    const auto f = lattice.forces(x);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    std::vector<Eigen::Vector3d> net(mesh.vertices, Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Eigen::Map<const Eigen::Vector3d> force(f[i].data()), at(x[i].data());
      sum -= force * at.transpose() / volume;
      net[mesh.identity[i]] += force;
    }
    for (const auto& force : net) EXPECT_LT(force.norm(), 1e-9 * E * l[0] * l[1]);
    return sum;
  };
  Matrix6 C;
  for (int mode = 0; mode < 6; ++mode) {
    const Eigen::Matrix3d d = (stress(mode, h) - stress(mode, -h)) / (2 * h);
    for (int i = 0; i < 6; ++i) C(i, mode) = d(row[i], column[i]);
  }
  return C;
}

/// Hooke's law in the same order (shear strains as engineering strains gamma_ab).
Matrix6 hooke(double nu) {
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  Matrix6 C = Matrix6::Zero();
  C.topLeftCorner<3, 3>().setConstant(lambda);
  C.diagonal() << lambda + 2 * mu, lambda + 2 * mu, lambda + 2 * mu, mu, mu, mu;
  return C;
}

// From the springs' energy in small strain: C11 = E (1+2nu)/(1+nu), C12 = C44 = G; E_lat =
// 2E(1+4nu)/(3+4nu), nu_lat = 1/(3+4nu).
TEST(MssBaudet, CubesWithoutCorrectionShowTheCauchyLattice) {
  for (const double nu : ratios) {
    const Matrix6 C = homogenised({{"E", E}, {"nu", nu}, {"rho", 1}}, {0.1, 0.1, 0.1});
    const double G = E / (2 * (1 + nu));
    Matrix6 expected = Matrix6::Zero();
    expected.topLeftCorner<3, 3>().setConstant(G);
    expected.diagonal() << Eigen::Vector3d::Constant(E * (1 + 2 * nu) / (1 + nu)),
        Eigen::Vector3d::Constant(G);
    EXPECT_LT((C - expected).cwiseAbs().maxCoeff(), 1e-6 * G) << "nu = " << nu;
    const Matrix6 S = C.inverse();
    EXPECT_NEAR(1 / S(0, 0), 2 * E * (1 + 4 * nu) / (3 + 4 * nu), 1e-6 * E);
    EXPECT_NEAR(-S(0, 1) / S(0, 0), 1 / (3 + 4 * nu), 1e-6);
  }
}

// The same as numbers {E_lat/E, nu_lat, Zener}, from an independent homogenisation
// (a script of its own, not this plugin), to the digits that it printed.
TEST(MssBaudet, LatticeModuliOfTheTable) {
  const std::map<double, std::array<double, 3>> table{
      {0, {.6667, .3333, 2}},        {0.1, {.8235, .2941, 1.4286}},
      {0.25, {1, .25, 1}},           {0.3, {1.0476, .2381, .9091}},
      {0.4, {1.1304, .2174, .7692}}, {0.499, {1.1994, .2002, .6676}}};
  for (const auto& [nu, values] : table) {
    const Matrix6 C = homogenised({{"E", E}, {"nu", nu}, {"rho", 1}}, {0.02, 0.02, 0.02});
    const Matrix6 S = C.inverse();
    EXPECT_NEAR(1 / S(0, 0) / E, values[0], 6e-5);
    EXPECT_NEAR(-S(0, 1) / S(0, 0), values[1], 6e-5);
    EXPECT_NEAR(2 * C(3, 3) / (C(0, 0) - C(0, 1)), values[2], 6e-5);
  }
}

TEST(MssBaudet, CubesWithCorrectionAreHookes) {
  for (const double nu : ratios) {
    const Matrix6 C =
        homogenised({{"E", E}, {"nu", nu}, {"rho", 1}, {"correction", 1}}, {0.1, 0.1, 0.1});
    const Matrix6 expected = hooke(nu);
    EXPECT_LT((C - expected).cwiseAbs().maxCoeff(), 1e-6 * expected(0, 0)) << "nu = " << nu;
  }
}

// For boxes the correction makes the normal components Hooke's, also where a
// negative edge stiffness is clamped or kept; shear is what one k_d can give:
// G_xy : G_xz : G_yz = xy/z : xz/y : yz/x around the geometric mean G.
TEST(MssBaudet, BoxesWithCorrectionHaveHookesNormalStiffness) {
  const double nu = 0.3, G = E / (2 * (1 + nu));
  for (const Vec3& l : {Vec3{1, 1.2, 0.9}, Vec3{1, 1.5, 0.8}, Vec3{0.1, 0.2, 0.1}})
    for (const double negative : {0, 1}) {
      const Matrix6 C = homogenised(
          {{"E", E}, {"nu", nu}, {"rho", 1}, {"correction", 1}, {"negative_stiffness", negative}},
          l);
      EXPECT_LT((C - hooke(nu)).topLeftCorner(3, 3).cwiseAbs().maxCoeff(), 1e-6 * E);
      EXPECT_NEAR(std::cbrt(C(3, 3) * C(4, 4) * C(5, 5)), G, 1e-6 * G);
      EXPECT_NEAR(C(3, 3) / C(4, 4), (l[0] * l[1] / l[2]) / (l[1] * l[2] / l[0]), 1e-6);
      EXPECT_NEAR(C(5, 5) / C(4, 4), (l[0] * l[2] / l[1]) / (l[1] * l[2] / l[0]), 1e-6);
    }
}

// ------------------------------------------------------------------ mechanisms --

/// Number of eigenvalues of the stiffness at rest that are zero to rounding.
int zero_modes(const std::map<std::string, double>& parameters, std::array<Index, 3> n) {
  ModelHarness block(mss_baudet(), parameters, box_mesh(n, {0.1, 0.1, 0.1}));
  const auto& x = block.mesh().points;
  const std::size_t size = 3 * x.size();
  Eigen::MatrixXd K(size, size);
  const std::vector<Vec3> zero(x.size(), Vec3{});
  for (std::size_t j = 0; j < size; ++j) {
    auto dx = zero;
    dx[j / 3][j % 3] = 1;
    const auto df = block.tangent(x, zero, dx, zero);
    for (std::size_t i = 0; i < size; ++i) K(i, j) = -df[i / 3][i % 3];
  }
  EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm());
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  EXPECT_GT(values[0], -1e-10 * values[size - 1]);
  return static_cast<int>((values.array().abs() < 1e-10 * values[size - 1]).count());
}

// 6 rigid motions and 3 mechanisms u_a = (-1)^(i_b + i_c), for one element and for
// any regular block, with and without correction: the model's known weakness.
TEST(MssBaudet, BlocksHaveThreeMechanisms) {
  for (const double correction : {0, 1}) {
    const auto parameters = with(paper_material(), {{"correction", correction}});
    EXPECT_EQ(zero_modes(parameters, {1, 1, 1}), 9);
    EXPECT_EQ(zero_modes(parameters, {2, 2, 2}), 9);
    EXPECT_EQ(zero_modes(parameters, {3, 2, 2}), 9);
    EXPECT_EQ(zero_modes(parameters, {3, 2, 1}), 10);  // a plate one element thick has one more
  }
}

// -------------------------------------------------------------------- warnings --

/// Reports of prepare and inspect as "severity key", one per cell.
std::map<std::string, int> findings(const std::map<std::string, double>& parameters,
                                    HarnessMesh mesh, std::string* text = nullptr) {
  ModelHarness block(mss_baudet(), parameters, std::move(mesh));
  block.inspect();
  std::map<std::string, int> count;
  for (const auto& report : block.reports()) {
    ++count[std::to_string(report.severity) + " " + report.key];
    if (text != nullptr) *text += report.text + "\n";
  }
  return count;
}

TEST(MssBaudet, WarnsOfTheLatticesModuli) {
  std::string text;
  EXPECT_EQ(findings(paper_material(), box_mesh({3, 1, 1}, {1, 1, 1}), &text),
            (std::map<std::string, int>{{"1 lattice-moduli", 1}}));
  EXPECT_THAT(text, HasSubstr("has E = 4.19e+05 Pa and nu = 0.2381 instead of 4e+05 Pa and 0.3"));
  EXPECT_TRUE(findings(with(paper_material(), {{"correction", 1}}), box_mesh({1, 1, 1}, {1, 1, 1}))
                  .empty());
  EXPECT_TRUE(
      findings(with(paper_material(), {{"nu", 0.25}}), box_mesh({1, 1, 1}, {1, 1, 1})).empty());
}

TEST(MssBaudet, WarnsOfBoxesThatGiveANegativeStiffness) {
  const auto at = [](double negative) {
    return with(paper_material(), {{"nu", 0.25}, {"negative_stiffness", negative}});
  };
  const auto mesh = box_mesh({11, 1, 1}, {1, 2, 1});
  std::string text;
  EXPECT_EQ(findings(at(0), mesh, &text),
            (std::map<std::string, int>{{"1 aspect-ratio", 11}, {"1 negative-stiffness", 11}}));
  EXPECT_THAT(text, HasSubstr("N/m; it is set to 0"));
  EXPECT_THAT(text, HasSubstr("the ratio of the edges is 2:"));
  EXPECT_EQ(findings(at(1), mesh).at("1 negative-stiffness"), 11);
  EXPECT_EQ(findings(at(2), mesh).at("2 negative-stiffness"), 11);  // an error refuses the scene
}

TEST(MssBaudet, NegativeStiffnessIsClampedOrKept) {
  const auto mesh = box_mesh({1, 1, 1}, {1, 2, 1});
  ModelHarness clamped(mss_baudet(), with(paper_material(), {{"negative_stiffness", 0}}), mesh);
  ModelHarness kept(mss_baudet(), with(paper_material(), {{"negative_stiffness", 1}}), mesh);
  int negative = 0;
  for (std::size_t e = 0; e < kept.edge_count(); ++e) {
    const double k = kept.column("stiffness")[e];
    negative += k < 0 ? 1 : 0;
    EXPECT_EQ(clamped.column("stiffness")[e], std::max(k, 0.0));
  }
  EXPECT_EQ(negative, 4);
  EXPECT_EQ(clamped.energy(mesh.points), 0);
  for (const double strain : clamped.edge_field(mesh.points, "strain")) EXPECT_EQ(strain, 0);
}

TEST(MssBaudet, WarnsOfRestShapesThatAreNoBoxes) {
  auto mesh = box_mesh({9, 1, 1}, {1, 1, 1});
  mesh.points[19][2] += 0.01;  // the last point of a row: in one element
  auto sheared = box_mesh({2, 1, 1}, {1, 1, 1});
  for (auto& p : sheared.points) p[0] += 0.1 * p[1];
  const auto parameters = with(paper_material(), {{"nu", 0.25}});
  EXPECT_EQ(findings(parameters, mesh), (std::map<std::string, int>{{"1 not-a-box", 1}}));
  EXPECT_EQ(findings(parameters, sheared), (std::map<std::string, int>{{"1 not-a-box", 2}}));
}

}  // namespace
}  // namespace suture::testing
