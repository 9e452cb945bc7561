// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/translate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

/// Translates one thing after the other; an overload for each that may hold coordinates.
struct Translation {
  const BodyFrame& frame;
  double rounding = frame.rounding();

  void operator()(Vec3& point) const { point = minus(point, frame.origin); }
  void operator()(std::vector<Vec3>& points) const {
    for (Vec3& point : points) (*this)(point);
  }
  /// Moves a plane against its normal.
  void back(Vec3& point, const Vec3& normal) const {
    const double part = rounding / std::sqrt(dot(normal, normal));
    for (std::size_t a = 0; a < 3; ++a) point[a] -= part * normal[a];
  }

  // ---- selections ----

  void operator()(Selection::All&) const {}
  void operator()(Selection::InBox& box) const {
    (*this)(box.min);
    (*this)(box.max);
    for (std::size_t a = 0; a < 3; ++a) {
      box.min[a] -= rounding;
      box.max[a] += rounding;
    }
  }
  void operator()(Selection::Plane& plane) const {
    (*this)(plane.point);
    if (plane.tolerance < 0) plane.tolerance = Selection::default_tolerance * frame.diagonal;
    plane.tolerance += rounding;
  }
  void operator()(Selection::HalfSpace& half) const {
    (*this)(half.point);
    back(half.point, half.normal);
  }
  void operator()(Selection::Sphere& sphere) const {
    (*this)(sphere.centre);
    sphere.radius += rounding;
  }
  void operator()(Selection::Cylinder& cylinder) const {
    (*this)(cylinder.from);
    (*this)(cylinder.to);
    cylinder.radius += rounding;
  }
  void operator()(Selection::Nearest& nearest) const {
    (*this)(nearest.point);
    nearest.tie = rounding;
  }
  void operator()(Selection::Ids&) const {}
  void operator()(Selection::Named&) const {}
  void operator()(Selection::Combined& combined) const {
    for (Selection& part : combined.parts) (*this)(part);
  }
  void operator()(Selection& selection) const { std::visit(*this, selection.what); }
  void operator()(std::array<Selection, 2>& sides) const {
    for (Selection& side : sides) (*this)(side);
  }
  template <class T>
  void operator()(std::optional<T>& value) const {
    if (value) (*this)(*value);
  }

  void operator()(CellValues& values) const {
    for (CellValues::Part& part : values.parts) (*this)(part.region);
  }

  // ---- events ----

  void operator()(CutPlane& cut) const {
    (*this)(cut.point);
    (*this)(cut.polygon);
    back(cut.point, cut.normal);
    cut.radius += rounding;
  }
  void operator()(CutSurface& cut) const { (*this)(cut.translation); }
  void operator()(CutBlade& cut) const {
    for (CutBlade::Station& station : cut.stations) (*this)(station.points);
    if (cut.carried) (*this)(cut.carried->points);
    if (cut.resistance) (*this)(cut.resistance->toughness);
  }
  void operator()(CutFaces&) const {}
  void operator()(Pierce& pierce) const {
    (*this)(pierce.where);
    (*this)(pierce.path);
    pierce.radius += rounding;
  }
  void operator()(Tear& tear) const { (*this)(tear.where); }
  void operator()(SewFaces& sew) const {
    (*this)(sew.where);
    (*this)(sew.between);
  }
  void operator()(RemoveIslands& islands) const { (*this)(islands.outside); }
  void operator()(Constraint& constraint) const {
    (*this)(constraint.where);
    if (constraint.angle != 0 || constraint.path.turns())
      (*this)(constraint.centre);  // else far away for nothing
  }
  void operator()(Load& load) const {
    (*this)(load.where);
    for (auto& point : load.profile.points) point[0] -= dot(frame.origin, load.profile.along);
  }
  void operator()(InitialMotion& motion) const {
    (*this)(motion.where);
    (*this)(motion.centre);
  }
  void operator()(Grasp& grasp) const { (*this)(grasp.held); }
  void operator()(Release&) const {}
  void operator()(Condition& condition) const {
    (*this)(condition.where);
    if (condition.of != Condition::Of::position) return;
    if (condition.component < 3)
      condition.bound -= frame.origin[static_cast<std::size_t>(condition.component)];
    else
      (*this)(condition.zero);
  }
  void operator()(Event& event) const {
    (*this)(event.when);
    std::visit(*this, event.what);
  }

  // ---- the scene ----

  void operator()(MeshSource& mesh) const {
    if (mesh.box) (*this)(mesh.box->origin);
    if (mesh.voxels) (*this)(mesh.voxels->origin);
  }
  void operator()(ModelUse& use) const {
    (*this)(use.region);
    (*this)(use.between);
    for (CellValues& values : use.values) (*this)(values);
  }
  void operator()(Obstacle& obstacle) const {
    translate(obstacle.shape, minus(Vec3{}, frame.origin));
    (*this)(obstacle.motion.centre);
  }
  void operator()(Scene& scene) const {
    (*this)(scene.mesh);
    for (NamedSelection& set : scene.sets) (*this)(set.where);
    for (ModelUse& use : scene.models) (*this)(use);
    for (Constraint& constraint : scene.constraints) (*this)(constraint);
    for (InitialMotion& motion : scene.initial_motion) (*this)(motion);
    for (Foundation& foundation : scene.foundations) (*this)(foundation.where);
    for (Load& load : scene.loads) (*this)(load);
    for (FieldCondition& condition : scene.fields) (*this)(condition.where);
    for (Obstacle& obstacle : scene.contact.obstacles) (*this)(obstacle);
    for (Event& event : scene.events) (*this)(event);
    for (Probe& probe : scene.output.probes) (*this)(probe.where);
  }
};

template <class T>
T translated(T value, const BodyFrame& frame) {
  if (!frame.is_scene()) Translation{frame}(value);
  return value;
}

}  // namespace

// A coordinate is rounded when it is written and when the origin is taken off, those of
// nodes and centroids a few times more.
double BodyFrame::rounding() const {
  if (is_scene()) return 0;
  const double largest =
      std::max({std::abs(origin[0]), std::abs(origin[1]), std::abs(origin[2])}) + diagonal;
  return 4 * std::numeric_limits<double>::epsilon() * largest;
}

Vec3 BodyFrame::in_scene(const Vec3& local) const {
  if (is_scene()) return local;
  return {local[0] + origin[0], local[1] + origin[1], local[2] + origin[2]};
}

Scene in_frame(Scene scene, const BodyFrame& frame) { return translated(std::move(scene), frame); }
Event in_frame(Event event, const BodyFrame& frame) { return translated(std::move(event), frame); }
Selection in_frame(Selection selection, const BodyFrame& frame) {
  return translated(std::move(selection), frame);
}

}  // namespace suture
