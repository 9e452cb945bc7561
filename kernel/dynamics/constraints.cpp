// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/constraints.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

/// A motion at one time: what is the same for all its vertices.
class Placement {
 public:
  Placement(const PrescribedMotion& motion, double time) : motion_(motion), moves_(motion.moves()) {
    if (!moves_) return;
    const double s = motion.ramp.value(time), rate = motion.ramp.rate(time);
    sine_ = std::sin(s * motion.angle);
    cosine_ = std::cos(s * motion.angle);
    const double length = std::sqrt(dot(motion.axis, motion.axis));
    for (std::size_t c = 0; c < 3; ++c) {
      axis_[c] = length > 0 ? motion.axis[c] / length : 0;
      shift_[c] = s * motion.translation[c];
      drift_[c] = rate * motion.translation[c];
      spin_[c] = rate * motion.angle * axis_[c];
    }
  }

  /// Rodrigues: R r = cos r + sin a x r + (1 - cos) (a . r) a.
  void place(const Vec3& rest, Vec3& x, Vec3& v) const {
    if (!moves_) {
      x = rest;
      v = {};
      return;
    }
    const Vec3& c = motion_.centre;
    const Vec3 r{rest[0] - c[0], rest[1] - c[1], rest[2] - c[2]};
    const Vec3 across = cross(axis_, r);
    const double along = (1 - cosine_) * dot(axis_, r);
    Vec3 turned;
    for (std::size_t i = 0; i < 3; ++i)
      turned[i] = cosine_ * r[i] + sine_ * across[i] + along * axis_[i];
    const Vec3 speed = cross(spin_, turned);
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] = c[i] + turned[i] + shift_[i];
      v[i] = speed[i] + drift_[i];
    }
  }

 private:
  const PrescribedMotion& motion_;
  bool moves_;
  double sine_ = 0, cosine_ = 1;
  Vec3 axis_{}, shift_{}, drift_{}, spin_{};
};

}  // namespace

void Constraints::add(std::span<const Index> vertices, std::uint8_t components,
                      const PrescribedMotion& motion, Attributes& attributes) {
  Group& group =
      groups_.emplace_back(Group{motion, components, {vertices.begin(), vertices.end()}, {}, {}});
  std::ranges::sort(group.vertices);
  read_rest(group, attributes);
  for (const Index v : vertices) {
    const int bits = static_cast<int>(attributes.fixed().get(v, 0)) | components;
    attributes.fixed().set(v, 0, bits);
  }
}

void Constraints::read_rest(Group& group, Attributes& attributes) {
  group.rest.clear();
  for (const Index v : group.vertices)
    group.rest.push_back(
        {attributes.rest().get(v, 0), attributes.rest().get(v, 1), attributes.rest().get(v, 2)});
}

void Constraints::apply(Attributes& attributes, double time, Index begin, Index end) const {
  double* position = attributes.position().rows();
  double* velocity = attributes.velocity().rows();
  for (const Group& group : groups_) {
    const auto first = std::ranges::lower_bound(group.vertices, begin);
    const auto last = std::lower_bound(first, group.vertices.end(), end);
    if (first == last) continue;
    const Placement placement(group.motion, time);
    Vec3 x, v;
    auto rest = group.rest.begin() + (first - group.vertices.begin());
    for (auto vertex = first; vertex != last; ++vertex, ++rest) {
      const std::size_t at = std::size_t{*vertex} * 4;
      placement.place(*rest, x, v);
      for (std::size_t c = 0; c < 3; ++c) {
        if (!(group.components >> c & 1)) continue;
        position[at + c] = x[c];
        velocity[at + c] = v[c];
      }
    }
  }
}

void Constraints::update(const TopologyChange& change, Attributes& attributes) {
  const auto& splits = change.splits[0];
  const auto& merges = change.merges[0];
  const auto& removed = change.removed[0];
  if (splits.empty() && merges.empty() && removed.empty()) return;
  find_members(attributes.vertex_count());
  std::vector<std::uint8_t> held_before;
  for (const Merge& merge : merges) held_before.push_back(held(merge.kept));
  for (Group& group : groups_) {
    const auto before = static_cast<std::ptrdiff_t>(group.vertices.size());
    const auto join = [&](Index vertex) {
      if (group.member[vertex]) return;
      group.member[vertex] = true;
      group.vertices.push_back(vertex);
    };
    for (const Split& split : splits)
      if (group.member[split.old_cell]) join(split.new_cell);
    bool loses = false;
    const auto leave = [&](Index vertex) {
      loses = loses || group.member[vertex];
      group.member[vertex] = false;
    };
    for (std::size_t i = 0; i < merges.size(); ++i) {
      if (group.member[merges[i].gone] && (group.components & ~held_before[i]) != 0)
        join(merges[i].kept);
      leave(merges[i].gone);
    }
    for (const Index vertex : removed) leave(vertex);
    const auto joined = group.vertices.begin() + before;
    const bool changes = loses || joined != group.vertices.end() || !merges.empty();
    std::sort(joined, group.vertices.end());
    std::inplace_merge(group.vertices.begin(), joined, group.vertices.end());
    if (loses) std::erase_if(group.vertices, [&](Index v) { return !group.member[v]; });
    if (changes) read_rest(group, attributes);
  }
}

void Constraints::find_members(Index vertex_count) {
  for (Group& group : groups_) {
    const bool first = group.member.empty();
    group.member.resize(vertex_count);
    for (std::size_t i = 0; first && i < group.vertices.size(); ++i)
      group.member[group.vertices[i]] = true;
  }
}

/// Components that some group holds; needs find_members().
std::uint8_t Constraints::held(Index vertex) const {
  std::uint8_t components = 0;
  for (const Group& group : groups_)
    if (group.member[vertex]) components |= group.components;
  return components;
}

std::vector<bool> Constraints::still(Index vertex_count) const {
  std::vector<std::uint8_t> held(vertex_count);
  std::vector<bool> result(vertex_count);
  for (const Group& group : groups_)
    if (!group.motion.moves())
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

double Constraints::settled_after() const {
  double time = 0;
  for (const Group& group : groups_)
    if (group.motion.moves()) time = std::max(time, group.motion.ramp.to);
  return time;
}

}  // namespace suture
