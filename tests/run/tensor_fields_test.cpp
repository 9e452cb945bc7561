// SPDX-License-Identifier: GPL-3.0-or-later
//
// Strain, principal values and the stress at nodes, compared with closed forms.
#include "kernel/results/tensor_fields.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "kernel/operations/event_runner.hpp"
#include "kernel/results/nodal_stress.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Stress = Eigen::Matrix<double, 6, 1>;

/// A beam of 4 x 3 x 3 elements, 1 m x 0.25 m x 0.25 m, E = 400 kPa, nu = 0.3.
class TensorFields : public testing::Test {
 protected:
  Vector3d rest(Index v) { return row(built_.body().attributes().rest(), v); }
  Vector3d place(Index v) { return row(built_.body().attributes().position(), v); }
  void move(Index v, const Vector3d& x) {
    for (int c = 0; c < 3; ++c) built_.body().attributes().position().set(v, c, x[c]);
  }
  void deform(const Matrix3d& F) {
    for (Index v = 0; v < complex().count(0); ++v) move(v, F * rest(v));
  }
  CellComplex& complex() { return built_.body().complex(); }
  Vector3d centre(Index element) {
    Vector3d sum = Vector3d::Zero();
    for (const Index v : complex().vertices_of(element)) sum += place(v) / 8;
    return sum;
  }
  FrameField field(const std::string& name) {
    std::vector<FrameField> fields;
    const FieldChoice choice = field_named(all_fields(built_), name, "");
    fill_fields({choice}, choice.on, {built_, {}, 0}, fields);
    return fields.at(0);
  }
  void expect(const std::string& name, const std::vector<double>& row, double tolerance) {
    const FrameField found = field(name);
    const std::size_t width = row.size();
    ASSERT_EQ(found.components, static_cast<int>(width)) << name;
    ASSERT_GT(found.values.size(), 0u);
    for (std::size_t i = 0; i < found.values.size(); ++i)
      ASSERT_NEAR(found.values[i], row[i % width], tolerance) << name << ' ' << i;
  }
  std::vector<double> recovered(const std::vector<double>& stress,
                                const std::vector<Index>& group) {
    return nodal_stress(complex(), built_.body().attributes().position(), stress, group,
                        built_.body().models().workers(), ShownCells(complex().count(0)));
  }
  /// What `function(place, element)` gives at the centres.
  template <class Function>
  std::vector<double> at_centres(Function function) {
    std::vector<double> values;
    for (Index e = 0; e < complex().element_count(); ++e) {
      const Stress s = function(centre(e), e);
      values.insert(values.end(), s.begin(), s.end());
    }
    return values;
  }
  static Vector3d row(const Column& column, Index v) {
    return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
  }
  /// Bends and shears the body: no element remains a parallelepiped.
  void distort() {
    for (Index v = 0; v < complex().count(0); ++v) {
      const Vector3d x = rest(v);
      move(v, {x[0] + 0.3 * x[0] * x[1], x[1] + 0.2 * x[0] * x[0], x[2] + 0.4 * x[1] * x[0]});
    }
  }

  Scene scene_ = scene();
  Diagnostics diagnostics_;
  BuiltScene built_{scene_, diagnostics_};
  EventRunner events_{built_.scene(), built_, diagnostics_};

 private:
  static Scene scene() {
    Scene scene = beam(host(), "tm-faure", 4, 3, 0);
    scene.events = {event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}})};
    return scene;
  }
};

Matrix3d rotation() {
  return Eigen::AngleAxisd(0.8, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
}

// Lateral stretch from S_yy = 0, as in static_test.cpp; S_xx = E E_xx, s_xx = l_x^2 S_xx / J.
// Closed forms of eigenvalues lose half of the digits where two of them are equal.
TEST_F(TensorFields, UniaxialTension) {
  const double lx = 1.2, strain = (lx * lx - 1) / 2, ly = std::sqrt(1 - 0.6 * strain);
  const double stress = 400e3 * strain * lx / (ly * ly);
  deform(rotation() * Vector3d(lx, ly, ly).asDiagonal());
  expect("strain", {strain, -0.3 * strain, -0.3 * strain, 0, 0, 0}, 1e-14);
  expect("principal_strain", {strain, -0.3 * strain, -0.3 * strain}, 1e-8);
  expect("principal_stress", {stress, 0, 0}, 1e-7 * stress);
  expect("nodal_von_mises", {stress}, 1e-12 * stress);
  const Matrix3d s = rotation().col(0) * rotation().col(0).transpose() * stress;
  const std::vector<double> row{s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
  expect("stress", row, 1e-12 * stress);
  expect("nodal_stress", row, 1e-12 * stress);
}

// E = ((0, g/2), (g/2, g^2/2)) in the plane, and the Cauchy stress F (lambda tr E + 2 mu E) F^T,
// in which zz is a principal direction. Eigenvalues of the plane: mean +- radius (Mohr's circle).
TEST_F(TensorFields, SimpleShear) {
  const double g = 0.4, mu = 400e3 / 2.6, lambda = 400e3 * 0.3 / (1.3 * 0.4);
  Matrix3d F = Matrix3d::Identity();
  F(0, 1) = g;
  const Matrix3d E = (F.transpose() * F - Matrix3d::Identity()) / 2;
  const Matrix3d S = F * (lambda * E.trace() * Matrix3d::Identity() + 2 * mu * E) * F.transpose();
  const double mean = (S(0, 0) + S(1, 1)) / 2;
  const double radius = std::hypot((S(0, 0) - S(1, 1)) / 2, S(0, 1));
  ASSERT_GT(mean - radius, -radius) << "tension across the plane";
  std::vector<double> principal{mean + radius, mean - radius, S(2, 2)};
  std::ranges::sort(principal, std::greater());
  deform(F);
  expect("strain", {0, g * g / 2, 0, g / 2, 0, 0}, 1e-14);
  const double r = std::hypot(g * g / 4, g / 2);
  expect("principal_strain", {g * g / 4 + r, 0, g * g / 4 - r}, 1e-14);
  expect("stress", {S(0, 0), S(1, 1), S(2, 2), S(0, 1), 0, 0}, 1e-9 * mu);
  expect("principal_stress", principal, 1e-9 * mu);
}

TEST_F(TensorFields, ALinearStressIsRecoveredExactlyOnBothSidesOfACut) {
  events_.fire(0, 0);
  ASSERT_EQ(complex().count(0), 96u) << "16 vertices were split";
  distort();
  const Eigen::Matrix<double, 6, 3> slope =
      (Eigen::Matrix<double, 6, 3>() << 1, 2, 3, -4, 5, 6, 7, -8, 9, 1, 1, 2, 3, 0, -1, 2, -2, 2)
          .finished();
  const auto is_left = [&](Index e) { return e % 4 < 2; };
  const auto stress = [&](const Vector3d& x, Index e) -> Stress {
    return slope * x * (is_left(e) ? 1 : -5) + Stress::Constant(is_left(e) ? 3 : 100);
  };
  const std::vector<double> values =
      recovered(at_centres(stress), std::vector<Index>(complex().element_count(), 0));
  for (Index e = 0; e < complex().element_count(); ++e) {
    for (const Index v : complex().vertices_of(e)) {
      const Stress expected = stress(place(v), e);
      for (int c = 0; c < 6; ++c)
        ASSERT_NEAR(values[std::size_t{6} * v + static_cast<std::size_t>(c)], expected[c], 1e-11);
    }
  }
}

TEST_F(TensorFields, TheFirstGroupOfAVertexCounts) {
  const auto stress = [](const Vector3d&, Index e) { return Stress::Constant(e % 4 < 2 ? 1 : 2); };
  std::vector<Index> group;
  for (Index e = 0; e < complex().element_count(); ++e)
    group.push_back(e % 4 < 2 ? 1 : e % 4 == 2 ? 0 : none);
  const std::vector<double> values = recovered(at_centres(stress), group);
  for (Index v = 0; v < complex().count(0); ++v) {
    const double x = rest(v)[0], value = values[std::size_t{6} * v];
    if (x > 0.9)
      EXPECT_TRUE(std::isnan(value)) << v;
    else
      EXPECT_NEAR(value, x < 0.4 ? 1 : 2, 1e-12) << v;
  }
}

// The stress of a layer of one element does not determine the slope across it.
TEST(NodalStress, IsConstantAcrossASingleLayer) {
  Scene scene = beam(host(), "tm-faure", 4, 1, 0);
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  const Index elements = built.body().complex().element_count();
  std::vector<double> stress;
  for (Index e = 0; e < elements; ++e)
    stress.insert(stress.end(), 6, (e + 0.5) / 4);  // x of its centre
  const std::vector<double> values =
      nodal_stress(built.body().complex(), built.body().attributes().position(), stress,
                   std::vector<Index>(elements, 0), built.body().models().workers(),
                   ShownCells(built.body().complex().count(0)));
  const Column& rest = built.body().attributes().rest();
  for (Index v = 0; v < rest.size(); ++v)
    EXPECT_NEAR(values[std::size_t{6} * v], rest.get(v, 0), 1e-13);
}

TEST(NodalStress, IsMissingWhereNoModelProvidesStress) {
  Scene scene = beam(host(), "mss-baudet", 4, 1, 0);
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  const std::vector<FieldChoice> fields = all_fields(built);
  for (const std::string name : {"principal_stress", "nodal_stress", "nodal_von_mises"})
    EXPECT_EQ(std::ranges::find(fields, name, &FieldChoice::name), fields.end());
  EXPECT_NO_THROW(field_named(fields, "principal_strain", ""));
}

}  // namespace
}  // namespace suture::test
