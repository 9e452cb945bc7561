// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nodes that are held and let go during a run.
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

PrescribedMotion motion_of(const Constraint& constraint) {
  PrescribedMotion motion;
  if (!constraint.moves) return motion;
  motion.translation = constraint.translation;
  motion.axis = constraint.axis;
  motion.centre = constraint.centre;
  motion.angle = constraint.angle;
  motion.ramp = constraint.ramp;
  motion.path = constraint.path;
  return motion;
}

namespace {

/// Returns the motion of what an obstacle carries.
PrescribedMotion motion_of(const RigidPath& path) {
  PrescribedMotion motion;
  motion.axis = path.axis;
  motion.centre = path.centre;
  motion.turn = path.turn;
  for (const auto& [at, t, angle] : path.stations)
    motion.path.stations.push_back({at, {t[0], t[1], t[2], angle}, {}});
  return motion;
}

/// How far from an obstacle nodes touch it, in edges, unless the scene says otherwise.
constexpr double touching = 0.01;

}  // namespace

/// Returns the nodes that a grasp selects now; of listed nodes, also the copies made by cuts.
std::vector<Index> BuiltScene::graspable(const Grasp& grasp, double time) {
  if (grasp.obstacle)
    return body_.contact()->vertices_near(
        *grasp.obstacle, time, grasp.reach.value_or(touching * body_.contact()->mean_edge()));
  const Selection& where = grasp.held.where;
  std::vector<Index> found = selector_.vertices_now(where, body_.attributes().position().rows());
  if (!where.is_listed()) return found;
  const std::vector<Index>& point = body_.user_vertex();
  std::vector<bool> listed(names_.point_count);
  for (const Index v : found) listed[point[v]] = true;
  found.clear();
  for (Index v = 0; v < body_.attributes().vertex_count(); ++v)
    if (listed[point[v]] && body_.complex().exists(0, v)) found.push_back(v);
  return found;
}

Index BuiltScene::grasp(const Grasp& grasp, double time, const std::string& path) {
  const std::vector<std::string> names = body_.constraints().names();
  if (std::ranges::find(names, grasp.held.name) != names.end())
    throw InputError(path + "/name: '" + grasp.held.name +
                     "' holds nodes already; release it first, or choose another name");
  const std::vector<Index> vertices = graspable(grasp, time);
  const bool any_free = std::ranges::any_of(vertices, [&](Index v) {
    const int held = static_cast<int>(body_.attributes().fixed().get(v, 0));
    return (grasp.held.components & ~held) != 0;
  });
  if (!any_free)
    throw InputError(path + (grasp.obstacle ? "/obstacle: " : "/where: ") +
                     (!vertices.empty() ? "reaches only nodes that constraints hold already"
                      : grasp.obstacle  ? "touches no node of the body"
                                        : "selects no node of the deformed body") +
                     (grasp.obstacle
                          ? "; move the obstacle to the body before, or give a larger \"reach\""
                          : "; move the selection to where the body is at that time"));
  Carrier carrier;
  PrescribedMotion motion = motion_of(grasp.held);
  motion.ramp.from += time;
  motion.ramp.to += time;
  for (MotionPath::Station& station : motion.path.stations) station.at += time;
  if (grasp.obstacle) {
    carrier = {*grasp.obstacle, body_.contact()->pose(*grasp.obstacle, time)};
    motion = motion_of(body_.contact()->obstacles()[*grasp.obstacle].motion);
  }
  if (motion.moves()) motion.reach = shortest_edge(vertices) / 10;
  Index held = 0;
  dynamics_->constrain([&] {
    held = body_.constraints().grasp(vertices, grasp.held.components, motion, body_.attributes(),
                                     grasp.held.name, carrier);
    return std::vector<Index>();
  });
  return held;
}

void BuiltScene::redirect(std::size_t obstacle) {
  body_.constraints().redirect(obstacle, motion_of(body_.contact()->obstacles()[obstacle].motion),
                               body_.attributes());
}

void BuiltScene::move_grasp(const std::string& name, const Vec3& translation, double time,
                            double duration) {
  std::vector<Index> vertices;
  for (const auto& held : body_.constraints().held_by(name)) vertices.push_back(held.vertex);
  if (vertices.empty())
    throw InputError("nothing named '" + name + "' holds a node" +
                     did_you_mean(name, body_.constraints().names()));
  PrescribedMotion motion;
  motion.translation = translation;
  motion.ramp.from = time;
  motion.ramp.to = time + duration;
  motion.reach = shortest_edge(vertices) / 10;
  body_.constraints().redirect(name, motion, body_.attributes());
}

Index BuiltScene::release(const std::string& name, const std::string& path) {
  const std::vector<std::string> names = body_.constraints().names();
  if (std::ranges::find(names, name) == names.end())
    throw InputError(path + ": nothing named '" + name + "' holds a node at that time" +
                     did_you_mean(name, names) + "; release what was grasped before");
  std::vector<Index> freed;
  dynamics_->constrain(
      [&] { return freed = body_.constraints().release(name, body_.attributes()); });
  return static_cast<Index>(freed.size());
}

}  // namespace suture
