// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/dynamics/dynamics.hpp"

namespace suture {

/// The distance of a set of elements from rest, over its vertices and free components, with all
/// forces, loads, gravity and contact.
struct Stillness {
  double residual = 0;      ///< sqrt(sum |f|^2), N
  double acceleration = 0;  ///< largest |f| / m, m/s^2
  double velocity = 0;      ///< largest, m/s
};
/// Changes no bit of later steps. O(elements).
Stillness stillness(Dynamics& dynamics, std::span<const Index> elements);

/// Islands at rest can be put to sleep: their vertices are frozen with velocity zero, and their
/// cells are not computed. They wake at the next operation or at wake_all(); also wake them before
/// a load, gravity or a prescribed motion that acts on them changes (Body::last_change()). Throws
/// InputError unless `elements` are whole islands. O(elements).
///
/// Error: with acceleration a and velocity v from stillness(), while the forces are linear in the
/// displacements and K >= 0, each mode obeys u'' = a_i - w_i^2 u, so that the motion omitted in a
/// sleep of length T is, in the mass-weighted root mean square, at most
///     v T + a T^2 / 2   and   v / w + 2 a / w^2
/// where w is the lowest angular frequency of the constrained island (0 if it is free, so that only
/// the first bound holds).
void put_to_sleep(Dynamics& dynamics, std::span<const Index> elements);
void wake_all(Dynamics& dynamics);
/// Wakes all but these elements, whole islands that sleep. O(elements).
void wake_except(Dynamics& dynamics, std::span<const Index> asleep);
bool sleeps(const Dynamics& dynamics);

}  // namespace suture
