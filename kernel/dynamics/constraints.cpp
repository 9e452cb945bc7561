// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/prescribed_position.hpp"

namespace suture {
namespace {

/// A motion at one time: what is the same for all its vertices.
class Placement {
 public:
  Placement(const PrescribedMotion& motion, double time)
      : motion_(motion), moves_(motion.moves()), is_turned_(motion.turn != no_rotation) {
    if (!moves_) return;
    const Placed now = motion.at(time);
    sine_ = std::sin(now.angle);
    cosine_ = std::cos(now.angle);
    shift_ = now.translation;
    drift_ = now.velocity;
    const double length = std::sqrt(dot(motion.axis, motion.axis));
    for (std::size_t c = 0; c < 3; ++c) {
      axis_[c] = length > 0 ? motion.axis[c] / length : 0;
      spin_[c] = now.spin * axis_[c];
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
    Vec3 r{rest[0] - c[0], rest[1] - c[1], rest[2] - c[2]};
    if (is_turned_) r = {dot(motion_.turn[0], r), dot(motion_.turn[1], r), dot(motion_.turn[2], r)};
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
  bool moves_, is_turned_;
  double sine_ = 0, cosine_ = 1;
  Vec3 axis_{}, shift_{}, drift_{}, spin_{};
};

}  // namespace

Vec3 prescribed_position(const PrescribedMotion& motion, const Vec3& rest, double t) {
  Vec3 x, v;
  Placement(motion, t).place(rest, x, v);
  return x;
}

void Constraints::add(std::span<const Index> vertices, std::uint8_t components,
                      const PrescribedMotion& motion, Attributes& attributes, std::string name) {
  Group& group = groups_.emplace_back(Group{std::move(name),
                                            Carrier{}.obstacle,
                                            false,
                                            motion,
                                            components,
                                            {vertices.begin(), vertices.end()},
                                            {},
                                            {},
                                            0});
  std::ranges::sort(group.vertices);
  read_rest(group, attributes.rest());
  find_path_length(group);
  for (const Index v : vertices) {
    const int bits = static_cast<int>(attributes.fixed().get(v, 0)) | components;
    attributes.fixed().set(v, 0, bits);
  }
  gather(attributes);
}

/// Sets the length of the longest path of a vertex, that of the one farthest from the axis.
void Constraints::find_path_length(Group& group) {
  const PrescribedMotion& motion = group.motion;
  const double axis = norm(motion.axis);
  double radius = 0;
  for (const Vec3& rest : group.rest)
    if (axis > 0)
      radius = std::max(radius, norm(cross(motion.axis, minus(rest, motion.centre))) / axis);
  if (!group.rest.empty())
    group.path_length = motion.path.empty()
                            ? norm(motion.translation) + std::abs(motion.angle) * radius
                            : (motion.end() - motion.begin()) * motion.path.top_speed(radius);
}

/// The lists of what is held and what is driven, from the groups.
void Constraints::gather(Attributes& attributes) {
  std::map<Index, std::uint8_t> held, driven;
  for (const Group& group : groups_)
    for (const Index v : group.vertices) {
      held[v] |= group.components;
      if (group.motion.moves()) driven[v] |= group.components;
    }
  constrained_.clear();
  driven_.clear();
  for (const auto& [vertex, components] : held) constrained_.push_back({vertex, components});
  const Column& velocity = attributes.velocity();
  for (const auto& [vertex, components] : driven)
    driven_.push_back({{vertex, components},
                       {velocity.get(vertex, 0), velocity.get(vertex, 1), velocity.get(vertex, 2)},
                       {},
                       {}});
}

void Constraints::read_rest(Group& group, const Column& places) {
  group.rest.clear();
  for (const Index v : group.vertices)
    group.rest.push_back({places.get(v, 0), places.get(v, 1), places.get(v, 2)});
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
        velocity[at + c] = gives_velocity_ ? v[c] : 0;
      }
    }
  }
}

namespace {

/// Those of a list with vertices in begin .. end-1.
template <class List>
auto within(List& list, Index begin, Index end) {
  const auto vertex = [](const auto& entry) { return entry.vertex; };
  const auto first = std::ranges::lower_bound(list, begin, {}, vertex);
  return std::span(
      first, std::lower_bound(first, list.end(), end,
                              [](const auto& entry, Index limit) { return entry.vertex < limit; }));
}

/// The row of a vertex in a column of rows of 4.
double* row(Column& column, Index vertex) { return column.rows() + std::size_t{vertex} * 4; }

/// visit(c) for each component of the bits.
template <class Visit>
void for_each_component(std::uint8_t bits, Visit visit) {
  for (std::size_t c = 0; c < 3; ++c)
    if ((bits >> c & 1) != 0) visit(c);
}

}  // namespace

void Constraints::before_drift(Attributes& attributes, const Vec3& gravity, Index begin,
                               Index end) {
  const double* mass = attributes.mass().rows();
  for (Driven& driven : within(driven_, begin, end)) {
    const double *f = row(attributes.force(), driven.vertex),
                 *x = row(attributes.position(), driven.vertex);
    for (std::size_t c = 0; c < 3; ++c) {
      driven.force[c] = f[c] + mass[driven.vertex] * gravity[c];
      driven.position[c] = x[c];
    }
    double* v = row(attributes.velocity(), driven.vertex);
    for_each_component(driven.components, [&](std::size_t c) { v[c] = 0; });
  }
  for (const Constrained& held : within(constrained_, begin, end)) {
    double* f = row(attributes.force(), held.vertex);
    for_each_component(held.components,
                       [&](std::size_t c) { f[c] = -mass[held.vertex] * gravity[c]; });
  }
}

DrivenWork Constraints::after_drift(Attributes& attributes, double before, double now, Index begin,
                                    Index end, loops::PassSums& sums) {
  DrivenWork total;
  for (Driven& driven : within(driven_, begin, end)) {
    const double mass = attributes.mass().get(driven.vertex, 0);
    const double* x = row(attributes.position(), driven.vertex);
    for_each_component(driven.components, [&](std::size_t c) {
      const double old = driven.velocity[c], next = (x[c] - driven.position[c]) / now;
      const double force = driven.force[c];
      if (before > 0) sums.before += force * old;
      sums.after += force * next;
      sums.inertia += mass * next * next;
      total.work -= force * (before * old + now * next) / 2;
      total.inertia += mass * (next * next - old * old) / 2;
      driven.velocity[c] = next;
    });
  }
  return total;
}

void Constraints::mark_driven(std::vector<bool>& marks) const {
  for (const Driven& driven : driven_) marks[driven.vertex] = true;
}

void Constraints::drift(Attributes& attributes, double dt, double end_time, Index begin,
                        Index end) {
  const auto driven_here = within(driven_, begin, end);
  if (driven_here.empty()) return;
  for (Driven& driven : driven_here)
    std::copy_n(row(attributes.position(), driven.vertex), 3, driven.position.begin());
  apply(attributes, end_time, begin, end);
  for (Driven& driven : driven_here) {
    const double* x = row(attributes.position(), driven.vertex);
    for_each_component(driven.components, [&](std::size_t c) {
      driven.velocity[c] = (x[c] - driven.position[c]) / dt;
    });
  }
}

Index Constraints::first_not_finite(const Column& column, Index begin, Index end) const {
  for (const Constrained& held : within(constrained_, begin, end))
    for (int c = 0; c < 3; ++c)
      if ((held.components >> c & 1) != 0 && !std::isfinite(column.get(held.vertex, c)))
        return held.vertex;
  return none;
}

void Constraints::before_kick(Attributes& attributes, Index begin, Index end) const {
  for (const Driven& driven : within(driven_, begin, end)) {
    double* v = row(attributes.velocity(), driven.vertex);
    for_each_component(driven.components, [&](std::size_t c) { v[c] = 0; });
  }
}

DrivenWork Constraints::after_kick(Attributes& attributes, const Vec3& gravity, double before,
                                   Index begin, Index end, loops::PassSums& sums) const {
  DrivenWork total;
  for (const Driven& driven : within(driven_, begin, end)) {
    const double mass = attributes.mass().get(driven.vertex, 0);
    const double* f = row(attributes.force(), driven.vertex);
    for_each_component(driven.components, [&](std::size_t c) {
      const double force = f[c] + mass * gravity[c];
      sums.before += force * driven.velocity[c];
      total.work -= force * before * driven.velocity[c] / 2;
    });
  }
  return total;
}

double Constraints::work_until_now(Attributes& attributes, const Vec3& gravity,
                                   double before) const {
  loops::PassSums unused{};
  return after_kick(attributes, gravity, before, 0, none, unused).work;
}

double Constraints::driven_kinetic(Attributes& attributes) const {
  double sum = 0;
  for (const Driven& driven : driven_) {
    const double mass = attributes.mass().get(driven.vertex, 0);
    const double* v = row(attributes.velocity(), driven.vertex);
    for_each_component(driven.components, [&](std::size_t c) { sum += mass * v[c] * v[c] / 2; });
  }
  return sum;
}

double Constraints::driven_inertia(Attributes& attributes) const {
  double sum = 0;
  for (const Driven& driven : driven_) {
    const double mass = attributes.mass().get(driven.vertex, 0);
    for_each_component(driven.components, [&](std::size_t c) {
      sum += mass * driven.velocity[c] * driven.velocity[c];
    });
  }
  return sum;
}

Placed PrescribedMotion::at(double time) const {
  if (!path.empty()) return path.at(time);
  const double s = ramp.value(time), rate = ramp.rate(time);
  return {scaled(s, translation), s * angle, scaled(rate, translation), rate * angle};
}

void PrescribedMotion::state(Archive& archive) {
  archive("translation", translation);
  archive("axis", axis);
  archive("centre", centre);
  archive("angle", angle);
  archive("from", ramp.from);
  archive("to", ramp.to);
  archive("smooth", ramp.smooth);
  archive("path", path);
  archive("turn", turn);
  archive("reach", reach);
}

void Constraints::state(Archive& archive) {
  if (archive.has_cells()) {
    archive.each("groups", groups_, [](Archive& each, Group& group) {
      each("name", group.name);
      each("carrier", group.carrier);
      each("is grasp", group.is_grasp);
      each("components", group.components);
      each("motion", group.motion);
      each("way", group.path_length);
      each("vertices", group.vertices);
      each("rest", group.rest);
      each("member", group.member);
    });
    archive.group("held", [&] {
      archive.member("vertex", constrained_, &Constrained::vertex);
      archive.member("components", constrained_, &Constrained::components);
    });
    archive.group("driven", [&] {
      archive.member("vertex", driven_, &Driven::vertex);
      archive.member("components", driven_, &Driven::components);
    });
  }
  archive.member("mean velocities", driven_, &Driven::velocity);
}

/// Sets the places from which a group moves: at rest, or where a grasp took hold.
void Constraints::set_places(Group& group, const std::map<Index, Vec3>& places,
                             Attributes& attributes) {
  if (!group.is_grasp) return read_rest(group, attributes.rest());
  group.rest.clear();
  for (const Index v : group.vertices) group.rest.push_back(places.at(v));
}

/// Vertices with the motion of a group, for some of its components only.
Constraints::Group Constraints::part_of(const Group& group, std::uint8_t components,
                                        std::vector<Index> vertices,
                                        const std::map<Index, Vec3>& places,
                                        Attributes& attributes) {
  sort_unique(vertices);
  Group part{group.name,
             group.carrier,
             group.is_grasp,
             group.motion,
             components,
             std::move(vertices),
             {},
             {},
             group.path_length};
  set_places(part, places, attributes);
  return part;
}

void Constraints::update(const TopologyChange& change, Attributes& attributes) {
  const auto& splits = change.splits[0];
  const auto& merges = change.merges[0];
  const auto& removed = change.removed[0];
  if (splits.empty() && merges.empty() && removed.empty()) return;
  find_members(attributes.vertex_count());
  std::vector<std::uint8_t> held_before;
  bool any = false;
  for (const Merge& merge : merges) held_before.push_back(constrained_components(merge.kept));
  std::vector<Group> partial;  // of the same motion, for some components only
  for (Group& group : groups_) {
    const auto before = static_cast<std::ptrdiff_t>(group.vertices.size());
    std::map<Index, Vec3> places;  // of a grasp
    for (std::size_t i = 0; group.is_grasp && i < group.vertices.size(); ++i)
      places[group.vertices[i]] = group.rest[i];
    const auto join = [&](Index vertex) {
      if (group.member[vertex]) return;
      group.member[vertex] = true;
      group.vertices.push_back(vertex);
    };
    for (const Split& split : splits)
      if (group.member[split.old_cell]) {
        join(split.new_cell);
        if (group.is_grasp) places[split.new_cell] = places[split.old_cell];
      }
    std::array<std::vector<Index>, 8> in_part;  // by components; 0: held already
    bool loses = false;
    const auto leave = [&](Index vertex) {
      loses = loses || group.member[vertex];
      group.member[vertex] = false;
    };
    for (std::size_t i = 0; i < merges.size(); ++i) {
      const auto more = static_cast<std::uint8_t>(group.components & ~held_before[i]);
      if (group.is_grasp && group.member[merges[i].gone])
        places.try_emplace(merges[i].kept, places[merges[i].gone]);
      if (group.member[merges[i].gone] && more == group.components)
        join(merges[i].kept);
      else if (group.member[merges[i].gone])
        in_part[more].push_back(merges[i].kept);
      leave(merges[i].gone);
    }
    for (std::uint8_t more = 1; more < 8; ++more)
      if (!in_part[more].empty())
        partial.push_back(part_of(group, more, std::move(in_part[more]), places, attributes));
    for (const Index vertex : removed) leave(vertex);
    const auto joined = group.vertices.begin() + before;
    const bool changes = loses || joined != group.vertices.end() || !merges.empty();
    std::sort(joined, group.vertices.end());
    std::inplace_merge(group.vertices.begin(), joined, group.vertices.end());
    if (loses) std::erase_if(group.vertices, [&](Index v) { return !group.member[v]; });
    if (changes) set_places(group, places, attributes);
    any = any || changes;
  }
  for (Group& group : partial) groups_.push_back(std::move(group));
  if (!any) return;
  regather(attributes, splits);
}

/// gather() during a run.
void Constraints::regather(Attributes& attributes, std::span<const Split> splits) {
  const std::vector<Driven> before = std::move(driven_);
  gather(attributes);
  // Those that continue have the mean velocity that they had, the parts of a split vertex its own.
  const auto hand_on = [&](Index from, Index to) {
    const auto old = std::ranges::lower_bound(before, from, {}, &Driven::vertex);
    const auto now = std::ranges::lower_bound(driven_, to, {}, &Driven::vertex);
    if (old != before.end() && old->vertex == from && now != driven_.end() && now->vertex == to)
      now->velocity = old->velocity;
  };
  for (const Driven& driven : before) hand_on(driven.vertex, driven.vertex);
  for (const Split& split : splits) hand_on(split.old_cell, split.new_cell);
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
std::uint8_t Constraints::constrained_components(Index vertex) const {
  std::uint8_t components = 0;
  for (const Group& group : groups_)
    if (group.member[vertex]) components |= group.components;
  return components;
}

// A smooth ramp is at most 1.5 times as fast as a linear one.
double Constraints::longest_step(double time) const {
  double step = std::numeric_limits<double>::infinity();
  for (const Group& group : groups_) {
    const PrescribedMotion& motion = group.motion;
    const bool is_moving = motion.moves() && time >= motion.begin() && time < motion.end();
    if (!is_moving || motion.reach == 0) continue;
    const double speed =
        group.path_length / (motion.end() - motion.begin()) * (motion.ramp.smooth ? 1.5 : 1);
    step = std::min(step, motion.reach / speed);
  }
  return step;
}

double Constraints::largest_turn(double from, double to) const {
  double largest = 0;
  for (const Group& group : groups_) {
    const PrescribedMotion& motion = group.motion;
    const double turn = motion.path.empty()
                            ? motion.angle * (motion.ramp.value(to) - motion.ramp.value(from))
                            : motion.path.at(to).angle - motion.path.at(from).angle;
    largest = std::max(largest, std::abs(turn));
  }
  return largest;
}

std::vector<double> Constraints::corners(double from, double to) const {
  std::vector<double> times;
  for (const Group& group : groups_) {
    const PrescribedMotion& motion = group.motion;
    if (!motion.moves()) continue;
    times.insert(times.end(), {motion.begin(), motion.end()});
    for (const MotionPath::Station& station : motion.path.stations) times.push_back(station.at);
  }
  std::erase_if(times, [&](double time) { return !(from < time && time < to); });
  sort_unique(times);
  return times;
}

double Constraints::last_change() const {
  double time = 0;
  for (const Group& group : groups_)
    if (group.motion.moves()) time = std::max(time, group.motion.end());
  return time;
}

}  // namespace suture
