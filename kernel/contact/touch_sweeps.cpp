// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/touch_sweeps.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/contact/row_lanes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

/// What a sweep reads and writes besides contacts.
struct SweepState {
  double* velocities;
  double* unseen;
  std::uint16_t* moved_in;
  double friction, dt, negligible;
  std::uint16_t sweep;
};

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

SUTURE_INLINE void note(const SweepState& s, Index vertex, double way) {
  const double unseen = s.unseen[vertex] + way;
  const bool has_moved = unseen > s.negligible;
  s.unseen[vertex] = has_moved ? 0 : unseen;
  s.moved_in[vertex] = has_moved ? s.sweep : s.moved_in[vertex];
}

/// A vertex has moved since the touch was improved: in the last sweep or in this one.
SUTURE_INLINE bool is_disturbed(const SweepState& s, const PieceTouch& touch) {
  int last = 0;
  for (const Index v : touch.vertices) last = std::max<int>(last, s.moved_in[v]);
  return last + 1 >= s.sweep;
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
    if (size > most) friction = most / size * friction;
    total += friction - before;
    touch.friction = {friction[0], friction[1], friction[2]};
  }
  kick(touch, total, s.velocities);
  const double way = std::sqrt(dot(total, total)) * s.dt;
  for (std::size_t i = 0; i < 5; ++i) note(s, touch.vertices[i], std::abs(touch.response[i]) * way);
  return std::abs(change) * s.dt / touch.mass;
}

SUTURE_CLONES
double sweep_over(const SweepState& state, PieceTouch* first, PieceTouch* last) {
  const SweepState s = state;
  double largest = 0;
  for (PieceTouch* touch = first; touch != last; ++touch)
    if (is_disturbed(s, *touch)) largest = std::max(largest, improve(s, *touch));
  return largest;
}

}  // namespace

void TouchSweeps::begin(std::span<const Index> vertices, std::size_t count) {
  sweep_ = 0;
  unseen_.resize(count);
  moved_in_.resize(count);
  for (const Index v : vertices) {
    unseen_[v] = 0;
    moved_in_[v] = 0;
  }
}

double TouchSweeps::sweep(std::span<PieceTouch> touches, double* velocities, double friction,
                          double dt, double negligible) {
  negligible_ = negligible;
  ++sweep_;
  const SweepState state{velocities,  unseen_.data(), moved_in_.data(), friction, dt,
                         negligible_, sweep_};
  return sweep_over(state, touches.data(), touches.data() + touches.size());
}

void TouchSweeps::apply(const PieceTouch& touch, const Vec3& impulse, double* velocities) const {
  kick(touch, lanes_of(impulse), velocities);
}

void TouchSweeps::disturb(Index vertex, double way) {
  note({nullptr, unseen_.data(), moved_in_.data(), 0, 0, negligible_, sweep_}, vertex, way);
}

}  // namespace suture
