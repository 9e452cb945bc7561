// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/overlap.hpp"

#include <numbers>

namespace suture {
namespace {

// A part of the size of the body: coordinates of files may be in single precision.
constexpr double tolerance = 1e-6;

/// The solid angle of a triangle seen from the origin, positive from behind (Van Oosterom and
/// Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125).
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return 2 * std::atan2(dot(a, cross(b, c)),
                        la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// visit(place) for all that could be inside: nodes, or the points of an embedded surface.
template <class Visit>
void for_each_place(const Contact& contact, const CellComplex& complex, const double* positions,
                    Visit visit) {
  if (contact.points().are_embedded())
    return contact.points().for_each(
        [&](const ContactPoint& point) { visit(point.sum(positions)); });
  for (Index v = 0; v < complex.count(0); ++v)
    if (complex.exists(0, v)) visit(row(positions, v));
}

Overlap deepest(const PlacedObstacle& obstacle, const Contact& contact, const CellComplex& complex,
                const double* positions, double margin) {
  Overlap overlap{};
  for_each_place(contact, complex, positions, [&](const Vec3& place) {
    if (!obstacle.may_touch(place, 0)) return;
    const double depth = -obstacle.gap(place).distance;
    if (depth <= margin) return;
    ++overlap.vertices;
    if (depth > overlap.depth) {
      overlap.depth = depth;
      overlap.place = place;
    }
  });
  return overlap;
}

}  // namespace

bool is_inside(std::span<const BoundarySurface::Corners> surface, const double* positions,
               const Vec3& place) {
  double angle = 0;
  for (const BoundarySurface::Corners& corners : surface) {
    Vec3 p[4];
    for (std::size_t i = 0; i < 4; ++i) p[i] = minus(row(positions, corners[i]), place);
    angle += solid_angle(p[0], p[1], p[2]) + solid_angle(p[0], p[2], p[3]);
  }
  return angle > 2 * std::numbers::pi;
}

std::vector<Overlap> find_overlaps(const Contact& contact, const CellComplex& complex,
                                   Attributes& attributes, double time) {
  std::vector<Overlap> overlaps;
  const double* positions = attributes.position().rows();
  for (std::size_t i = 0; i < contact.obstacles().size(); ++i) {
    const Obstacle& obstacle = contact.obstacles()[i];
    const PlacedObstacle placed(obstacle, contact.thickness(), time, time);
    Overlap overlap = deepest(placed, contact, complex, positions, tolerance * contact.size());
    overlap.obstacle = i;
    if (overlap.vertices > 0) {
      overlaps.push_back(overlap);
      continue;
    }
    for (const Vec3& given : points_inside(obstacle.shape)) {
      overlap.place = obstacle.motion.pose(time).place(given);
      if (!is_inside(contact.surface().corners(), positions, overlap.place)) continue;
      overlaps.push_back(overlap);
      break;
    }
  }
  return overlaps;
}

}  // namespace suture
