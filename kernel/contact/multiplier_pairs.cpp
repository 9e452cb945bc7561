// SPDX-License-Identifier: GPL-3.0-or-later
// Where lips and pieces touch in implicit steps and equilibria.
#include <algorithm>
#include <sstream>

#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/contact/multiplier_forces.hpp"
#include "kernel/contact/swept_crossing.hpp"

namespace suture {
namespace {

// In typical edges: how deep a point that has passed a triangle must be behind it, and how far
// convex edges must have passed each other, for a contact to be missed.
constexpr double missed_depth = 0.05, missed_depth_of_edges = PieceContact::max_depth;
// Cosine of an angle between the normals of a contact before and after an update.
constexpr double same_direction = 0.95;
// A contact with a force stays until its point has left the place where it was found by more, in
// typical edges.
constexpr double kept_within = 0.01;

Vec3 normal_of(const double* x, Index a, Index b, Index c) {
  const Vec3 at = row(x, a);
  return cross(minus(row(x, b), at), minus(row(x, c), at));
}

/// Two of each face; triangle t is one of face t / 2.
std::vector<std::array<Index, 3>> halves_of(std::span<const BoundarySurface::Corners> faces) {
  std::vector<std::array<Index, 3>> triangles;
  for (const auto& [a, b, c, d] : faces) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  return triangles;
}

}  // namespace

/// The way of the vertex from the face, or of the first edge from the second one.
Vec3 MultiplierForces::offset_of(const Pair& pair) const {
  Vec3 sum{};
  for (std::size_t i = 0; i < pair.vertices.size(); ++i)
    sum = plus(sum, scaled(pair.weights[i], row(attributes_.position().rows(), pair.vertices[i])));
  return sum;
}

/// Along its normal, at the start of the step.
double MultiplierForces::start_gap_of(const Pair& pair) const {
  if (start_.empty()) return 0;
  Vec3 sum{};
  for (std::size_t i = 0; i < pair.vertices.size(); ++i)
    sum = plus(sum, scaled(pair.weights[i], row(start_.data(), pair.vertices[i])));
  return dot(sum, pair.normal);
}

double MultiplierForces::target_of(const Pair& pair, double time) const {
  const double gap = start_.empty() ? dot(pair.normal, offset_of(pair)) : 0;
  return target(gap, pair.start_gap, pair.stiffness, pair.mass, pair.recovery, time);
}

/// Replaces the pairs; those of the same vertex or edge in about the same direction pass their
/// multipliers on. In inner corners, where faces are equally near, rounding decides which of them
/// is found: contacts with a force stay.
MultiplierForces::Change MultiplierForces::take_over(Pairs found, double time) {
  const auto is_before = [](const Pair& a, const Pair& b) { return is_found_before(a.key, b.key); };
  const auto stays = [&](const Pair& pair) {
    const Vec3 way = minus(along_surface(offset_of(pair), pair.normal), pair.beside);
    return norm(way) < kept_within * contact_.mean_edge();
  };
  Change largest;
  std::size_t first = 0;
  for (Pair& pair : found) {
    while (first < pairs_.size() && is_before(pairs_[first], pair)) ++first;
    const Vec3 offset = offset_of(pair);
    pair.start_gap = start_gap_of(pair);
    const double gap = dot(pair.normal, offset) - target_of(pair, time);
    pair.beside = along_surface(offset, pair.normal);
    largest.depth = std::max(largest.depth, -gap);
    for (std::size_t i = first; i < pairs_.size() && !is_before(pair, pairs_[i]); ++i) {
      Pair& before = pairs_[i];
      if (before.pressure == 0 || dot(before.normal, pair.normal) < same_direction) continue;
      if (before.key != pair.key && stays(before)) continue;
      static_cast<Multiplier&>(pair) = std::exchange(static_cast<Multiplier&>(before), {});
      largest.other = std::max({largest.other, gap, norm(minus(offset, offset_of(before)))});
      break;
    }
  }
  for (const Pair& before : pairs_) {
    if (before.pressure == 0) continue;
    if (stays(before))
      found.push_back(before);
    else
      largest.other = std::max(largest.other, before.pressure / (stiffening() * before.stiffness));
  }
  std::ranges::stable_sort(found, is_before);
  pairs_ = std::move(found);
  is_listed_ = false;
  return largest;
}

MultiplierForces::Pair MultiplierForces::pair_of(const std::array<Index, 5>& key,
                                                 const ContactPoint& offset, const Vec3& normal,
                                                 double mass, double recovery) const {
  Pair pair{{},
            key,
            {offset.vertices.begin(), offset.vertices.end()},
            {offset.weights.begin(), offset.weights.end()},
            normal,
            stiffness_of(offset),
            mass};
  pair.recovery = recovery;
  return pair;
}

/// At the current positions. None where constraints hold both sides.
MultiplierForces::Pairs MultiplierForces::find_pairs(double time) {
  Pairs pairs;
  PieceContact* pieces = contact_.pieces();
  const PointPairs* points = contact_.find_point_pairs();
  if (!pieces && !points) return pairs;
  find_stiffness(time);
  if (points) {
    const double *mass = attributes_.mass().rows(), *fixed = attributes_.fixed().rows();
    for (std::size_t i = 0; i < points->size(); ++i)
      if (const ContactPoint offset = (*points)[i]; !offset.is_held(fixed))
        pairs.push_back(pair_of({points->point(i)}, offset, points->normal(i),
                                offset.in_series(mass, fixed), points->scale_of_recovery(i)));
    return pairs;
  }
  pieces->begin(1, 1, attributes_.kernel(0).cells.live());
  for (const PieceContact::Touch& touch : pieces->touches())
    if (touch.mass > 0)
      pairs.push_back(pair_of(touch.vertices, {0, touch.vertices, touch.weights}, touch.normal,
                              touch.mass, contact_.mean_edge()));
  return pairs;
}

/// Of what may touch, where contacts have been found.
void MultiplierForces::note_places() {
  if (!contact_.pieces() && !contact_.has_point_pairs()) return;
  const double* x = contact_.places_now();
  found_at_.assign(x, x + std::size_t{contact_.points().count()} * 4);
}

/// Whether a pair of the point or vertex has about this direction.
bool MultiplierForces::has_pair(Index point, const Vec3& normal) const {
  return std::ranges::any_of(pairs_, [&](const Pair& pair) {
    return pair.key[0] == point && dot(pair.normal, normal) > 0;
  });
}

bool MultiplierForces::has_pair_of_edges(const std::array<Index, 2>& first,
                                         const std::array<Index, 2>& second) const {
  return std::ranges::any_of(pairs_, [&](const Pair& pair) {
    const auto has = [&](Index v) { return std::ranges::find(pair.key, v) != pair.key.end(); };
    return is_between_edges(pair.key) && has(first[0]) && has(first[1]) && has(second[0]) &&
           has(second[1]);
  });
}

/// Nothing may pass another piece between two searches for contacts, the second of which has just
/// been made.
void MultiplierForces::refuse_crossings(double time) {
  if (found_at_.empty()) return;
  const double* x = contact_.places_now();
  const double edge = contact_.mean_edge();
  Box ways = no_box;
  for (const Index p : contact_.points().numbers())
    include(ways, minus(row(x, p), row(found_at_.data(), p)));
  if (diagonal_of(ways) <= missed_depth * edge) return;
  const SweptPlaces places{found_at_.data(), x, edge};
  std::optional<SweptCrossing> passed;
  if (const PointPairs* pairs = contact_.point_pairs()) {
    const auto triangles = pairs->surface().triangles();
    passed = find_passed_triangle(
        places, contact_.points().numbers(), triangles, missed_depth * edge, [&](Index p, Index t) {
          const auto& [a, b, c] = triangles[t];
          return pairs->may_touch(p, t) && !has_pair(p, normal_of(x, a, b, c));
        });
  } else {
    const PieceContact& pieces = *contact_.pieces();
    const auto triangles = halves_of(contact_.surface().corners());
    passed = find_passed_triangle(
        places, contact_.points().numbers(), triangles, missed_depth * edge, [&](Index v, Index t) {
          const auto& [a, b, c] = triangles[t];
          return pieces.may_touch(NearPair{v, t / 2}) && !has_pair(v, normal_of(x, a, b, c));
        });
    if (!passed) {
      std::vector<std::array<Index, 2>> edges;
      for (const FeatureEdge& of : pieces.feature_edges()) edges.push_back(of.ends);
      passed = find_passed_edges(places, edges, missed_depth_of_edges * edge,
                                 [&](Index first, Index second) {
                                   return pieces.may_touch(NearEdges{first, second}) &&
                                          !has_pair_of_edges(edges[first], edges[second]);
                                 });
    }
  }
  if (!passed) return;
  std::ostringstream text;
  text << "pieces or lips pass through each other at " << time_text(time)
       << ": in one step, a place of the surface comes to be " << passed->depth
       << " m behind another one, " << passed->depth / edge
       << " of a typical edge, where contact is not found";
  throw NumericalError(text.str());
}

}  // namespace suture
