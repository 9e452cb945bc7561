// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/tool.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "kernel/base/rows.hpp"

namespace suture {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

Vector3d eigen(const Vec3& a) { return {a[0], a[1], a[2]}; }
Vec3 vec3(const Vector3d& a) { return {a[0], a[1], a[2]}; }
Matrix3d matrix(const std::array<Vec3, 3>& rows) {
  Matrix3d m;
  m << eigen(rows[0]).transpose(), eigen(rows[1]).transpose(), eigen(rows[2]).transpose();
  return m;
}

/// The matrix of r x.
Matrix3d cross_matrix(const Vec3& r) {
  Matrix3d m;
  m << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0;
  return m;
}

/// How the change of velocity of a vertex, s n + t with t = -u min(1, mu s / |u|), follows that of
/// the place of the tool that pushes it; u is the sliding of the vertex.
///   sticks: 1,   slides: n n^T - mu u^ n^T + mu s / |u| (1 - n n^T - u^ u^T)
Matrix3d response_of(const Push& push, double friction) {
  const Vector3d n = eigen(push.normal).normalized();
  const Matrix3d normal = n * n.transpose();
  if (!(friction > 0)) return normal;
  const double most = friction * norm(push.normal);
  if (push.sliding <= most) return Matrix3d::Identity();
  const Vector3d u = -eigen(push.tangential).normalized();
  return normal - friction * u * n.transpose() +
         most / push.sliding * (Matrix3d::Identity() - normal - u * u.transpose());
}

/// What a vertex adds to the inertia of the tool: m G^T R G, with its response R and the velocity
/// G = (1, -r x) of its place.
Matrix6d added_inertia(const Tool::Pushed& pushed, const Vec3& centre) {
  Eigen::Matrix<double, 3, 6> g;
  g.leftCols<3>().setIdentity();
  g.rightCols<3>() = -cross_matrix(minus(pushed.place, centre));
  return pushed.mass * g.transpose() * matrix(pushed.response) * g;
}

}  // namespace

std::array<Vec3, 3> Tool::response(const Push& push, double friction) {
  const Matrix3d m = response_of(push, friction);
  return {vec3(m.row(0)), vec3(m.row(1)), vec3(m.row(2))};
}

Tool::Tool(const Obstacle& obstacle)
    : coupling_(*obstacle.coupling),
      reach_(obstacle.reach()),
      pose_(obstacle.motion.pose(0)),
      end_(pose_) {}

void Tool::include(const Vec3& given) {
  reach_ = std::max(reach_, norm(minus(given, pose_.centre)));
}

void Tool::begin(const RigidPath& hand, double time, double end, double dt, double gain) {
  dt_ = dt;
  gain_ = gain;
  const Pose from = hand.pose(time), to = hand.pose(end);
  const Vec3 stretch = minus(to.translation, pose_.translation);
  const Vec3 hand_velocity = scaled(1 / dt, minus(to.translation, from.translation));
  const Vec3 twist = rotation_between(pose_.turn, to.turn);
  const Vec3 hand_spin = scaled(1 / dt, rotation_between(from.turn, to.turn));
  const Coupling& c = coupling_;
  mass_ = c.mass + gain * (c.damping + dt * c.stiffness);
  inertia_ = c.inertia + gain * (c.turning_damping + dt * c.turning_stiffness);
  const auto free = [&](double own, const Vec3& before, double stiffness, const Vec3& offset,
                        double damping, const Vec3& target, double whole) {
    const Vec3 pull = plus(scaled(stiffness, offset), scaled(damping, target));
    return scaled(1 / whole, plus(scaled(own, before), scaled(gain, pull)));
  };
  free_.velocity =
      free(c.mass, state_.velocity, c.stiffness, stretch, c.damping, hand_velocity, mass_);
  free_.spin = free(c.inertia, state_.spin, c.turning_stiffness, twist, c.turning_damping,
                    hand_spin, inertia_);
  now_ = free_;
  misfit_ = std::numeric_limits<double>::infinity();
  move_end();
}

void Tool::move_end() {
  end_ = pose_;
  end_.translation = plus(pose_.translation, scaled(dt_, now_.velocity));
  end_.turn = turned(scaled(dt_, now_.spin), pose_.turn);
}

double Tool::improve(const Impulse& answer, std::span<const Pushed> pushed) {
  const Vec3 linear = plus(answer.linear, scaled(mass_, minus(free_.velocity, now_.velocity)));
  const Vec3 angular = plus(answer.angular, scaled(inertia_, minus(free_.spin, now_.spin)));
  const double misfit = std::sqrt(dot(linear, linear) / mass_ + dot(angular, angular) / inertia_);
  if (misfit < misfit_) {
    misfit_ = misfit;
    base_ = now_;
    part_ = 1;
    Matrix6d a = Matrix6d::Zero();
    a.diagonal().head<3>().setConstant(mass_);
    a.diagonal().tail<3>().setConstant(inertia_);
    const Vec3 centre = plus(end_.centre, end_.translation);
    for (const Pushed& vertex : pushed) a += added_inertia(vertex, centre);
    Vector6d residual;
    residual << eigen(linear), eigen(angular);
    const Vector6d step = a.partialPivLu().solve(residual);
    step_ = {vec3(step.head<3>()), vec3(step.tail<3>())};
  } else {
    part_ /= 4;
  }
  const Motion last = now_;
  now_ = {plus(base_.velocity, scaled(part_, step_.velocity)),
          plus(base_.spin, scaled(part_, step_.spin))};
  move_end();
  return dt_ *
         (norm(minus(now_.velocity, last.velocity)) + reach_ * norm(minus(now_.spin, last.spin)));
}

void Tool::finish(const Impulse& impulse, bool agree) {
  if (agree)
    now_ = {plus(free_.velocity, scaled(1 / mass_, impulse.linear)),
            plus(free_.spin, scaled(1 / inertia_, impulse.angular))};
  const auto on_hand = [&](const Vec3& given, double own, const Vec3& now, const Vec3& before) {
    return scaled(1 / gain_, minus(given, scaled(own, minus(now, before))));
  };
  state_.hand_force = on_hand(impulse.linear, coupling_.mass, now_.velocity, state_.velocity);
  state_.hand_torque = on_hand(impulse.angular, coupling_.inertia, now_.spin, state_.spin);
  state_.velocity = now_.velocity;
  state_.spin = now_.spin;
  move_end();
  pose_ = end_;
}

double Tool::top_speed() const { return norm(state_.velocity) + reach_ * norm(state_.spin); }

void Tool::state(Archive& archive) {
  archive("translation", pose_.translation);
  archive("turn", pose_.turn);
  archive("velocity", state_.velocity);
  archive("spin", state_.spin);
  archive("hand force", state_.hand_force);
  archive("hand torque", state_.hand_torque);
  if (archive.loads()) end_ = pose_;
}

}  // namespace suture
