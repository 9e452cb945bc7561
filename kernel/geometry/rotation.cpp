// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/rotation.hpp"

#include <Eigen/Geometry>

#include "kernel/base/rows.hpp"

namespace suture {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d vector(const Vec3& a) { return {a[0], a[1], a[2]}; }

Matrix3d matrix(const Rotation& r) {
  Matrix3d m;
  for (Eigen::Index i = 0; i < 3; ++i) m.row(i) = vector(r[static_cast<std::size_t>(i)]);
  return m;
}

}  // namespace

/// By quaternions, which can be made exact again: many products stay rotations.
Rotation turned(const Vec3& by, const Rotation& r) {
  const double angle = norm(by);
  if (angle == 0) return r;
  const Eigen::AngleAxisd turn(angle, vector(scaled(1 / angle, by)));
  const Matrix3d m =
      (Eigen::Quaterniond(turn) * Eigen::Quaterniond(matrix(r))).normalized().toRotationMatrix();
  Rotation result;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j)
      result[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = m(i, j);
  return result;
}

Vec3 rotation_between(const Rotation& from, const Rotation& to) {
  const Eigen::AngleAxisd turn(Matrix3d(matrix(to) * matrix(from).transpose()));
  const Vector3d by = turn.angle() * turn.axis();
  return {by[0], by[1], by[2]};
}

}  // namespace suture
