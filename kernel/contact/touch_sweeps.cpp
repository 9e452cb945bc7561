// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/touch_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/contact/row_lanes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

/// What a sweep reads and writes besides contacts.
struct SweepState {
  double* velocities;
  double* ways;
  const std::uint64_t* groups;
  std::uint64_t* due;
  double friction, dt, negligible;
};

// N s; so that nothing is divided by zero.
constexpr double least_impulse = std::numeric_limits<double>::min();

/// By the components that are fixed: 0 for these.
alignas(32) constexpr double free_components[8][4] = {{1, 1, 1, 1}, {0, 1, 1, 1}, {1, 0, 1, 1},
                                                      {0, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 1},
                                                      {1, 0, 0, 1}, {0, 0, 0, 1}};

SUTURE_INLINE void kick(const PieceTouch& touch, const RowLanes& impulse, double* velocities) {
  for (std::size_t i = 0; i < 5; ++i) {
    RowLanes& velocity = row_at(velocities, touch.vertices[i]);
    const auto fixed = static_cast<std::size_t>(touch.fixed[i]);
    velocity += touch.response[i] * impulse * row_at(free_components[0], fixed);
  }
}

/// The length of a group of contacts; there are as many groups as bits.
SUTURE_INLINE std::size_t group_length(std::size_t contacts) { return contacts / 64 + 1; }

/// How far the gap may have changed since the step began, m.
SUTURE_INLINE double way_of(const PieceTouch& touch, const double* ways) {
  double way = 0;
  for (std::size_t i = 0; i < 5; ++i) way += std::abs(touch.weights[i]) * ways[touch.places[i]];
  return way;
}

/// The normal impulse that takes the gap to its target, never a pull, and that of friction, at most
/// its coefficient times the normal one. Returns the change of the gap by the first, m.
SUTURE_INLINE double improve(const SweepState& s, PieceTouch& touch) {
  const RowLanes normal = lanes_of(touch.normal);
  RowLanes relative{};
  for (std::size_t i = 0; i < 5; ++i)
    relative += touch.weights[i] * row_at(s.velocities, touch.vertices[i]);
  const double along = dot(relative, normal);
  const double impulse = std::max(0.0, touch.impulse + touch.mass * (touch.speed - along));
  if (impulse == 0 && touch.impulse == 0) return 0;
  const double change = impulse - touch.impulse;
  RowLanes total = change * normal;
  touch.impulse = impulse;
  if (s.friction > 0) {
    const RowLanes before = lanes_of(touch.friction);
    RowLanes friction = before - touch.mass * (relative - along * normal);
    const double size = std::sqrt(dot(friction, friction)), most = s.friction * impulse;
    friction *= most / std::max({size, most, least_impulse});
    total += friction - before;
    touch.friction = {friction[0], friction[1], friction[2]};
  }
  kick(touch, total, s.velocities);
  const double way = std::sqrt(dot(total, total)) * s.dt;
  for (std::size_t i = 0; i < 5; ++i) {
    s.ways[touch.places[i]] += std::abs(touch.response[i]) * way;
    *s.due |= s.groups[touch.places[i]];
  }
  return std::abs(change) * s.dt / touch.mass;
}

SUTURE_CLONES
double sweep_over(const SweepState& state, std::span<PieceTouch> touches) {
  const SweepState s = state;
  const std::size_t length = group_length(touches.size());
  double largest = 0;
  for (std::size_t first = 0; first < touches.size(); first += length) {
    const std::uint64_t group = std::uint64_t{1} << first / length;
    if (!(*s.due & group)) continue;
    *s.due &= ~group;
    for (PieceTouch& touch : touches.subspan(first, std::min(length, touches.size() - first))) {
      if (way_of(touch, s.ways) - touch.seen <= s.negligible) continue;
      largest = std::max(largest, improve(s, touch));
      touch.seen = way_of(touch, s.ways);
    }
  }
  return largest;
}

}  // namespace

void TouchSweeps::begin(std::span<PieceTouch> touches) {
  vertices_.clear();
  groups_.clear();
  due_ = ~std::uint64_t{0};
  const std::size_t length = group_length(touches.size());
  for (std::size_t k = 0; k < touches.size(); ++k) {
    const std::uint64_t group = std::uint64_t{1} << k / length;
    for (std::size_t i = 0; i < 5; ++i) {
      const Index v = touches[k].vertices[i];
      if (!vertices_.contains(v)) {
        vertices_.insert(v);
        groups_.push_back(0);
      }
      touches[k].places[i] = vertices_.place(v);
      groups_[touches[k].places[i]] |= group;
    }
  }
  ways_.assign(groups_.size(), 0);
}

double TouchSweeps::sweep(std::span<PieceTouch> touches, double* velocities, double friction,
                          double dt, double negligible) {
  return sweep_over({velocities, ways_.data(), groups_.data(), &due_, friction, dt, negligible},
                    touches);
}

void TouchSweeps::apply(const PieceTouch& touch, const Vec3& impulse, double* velocities) const {
  kick(touch, lanes_of(impulse), velocities);
}

}  // namespace suture
