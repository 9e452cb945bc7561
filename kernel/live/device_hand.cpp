// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/device_hand.hpp"

#include <algorithm>

#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/live/hand.hpp"
#include "kernel/live/json_text.hpp"

namespace suture {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t grasping = 1;  ///< button 0
/// Closer than this part of an edge, the hand is there.
constexpr double same = 1e-9;

Vec3 middle_of(Simulation& simulation) {
  Attributes& attributes = simulation.attributes();
  Box box = no_box;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    include(box, row(attributes.position().rows(), v));
  return plus(scaled(0.5, plus(box.low, box.high)), simulation.origin());
}

std::optional<std::size_t> obstacle_of(const Simulation& simulation, const std::string& name) {
  const ContactLaw* contact = simulation.contact();
  std::vector<std::string> names;
  for (std::size_t i = 0; contact && i < contact->obstacles().size(); ++i) {
    const Obstacle& obstacle = contact->obstacles()[i];
    if (name.empty() ? obstacle.coupling.has_value() : obstacle.name == name) return i;
    names.push_back(obstacle.name);
  }
  if (name.empty()) return {};
  throw InputError("the scene has no obstacle '" + name + "' for the device to move" +
                   did_you_mean(name, names));
}

}  // namespace

DeviceHand::DeviceHand(Simulation& simulation, const std::string& obstacle, double edge)
    : simulation_(simulation), obstacle_(obstacle_of(simulation, obstacle)), edge_(edge) {
  if (!obstacle_) cursor_.place = middle_of(simulation);
  engage({});
}

void DeviceHand::engage(const suture_device_pose& pose) {
  engaged_ = pose_ = pose;
  if (obstacle_)
    base_ = simulation_.contact()->obstacles()[*obstacle_].motion.pose(simulation_.time());
  engaged_cursor_ = cursor_.place;
}

std::string DeviceHand::input(const suture_device_pose& pose, double steps, double dt) {
  std::string input = obstacle_ ? steered(pose, steps, dt) : grasped(pose, steps, dt);
  pose_ = pose;
  return input;
}

// With R and x of the device, relative to when it was engaged:
//   t = t_engaged + x - x_engaged,   R_hand = R R_engaged^T R_hand,engaged
std::string DeviceHand::steered(const suture_device_pose& pose, double steps, double dt) const {
  const Obstacle& obstacle = simulation_.contact()->obstacles()[*obstacle_];
  const Pose now = obstacle.motion.pose(simulation_.time());
  const Vec3 translation = plus(base_.translation, minus(position_of(pose), position_of(engaged_)));
  const Rotation turn = turned(rotation_between(turn_of(engaged_), turn_of(pose)), base_.turn);
  const Vec3 way = minus(translation, now.translation), twist = rotation_between(now.turn, turn);
  const double length = norm(way) + obstacle.reach() * norm(twist);
  if (length <= same * edge_) return "";
  const double part = std::min(1.0, hand_reach * edge_ * steps / length);
  const Vec3 rotation = rotation_between(no_rotation, turned(scaled(part, twist), now.turn));
  return json_text(Json{{"steer",
                         {{"obstacle", obstacle.name},
                          {"translation", plus(now.translation, scaled(part, way))},
                          {"rotation", rotation},
                          {"during", steps * dt}}}});
}

std::string DeviceHand::grasped(const suture_device_pose& pose, double steps, double dt) {
  cursor_.place = plus(engaged_cursor_, minus(position_of(pose), position_of(engaged_)));
  const bool is_down = pose.buttons & grasping, was_down = pose_.buttons & grasping;
  const std::optional<Vec3> held = held_place();
  if (is_down && !was_down) {
    cursor_.grip.reset();
    const Json sphere{{"centre", cursor_.place}, {"radius", 1.2 * edge_}};
    return json_text(
        Json{{"grasp", {{"name", device_grasp_name}, {"where", {{"sphere", sphere}}}}}});
  }
  if (!held) return "";
  if (!is_down) return release_input(device_grasp_name);
  if (!cursor_.grip) cursor_.grip = minus(cursor_.place, *held);
  const Vec3 way = minus(minus(cursor_.place, *cursor_.grip), *held);
  const double length = norm(way);
  if (length <= same * edge_) return "";
  const double part = std::min(1.0, hand_reach * edge_ * steps / length);
  return json_text(Json{{"move",
                         {{"grasp", device_grasp_name},
                          {"translation", scaled(part, way)},
                          {"during", steps * dt}}}});
}

std::optional<Vec3> DeviceHand::held_place() const {
  const auto held = simulation_.built().body().constraints().held_by(device_grasp_name);
  if (held.empty()) return {};
  Vec3 sum{};
  for (const auto& each : held)
    sum = plus(sum, row(simulation_.attributes().position().rows(), each.vertex));
  return plus(scaled(1 / static_cast<double>(held.size()), sum), simulation_.origin());
}

FeltForce DeviceHand::force() const {
  FeltForce felt;
  felt.at = pose_;
  if (!obstacle_) {
    felt.force = simulation_.force_on_grasp(device_grasp_name);
    return felt;
  }
  const ContactLaw& contact = *simulation_.contact();
  if (const auto tool = contact.tool_state(*obstacle_)) {
    const Coupling& coupling = *contact.obstacles()[*obstacle_].coupling;
    felt.force = tool->hand_force;
    felt.torque = tool->hand_torque;
    felt.stiffness = coupling.stiffness;
    felt.turning_stiffness = coupling.turning_stiffness;
  } else {
    felt.force = contact.loads()[*obstacle_].force;
    felt.torque = contact.loads()[*obstacle_].torque;
  }
  return felt;
}

Vec3 DeviceHand::place() const {
  if (!obstacle_) return cursor_.place;
  const Pose pose = simulation_.contact()->obstacles()[*obstacle_].motion.pose(simulation_.time());
  return plus(pose.place(pose.centre), simulation_.origin());
}

Vec3 DeviceHand::rotation() const {
  if (!obstacle_) return rotation_between(no_rotation, turn_of(pose_));
  return rotation_vector(
      simulation_.contact()->obstacles()[*obstacle_].motion.pose(simulation_.time()));
}

std::string DeviceHand::holds() const {
  return obstacle_ ? "obstacle '" + simulation_.contact()->obstacles()[*obstacle_].name + "'"
                   : "what button 0 grasps";
}

}  // namespace suture
