// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/dynamics/dynamics.hpp"

namespace suture {

/// How far a set of elements is from rest, over its vertices and free components,
/// with all forces, loads and gravity.
struct Stillness {
  double residual = 0;      ///< sqrt(sum |f|^2), N
  double acceleration = 0;  ///< largest |f| / m, m/s^2
  double velocity = 0;      ///< largest, m/s
};
/// Synchronises. O(elements).
Stillness stillness(Dynamics& dynamics, std::span<const Index> elements);

/// Islands that are still may sleep: their vertices are frozen with velocity zero,
/// their cells are not computed. They wake at the next operation or wake_all(); wake
/// them too before a load, gravity or a motion of theirs changes (Body::settled_after()).
/// `elements`: whole islands, or InputError. O(elements).
///
/// What is lost: with acceleration a and velocity v from stillness(), while the forces
/// are linear in the displacements and K >= 0, each mode obeys u'' = a_i - w_i^2 u, so
/// that the motion omitted in a sleep of length T is, in the root mean square weighed
/// by mass, at most
///     v T + a T^2 / 2   and   v / w + 2 a / w^2
/// w being the lowest angular frequency of the island as it is held (0 if it is free,
/// so that only the first bound holds).
void put_to_sleep(Dynamics& dynamics, std::span<const Index> elements);
void wake_all(Dynamics& dynamics);
bool sleeps(const Dynamics& dynamics);

}  // namespace suture
