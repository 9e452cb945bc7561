// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/contact/robust/separation.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>

#include "kernel/base/box.hpp"
#include "kernel/base/vec3.hpp"

namespace suture::test {
namespace {

// How far a node is moved out of its own surface, which has no thickness; of an element.
constexpr double outward = 0.05;

struct Face {
  std::array<Index, 4> corners;  ///< counterclockwise from outside
  std::array<Vec3, 4> places;
  Vec3 area{};
};

struct Solid {
  std::vector<Face> faces;
  std::set<Index> vertices;
  Box box = no_box;
};

Vec3 place_of(Attributes& attributes, Index v) {
  const Column& x = attributes.position();
  return {x.get(v, 0), x.get(v, 1), x.get(v, 2)};
}

std::vector<Solid> bodies_of(const CellComplex& complex, Attributes& attributes) {
  const std::vector<Index> islands = complex.islands();
  std::vector<Solid> bodies;
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4) {
    if (!complex.exists(3, d / 24) || complex.beta3(d) != none) continue;
    bodies.resize(std::max<std::size_t>(bodies.size(), islands[d / 24] + 1));
    Solid& body = bodies[islands[d / 24]];
    Face face{};
    for (Index k = 0; k < 4; ++k) {
      face.corners[k] = complex.origin(d + 3 - k);
      face.places[k] = place_of(attributes, face.corners[k]);
      body.vertices.insert(face.corners[k]);
      include(body.box, face.places[k]);
    }
    const auto& p = face.places;
    face.area = scaled(0.5, cross(minus(p[2], p[0]), minus(p[3], p[1])));
    body.faces.push_back(face);
  }
  return bodies;
}

/// visit(a, b, c) for four triangles around the middle of a face.
template <class Visit>
void for_each_triangle(const Face& face, Visit visit) {
  const auto& p = face.places;
  const Vec3 middle = scaled(0.25, plus(plus(p[0], p[1]), plus(p[2], p[3])));
  for (std::size_t i = 0; i < 4; ++i) visit(p[i], p[(i + 1) % 4], middle);
}

/// How often a closed surface winds around a place: 1 inside, 0 outside.
double winding(const Solid& body, const Vec3& place) {
  double angle = 0;
  for (const Face& face : body.faces)
    for_each_triangle(face, [&](Vec3 a, Vec3 b, Vec3 c) {
      a = minus(a, place);
      b = minus(b, place);
      c = minus(c, place);
      const double la = norm(a), lb = norm(b), lc = norm(c);
      angle += std::atan2(dot(a, cross(b, c)),
                          la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    });
  return angle / (2 * std::numbers::pi);
}

double distance_to_segment(const Vec3& place, const Vec3& a, const Vec3& b) {
  const Vec3 along = minus(b, a);
  const double length = dot(along, along);
  const double t = length > 0 ? std::clamp(dot(minus(place, a), along) / length, 0.0, 1.0) : 0;
  return norm(minus(place, plus(a, scaled(t, along))));
}

double distance_to_triangle(const Vec3& place, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = cross(minus(b, a), minus(c, a));
  const double size = norm(normal);
  const auto is_left = [&](const Vec3& from, const Vec3& to) {
    return dot(normal, cross(minus(to, from), minus(place, from))) >= 0;
  };
  if (size > 0 && is_left(a, b) && is_left(b, c) && is_left(c, a))
    return std::abs(dot(normal, minus(place, a))) / size;
  return std::min({distance_to_segment(place, a, b), distance_to_segment(place, b, c),
                   distance_to_segment(place, c, a)});
}

/// From the faces of which a vertex is no corner.
double distance(const Solid& body, const Vec3& place, Index vertex = none) {
  double least = std::numeric_limits<double>::infinity();
  for (const Face& face : body.faces) {
    if (std::ranges::find(face.corners, vertex) != face.corners.end()) continue;
    for_each_triangle(face, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      least = std::min(least, distance_to_triangle(place, a, b, c));
    });
  }
  return least;
}

bool is_in(const Box& box, const Vec3& place) {
  for (std::size_t c = 0; c < 3; ++c)
    if (place[c] < box.low[c] || place[c] > box.high[c]) return false;
  return true;
}

void note(Intrusion& deepest, const Intrusion& found) {
  if (found.depth > deepest.depth) deepest = found;
}

void check(const Vec3& place, bool is_on_edge, const Solid& other, Intrusion& deepest) {
  if (!is_in(other.box, place) || winding(other, place) < 0.5) return;
  note(deepest, {distance(other, place), place, is_on_edge, "a piece"});
}

/// Edges at their middles; each is an edge of two faces.
void check_pieces(const Solid& body, const Solid& other, Attributes& attributes,
                  Intrusion& deepest) {
  for (const Index v : body.vertices) check(place_of(attributes, v), false, other, deepest);
  for (const Face& face : body.faces)
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t next = (i + 1) % 4;
      if (face.corners[i] > face.corners[next]) continue;
      check(scaled(0.5, plus(face.places[i], face.places[next])), true, other, deepest);
    }
}

/// At the end of a cut, and where faces that share a node are folded onto each other: no direction
/// leads out.
bool is_folded(const std::vector<Vec3>& normals) {
  for (const Vec3& a : normals)
    for (const Vec3& b : normals)
      if (dot(a, b) < -0.3) return true;
  return false;
}

/// A node just outside its own surface is in no other part of the piece.
void check_own(const Solid& body, Attributes& attributes, double edge, Intrusion& deepest) {
  for (const Index v : body.vertices) {
    Vec3 area{};
    std::vector<Vec3> normals;
    for (const Face& face : body.faces) {
      if (std::ranges::find(face.corners, v) == face.corners.end()) continue;
      area = plus(area, face.area);
      normals.push_back(scaled(1 / norm(face.area), face.area));
    }
    if (is_folded(normals)) continue;
    const Vec3 out = scaled(outward * edge / norm(area), area);
    const Vec3 place = plus(place_of(attributes, v), out);
    if (winding(body, place) < 0.5) continue;
    note(deepest, {distance(body, place, v) - outward * edge, place, false, "its own piece"});
  }
}

double depth_in(const Obstacle& obstacle, double time, const Vec3& place) {
  const Vec3 given = obstacle.motion.pose(time).given(place);
  if (const auto* plane = std::get_if<HalfSpace>(&obstacle.shape))
    return dot(plane->normal, minus(plane->point, given));
  if (const auto* ball = std::get_if<Sphere>(&obstacle.shape))
    return ball->radius - norm(minus(given, ball->centre));
  throw std::logic_error("no such obstacle here");
}

}  // namespace

Intrusion deepest_intrusion(const CellComplex& complex, Attributes& attributes,
                            const std::vector<Obstacle>& obstacles, double time, double edge) {
  const std::vector<Solid> bodies = bodies_of(complex, attributes);
  Intrusion deepest;
  for (const Solid& body : bodies) {
    for (const Solid& other : bodies)
      if (&body != &other) check_pieces(body, other, attributes, deepest);
    check_own(body, attributes, edge, deepest);
    for (const Index v : body.vertices)
      for (const Obstacle& obstacle : obstacles)
        note(deepest, {depth_in(obstacle, time, place_of(attributes, v)), place_of(attributes, v),
                       false, "an obstacle"});
  }
  return deepest;
}

}  // namespace suture::test
