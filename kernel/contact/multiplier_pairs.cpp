// SPDX-License-Identifier: GPL-3.0-or-later
// Where lips and pieces touch in implicit steps and equilibria.
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/contact/missed_approach.hpp"
#include "kernel/contact/multiplier_forces.hpp"

namespace suture {

MultiplierForces::Pair MultiplierForces::pair_of(const std::array<Index, 5>& key,
                                                 const ContactPoint& offset, const Vec3& normal,
                                                 double mass) const {
  return {{},
          key,
          {offset.vertices.begin(), offset.vertices.end()},
          {offset.weights.begin(), offset.weights.end()},
          normal,
          stiffness_of(offset),
          mass};
}

/// At the current positions. None where constraints hold both sides.
MultiplierForces::Pairs MultiplierForces::find_pairs(double time) {
  Pairs pairs;
  PieceContact* pieces = contact_.pieces();
  const PointPairs* points = contact_.find_point_pairs();
  if (!pieces && !points) return pairs;
  find_stiffness(time);
  const double* x = contact_.places_now();
  found_at_.assign(x, x + std::size_t{contact_.points().count()} * 4);
  if (points) {
    const double *mass = attributes_.mass().rows(), *fixed = attributes_.fixed().rows();
    for (std::size_t i = 0; i < points->size(); ++i)
      if (const ContactPoint offset = (*points)[i]; !offset.is_held(fixed))
        pairs.push_back(
            pair_of({points->point(i)}, offset, points->normal(i), offset.in_series(mass, fixed)));
    return pairs;
  }
  pieces->begin(1, 1, attributes_.kernel(0).cells.live());
  for (const PieceContact::Touch& touch : pieces->touches())
    if (touch.mass > 0)
      pairs.push_back(
          pair_of(touch.vertices, {0, touch.vertices, touch.weights}, touch.normal, touch.mass));
  return pairs;
}

/// Nothing may pass another piece between two searches for contacts.
void MultiplierForces::refuse_long_ways(double time) const {
  if (found_at_.empty()) return;
  const auto missed =
      find_missed_approach(contact_.points().numbers(), found_at_.data(), contact_.places_now(),
                           contact_.mean_edge(), PieceContact::max_depth * contact_.mean_edge());
  if (!missed) return;
  std::ostringstream text;
  text << "pieces or lips may have passed through each other at " << time_text(time)
       << ": in one step, places of the surface within " << missed->distance
       << " m of each other move by up to " << missed->way
       << " m relative to each other, and contact is found up to " << missed->allowed << " m";
  throw NumericalError(text.str());
}

}  // namespace suture
