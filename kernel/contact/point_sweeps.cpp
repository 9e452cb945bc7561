// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/point_sweeps.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/contact/row_lanes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

using Row = PointSweeps::Row;

// Of the sum of the squares of the weights of a point. If less is on vertices that are free, these
// would have to move by 30 times the way of the point: the point counts as held.
constexpr double least_free = 1e-3;

SUTURE_INLINE RowLanes& as_lanes(Row& row) { return *reinterpret_cast<RowLanes*>(row.data()); }
SUTURE_INLINE const RowLanes& as_lanes(const Row& row) {
  return *reinterpret_cast<const RowLanes*>(row.data());
}

SUTURE_INLINE RowLanes sum_at(const PointSweeps::Contact& c, const PointSweeps::Vertex* vertices) {
  RowLanes sum{};
  for (std::uint32_t e = 0; e < c.count; ++e)
    sum += c.weights[e] * as_lanes(vertices[c.vertices[e]].change);
  return sum;
}

SUTURE_INLINE void add_at(const PointSweeps::Contact& c, const RowLanes& by,
                          PointSweeps::Vertex* vertices) {
  const RowLanes impulse = as_lanes(c.mass) * by;
  for (std::uint32_t e = 0; e < c.count; ++e) {
    PointSweeps::Vertex& vertex = vertices[c.vertices[e]];
    as_lanes(vertex.change) += c.weights[e] * impulse * as_lanes(vertex.inverse_mass);
  }
}

SUTURE_CLONES
void sweep_over(PointSweeps::Contact* contacts, const std::uint32_t* order, std::size_t count,
                PointSweeps::Vertex* vertices, PointSweeps::Changes& changes) {
  double largest = changes.largest, energy = changes.energy, all = changes.all;
  for (std::size_t i = 0; i < count; ++i) {
    PointSweeps::Contact& c = contacts[order[i]];
    const RowLanes last = as_lanes(c.change), normal = as_lanes(c.normal);
    const RowLanes others = sum_at(c, vertices) - last;
    const double pressed = c.lacking - dot(normal, others);
    RowLanes change{};
    c.pressed = 0;
    if (pressed > 0) {
      c.pressed = pressed;
      const RowLanes relative = as_lanes(c.velocity) + others;
      const RowLanes sliding = relative - dot(relative, normal) * normal;
      const double speed = std::sqrt(dot(sliding, sliding)), most = c.friction * pressed;
      c.sliding = speed;
      change = pressed * normal - (most < speed ? most / speed : most > 0 ? 1.0 : 0.0) * sliding;
    }
    all += c.mass[0] * dot(change, change);
    const RowLanes by = change - last;
    const double squared = dot(by, by);
    if (squared == 0) continue;
    as_lanes(c.change) = change;
    largest = squared > largest ? squared : largest;
    energy += c.mass[0] * squared;
    add_at(c, by, vertices);
  }
  changes = {largest, energy, all};
}

SUTURE_CLONES
void sum_masses(PointSweeps::Contact& c, const PointSweeps::Vertex* vertices) {
  RowLanes inverse{};
  for (std::uint32_t e = 0; e < c.count; ++e)
    inverse += c.weights[e] * c.weights[e] * as_lanes(vertices[c.vertices[e]].inverse_mass);
  as_lanes(c.mass) = inverse;
}

}  // namespace

void PointSweeps::add_vertex(Index vertex, double mass, unsigned held) {
  Vertex& added = vertices[vertex];
  added.change = {};
  for (unsigned c = 0; c < 3; ++c) added.inverse_mass[c] = (held >> c & 1) != 0 ? 0 : 1 / mass;
  added.inverse_mass[3] = 0;
}

void PointSweeps::add(const ContactPoint& point, const double* masses) {
  Contact& added = contacts.emplace_back();
  added.vertices = point.vertices.data();
  added.weights = point.weights.data();
  added.count = static_cast<std::uint32_t>(point.vertices.size());
  sum_masses(added, vertices.data());
  double if_free = 0, all = 0;  // sum w^2 / m, sum w^2
  Vec3 free{};                  // sum w^2 over vertices that are free, by component
  for (std::uint32_t e = 0; e < added.count; ++e) {
    const double squared = added.weights[e] * added.weights[e];
    const Vertex& vertex = vertices[added.vertices[e]];
    if_free += squared / masses[added.vertices[e]];
    all += squared;
    for (unsigned c = 0; c < 3; ++c)
      if (vertex.inverse_mass[c] > 0) free[c] += squared;
  }
  for (unsigned c = 0; c < 3; ++c) {
    if (free[c] <= least_free * all) {
      added.fixed = static_cast<std::uint8_t>(added.fixed | 1u << c);
      added.mass[c] = if_free;
    }
    added.mass[c] = 1 / added.mass[c];
  }
}

void PointSweeps::sweep(std::span<const std::uint32_t> order, Changes& changes) {
  sweep_over(contacts.data(), order.data(), order.size(), vertices.data(), changes);
}

Vec3 PointSweeps::change_by_others(const Contact& contact) const {
  return suture::vec_of(sum_at(contact, vertices.data()) - as_lanes(contact.change));
}

void PointSweeps::set_change(Contact& contact, const Vec3& change, Changes& changes) {
  const RowLanes now = lanes_of(change), by = now - as_lanes(contact.change);
  changes.all += contact.mass[0] * dot(now, now);
  const double squared = dot(by, by);
  if (squared == 0) return;
  as_lanes(contact.change) = now;
  changes.largest = std::max(changes.largest, squared);
  changes.energy += contact.mass[0] * squared;
  add_at(contact, by, vertices.data());
}

void PointSweeps::add_change(Contact& contact, const Vec3& change) {
  as_lanes(contact.change) += lanes_of(change);
  add_at(contact, lanes_of(change), vertices.data());
}

void PointSweeps::begin_directions(std::span<const std::uint32_t> order,
                                   std::span<const Index> of_vertices) {
  of_vertices_.resize(vertices.size());
  of_contacts_.resize(contacts.size());
  for (const std::uint32_t i : order) of_contacts_[i] = {};
  for (const Index v : of_vertices) of_vertices_[v] = {};
}

void PointSweeps::keep(std::span<const std::uint32_t> order, std::span<const Index> of_vertices) {
  for (const std::uint32_t i : order) of_contacts_[i].before = contacts[i].change;
  for (const Index v : of_vertices) of_vertices_[v].before = vertices[v].change;
}

void PointSweeps::go_on(double factor, std::span<const std::uint32_t> order,
                        std::span<const Index> of_vertices) {
  const auto move = [factor](Direction& of, Row& change) {
    const RowLanes more = factor * as_lanes(of.direction);
    as_lanes(of.direction) = more + (as_lanes(change) - as_lanes(of.before));
    as_lanes(change) += more;
  };
  for (const std::uint32_t i : order) move(of_contacts_[i], contacts[i].change);
  for (const Index v : of_vertices) move(of_vertices_[v], vertices[v].change);
}

}  // namespace suture
