// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blades of a scene: planes, surfaces, moving blades, lists of faces.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/integrator.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

// Twice the vector area of a polygon (Newell): its normal, by the size of a right hand.
// From its first point: far from the origin the products would be large and their sum not.
Vec3 newell(const std::vector<Vec3>& polygon) {
  Vec3 sum{};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = minus(polygon[i], polygon[0]),
               b = minus(polygon[(i + 1) % polygon.size()], polygon[0]);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
      sum[c] += (a[d] - b[d]) * (a[e] + b[e]);
    }
  }
  return sum;
}

// The largest triangle from the first point to a side: unlike Newell's sum it does not
// vanish where parts of the polygon are run around in opposite ways.
Vec3 largest_fan(const std::vector<Vec3>& polygon) {
  Vec3 largest{};
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vec3 n = cross(minus(polygon[i], polygon[0]), minus(polygon[i + 1], polygon[0]));
    if (dot(n, n) > dot(largest, largest)) largest = n;
  }
  return largest;
}

// Whether c and d lie on opposite sides of the line through a and b, in the plane across n,
// both further off it than `slack`, twice an area times |n|.
bool parts(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& n,
           double slack) {
  const Vec3 across = cross(n, minus(b, a));
  const double at_c = dot(across, minus(c, a)), at_d = dot(across, minus(d, a));
  return std::min(at_c, at_d) < -slack && std::max(at_c, at_d) > slack;
}

//   a ._   _. d
//       `x'         Sides that touch do not cross: a polygon may have a hole, and a bridge
//   c .-' `-. b     to it that is run along twice.
bool sides_cross(const std::vector<Vec3>& polygon) {
  const Vec3 n = largest_fan(polygon);
  const double slack = 1e-9 * dot(n, n);
  const std::size_t size = polygon.size();
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = i + 2; j < size; ++j) {
      const Vec3 &a = polygon[i], &b = polygon[i + 1], &c = polygon[j],
                 &d = polygon[(j + 1) % size];
      if (parts(a, b, c, d, n, slack) && parts(c, d, a, b, n, slack)) return true;
    }
  return false;
}

// The plane of a polygon; its points must lie within a millionth of its size of it.
void read_polygon(ObjectReader& plane, CutPlane& cut) {
  const std::string path = plane.path_of("polygon");
  cut.polygon = read_points(*plane.find("polygon"), path, 3, plane.mistakes());
  if (cut.polygon.size() < 3) return;
  cut.point = cut.polygon[0];
  cut.normal = newell(cut.polygon);
  const double area = std::sqrt(dot(cut.normal, cut.normal));
  double size = 0, off = 0;
  for (const Vec3& p : cut.polygon) {
    const Vec3 r{p[0] - cut.point[0], p[1] - cut.point[1], p[2] - cut.point[2]};
    size = std::max(size, std::sqrt(dot(r, r)));
    off = std::max(off, std::abs(dot(r, cut.normal)) / area);
  }
  const bool has_area = area > 1e-12 * size * size;
  if (has_area && off > 1e-6 * size) {
    std::ostringstream distance;
    distance << off;
    plane.complain("polygon",
                   "is not planar: a point lies " + distance.str() +
                       " m off the plane of the others; use a {\"surface\"} of triangles instead");
  } else if (sides_cross(cut.polygon)) {
    plane.complain("polygon",
                   "is not a simple polygon: its sides cross; give the points in order around it");
  } else if (!has_area) {
    plane.complain("polygon",
                   "has no area: its points lie on a line; give at least three that do not");
  }
  if (!has_area) cut.normal = {1, 0, 0};
}

CutPlane read_cut_plane(ObjectReader plane) {
  CutPlane cut;
  if (plane.find("polygon") != nullptr) {
    for (const char* key : {"point", "normal", "radius"}) {
      if (plane.find(key) != nullptr)
        plane.complain(key, "is already determined by 'polygon'; remove one of them");
    }
    read_polygon(plane, cut);
  } else {
    cut.point = require_vector(plane, "point", "m", "a point of the plane [x, y, z] in m");
    plane.require("normal", "the direction normal to the cut [x, y, z]");
    cut.normal = read_direction(plane, "normal").value_or(Vec3{1, 0, 0});
    cut.radius = plane.number("radius", Limits::positive("m")).value_or(cut.radius);
  }
  plane.finish();
  return cut;
}

CutSurface read_surface(ObjectReader surface, Reading& reading) {
  const SurfaceFile from = read_surface_file(surface, reading);
  surface.finish();
  return {from.file, from.scale, from.translation};
}

CutBlade::Station read_station(ObjectReader& object, const Scene& scene) {
  CutBlade::Station station{};
  object.require("at", "the time of the station, in s");
  station.at = object.number("at", Limits::not_negative("s")).value_or(0);
  if (scene.solver.end && station.at > *scene.solver.end)
    object.complain("at", "is after the end of the run (/solver/end)");
  if (const JsonValue* points = object.require("points", "a segment or polyline [[x, y, z], ...]"))
    station.points = read_points(*points, object.path_of("points"), 2, object.mistakes());
  return station;
}

/// What resists is found by impulses, on nodes that move in explicit steps.
void refuse_resistance(ObjectReader& blade, const CutBlade& cut, const Scene& scene) {
  const auto refuse = [&](const std::string& why) { blade.complain("resistance", why); };
  const SolverOptions& solver = scene.solver;
  if (!cut.carried)
    return refuse(
        "is a force on a tool: let an obstacle carry the blade ({\"obstacle\": ...} instead of "
        "\"path\"), so that it appears in tools.csv");
  if (is_implicit(solver.integrator))
    refuse("needs explicit steps; use \"symplectic-euler\" or \"velocity-verlet\" instead of '" +
           solver.integrator + "'");
  if (scene.contact.penalty)
    refuse("acts by impulses, which \"law\": \"penalty\" in /contact excludes; remove one of them");
  if (solver.sleep_acceleration > 0)
    refuse("does not wake what sleeps; remove \"sleep\" in /solver");
}

void read_resistance(ObjectReader& blade, CutBlade& cut, const Scene& scene) {
  const JsonValue* value = blade.find("resistance");
  if (value == nullptr) return;
  ObjectReader object(*value, blade.path_of("resistance"), blade.mistakes());
  CutBlade::Resistance resistance;
  resistance.toughness =
      read_element_values(object, "toughness", Limits::positive("J/m^2"),
                          "the energy per area of the cut, in J/m^2: a number or a table");
  const auto stress = object.number("stress", Limits::positive("Pa"));
  const auto thickness = object.number("thickness", Limits::positive("m"));
  if (stress.has_value() != thickness.has_value())
    object.complain(stress ? "stress" : "thickness",
                    std::string("needs \"") + (stress ? "thickness" : "stress") +
                        "\" beside it: a cut begins where stress times the thickness of the edge "
                        "is reached");
  resistance.stress = stress.value_or(0);
  resistance.thickness = thickness.value_or(0);
  object.finish();
  cut.resistance = std::move(resistance);
  refuse_resistance(blade, cut, scene);
}

/// A blade that an obstacle carries.
CutBlade::Carried read_carried(ObjectReader& blade, const std::vector<Obstacle>& obstacles) {
  CutBlade::Carried carried;
  std::vector<std::string> names;
  for (const Obstacle& obstacle : obstacles) names.push_back(obstacle.name);
  if (names.empty())
    blade.complain("obstacle", "needs obstacles, and the scene has none; add /contact/obstacles");
  else if (const auto obstacle = blade.choice("obstacle", names))
    carried = {*obstacle, names[*obstacle]};
  if (const JsonValue* points = blade.require("points", "a segment or polyline [[x, y, z], ...]"))
    carried.points = read_points(*points, blade.path_of("points"), 2, blade.mistakes());
  return carried;
}

CutBlade read_blade(ObjectReader blade, Reading& reading) {
  CutBlade cut;
  static const std::array<std::string, 2> kinds{"path", "obstacle"};
  const auto kind = blade.one_of(kinds);
  if (kind == 1u) cut.carried = read_carried(blade, reading.scene.contact.obstacles);
  if (kind) {
    read_resistance(blade, cut, reading.scene);
    if (cut.carried) blade.finish();
  }
  if (!kind || cut.carried) {
    cut.stations.resize(1);
    return cut;
  }
  for_each_object(blade, "path", "stations", [&](ObjectReader& object) {
    CutBlade::Station station = read_station(object, reading.scene);
    if (!cut.stations.empty()) {
      const CutBlade::Station& last = cut.stations.back();
      if (station.at <= last.at) object.complain("at", "must be later than the previous station");
      if (station.points.size() != last.points.size())
        object.complain("points", "must have the same number of points as the previous station, " +
                                      std::to_string(last.points.size()) + "; has " +
                                      std::to_string(station.points.size()));
    }
    cut.stations.push_back(std::move(station));
  });
  if (cut.stations.empty()) {
    if (blade.find("path") != nullptr)
      blade.complain("path", "is empty; give at least one station");
    cut.stations.resize(1);
  }
  blade.finish();
  return cut;
}

}  // namespace

SurfaceFile read_surface_file(ObjectReader& surface, Reading& reading) {
  SurfaceFile from;
  if (const JsonValue* file =
          surface.require("file", "a file of triangles (.obj, .off, .stl, .ply or .vtp)"))
    from.file = read_file(*file, surface.path_of("file"), reading);
  from.scale = surface.number("scale", Limits::positive("1")).value_or(1);
  from.translation = surface.vector("translation", Limits::any("m")).value_or(Vec3{});
  return from;
}

std::vector<std::array<std::uint64_t, 2>> read_pairs(const JsonValue& value,
                                                     const std::string& path, Mistakes& mistakes) {
  std::vector<std::array<std::uint64_t, 2>> pairs;
  const auto* items = read_array(value, path, "pairs of element numbers", mistakes);
  if (items == nullptr) return pairs;
  if (items->empty()) mistakes.add(value.at, path, "is empty; name at least one face");
  for (std::size_t i = 0; i < items->size(); ++i) {
    const JsonValue& item = (*items)[i];
    const std::string here = child_path(path, i);
    if (item.kind != JsonValue::Kind::array || item.items.size() != 2) {
      mistakes.add(
          item.at, here,
          "must be the numbers of the two elements of a face [a, b], is " + describe(item));
      continue;
    }
    const auto a = read_natural(item.items[0], child_path(here, 0), 0, UINT64_MAX, mistakes);
    const auto b = read_natural(item.items[1], child_path(here, 1), 0, UINT64_MAX, mistakes);
    if (!a || !b) continue;
    if (*a == *b)
      mistakes.add(item.at, here,
                   "names element " + std::to_string(*a) +
                       " twice; a face lies between two different elements");
    else
      pairs.push_back({*a, *b});
  }
  return pairs;
}

/// "along": what the cut follows; `by_default`: the blade, where it can.
void read_along(ObjectReader& cut, bool by_default, EventOperation& result) {
  static const std::array<std::string, 2> ways{"faces", "blade"};
  const bool is_given = cut.find("along") != nullptr;
  if (!is_given && !by_default) return;
  if (is_given && cut.choice("along", ways) != 1u) return;
  auto* blade = std::get_if<CutBlade>(&result);
  if (auto* plane = std::get_if<CutPlane>(&result))
    plane->along_blade = true;
  else if (auto* surface = std::get_if<CutSurface>(&result))
    surface->along_blade = true;
  else if (blade)
    blade->along_blade = true;
  else if (is_given)
    cut.complain("along", "\"blade\" needs a blade, and faces are listed; remove it");
}

EventOperation read_cut(ObjectReader cut, Reading& reading) {
  static const std::array<std::string, 4> kinds{"plane", "surface", "blade", "faces"};
  const auto kind = cut.one_of(kinds);
  EventOperation result;
  if (kind) {
    const JsonValue& inner = *cut.find(kinds[*kind]);
    const std::string path = cut.path_of(kinds[*kind]);
    if (*kind == 0) result = read_cut_plane({inner, path, cut.mistakes()});
    if (*kind == 1) result = read_surface({inner, path, cut.mistakes()}, reading);
    if (*kind == 2) result = read_blade({inner, path, cut.mistakes()}, reading);
    if (*kind == 3) result = CutFaces{read_pairs(inner, path, cut.mistakes())};
    read_along(cut, reading.scene.cuts_follow_blade, result);
  }
  cut.finish();
  return result;
}

}  // namespace suture::scene_parts
