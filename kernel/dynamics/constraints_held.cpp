// SPDX-License-Identifier: GPL-3.0-or-later
//
// Constraints that take hold of vertices during a run, and let go.
#include <algorithm>
#include <array>
#include <map>

#include "kernel/base/sort_unique.hpp"
#include "kernel/dynamics/constraints.hpp"

namespace suture {

Index Constraints::grasp(std::span<const Index> vertices, std::uint8_t components,
                         const PrescribedMotion& motion, Attributes& attributes,
                         const std::string& name, const Carrier& carrier) {
  std::array<std::vector<Index>, 8> free;  // by free components
  for (const Index v : vertices)
    free[components & ~static_cast<unsigned>(attributes.fixed().get(v, 0))].push_back(v);
  Index count = 0;
  for (std::uint8_t taken = 1; taken < 8; ++taken) {
    if (free[taken].empty()) continue;
    Group& group = groups_.emplace_back(
        Group{name, carrier.obstacle, true, motion, taken, std::move(free[taken]), {}, {}, 0});
    std::ranges::sort(group.vertices);
    count += static_cast<Index>(group.vertices.size());
    read_rest(group, attributes.position());
    if (carrier.obstacle != Carrier{}.obstacle)
      for (Vec3& place : group.rest) place = carrier.pose.given(place);
    find_path_length(group);
    for (const Index v : group.vertices)
      attributes.fixed().set(v, 0, static_cast<int>(attributes.fixed().get(v, 0)) | taken);
  }
  regather(attributes, {});
  return count;
}

void Constraints::redirect(std::size_t obstacle, const PrescribedMotion& motion,
                           Attributes& attributes) {
  for (Group& group : groups_) {
    if (group.carrier != obstacle) continue;
    const double reach = group.motion.reach;
    group.motion = motion;
    group.motion.reach = reach;
    find_path_length(group);
  }
  regather(attributes, {});
}

void Constraints::redirect(const std::string& grasp, const PrescribedMotion& motion,
                           Attributes& attributes) {
  for (Group& group : groups_) {
    if (!group.is_grasp || group.name != grasp) continue;
    group.motion = motion;
    read_rest(group, attributes.position());
    find_path_length(group);
  }
  regather(attributes, {});
}

std::vector<Index> Constraints::release(const std::string& name, Attributes& attributes) {
  std::vector<Index> released;
  for (const Held& held : held_by(name)) released.push_back(held.vertex);
  std::erase_if(groups_, [&](const Group& group) { return group.name == name; });
  regather(attributes, {});
  mark(attributes);
  return released;
}

void Constraints::mark(Attributes& attributes) const {
  for (Index v = 0; v < attributes.vertex_count(); ++v) attributes.fixed().set(v, 0, 0);
  for (const Constrained& held : constrained_)
    attributes.fixed().set(held.vertex, 0, held.components);
}

std::vector<Constraints::Held> Constraints::held_by(const std::string& name) const {
  std::map<Index, std::uint8_t> held;
  for (const Group& group : groups_)
    if (group.name == name)
      for (const Index v : group.vertices) held[v] |= group.components;
  std::vector<Held> result;
  for (const auto& [vertex, components] : held) result.push_back({vertex, components});
  return result;
}

std::vector<std::string> Constraints::names() const {
  std::vector<std::string> names;
  for (const Group& group : groups_)
    if (!group.name.empty()) names.push_back(group.name);
  sort_unique(names);
  return names;
}

std::vector<bool> Constraints::always_fixed(Index vertex_count) const {
  std::vector<std::uint8_t> held(vertex_count);
  std::vector<bool> result(vertex_count);
  for (const Group& group : groups_)
    if (!group.motion.moves() && group.name.empty())
      for (const Index v : group.vertices) held[v] |= group.components;
  for (const Group& group : groups_)
    if (group.motion.moves())
      for (const Index v : group.vertices) held[v] = 0;
  for (Index v = 0; v < vertex_count; ++v) result[v] = held[v] == 7;
  return result;
}

Index Constraints::vertex_count() const {
  std::size_t count = 0;
  for (const Group& group : groups_) count += group.vertices.size();
  return static_cast<Index>(count);
}

bool Constraints::follow_rest(double time) const {
  return std::ranges::all_of(groups_, [&](const Group& group) {
    return !group.is_grasp && group.motion.turn == no_rotation && group.motion.at(time).angle == 0;
  });
}

}  // namespace suture
