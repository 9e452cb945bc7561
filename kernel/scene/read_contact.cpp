// SPDX-License-Identifier: GPL-3.0-or-later
//
// Obstacles and how bodies touch them.
#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/base/safe_range.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/integrator.hpp"
#include "kernel/geometry/solid_surface.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/mesh/file_text.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

const std::array<std::string, 6> shapes{"half_space", "sphere",   "capsule",
                                        "box",        "cylinder", "surface"};

const std::array<std::string, 2> laws{"impulses", "penalty"};

double read_radius(ObjectReader& object) {
  object.require("radius", "in m");
  return object.number("radius", Limits::positive("m")).value_or(1);
}

HalfSpace read_half_space(ObjectReader& object) {
  HalfSpace half;
  half.point = require_vector(object, "point", "m", "a point of the plane [x, y, z] in m");
  object.require("normal", "the direction out of the obstacle [x, y, z]");
  half.normal = read_direction(object, "normal").value_or(half.normal);
  const double length = std::sqrt(dot(half.normal, half.normal));
  for (double& component : half.normal) component /= length;
  return half;
}

Sphere read_sphere(ObjectReader& object) {
  Sphere sphere;
  sphere.centre = require_vector(object, "centre", "m", "[x, y, z] in m");
  sphere.radius = read_radius(object);
  return sphere;
}

template <class WithAxis>
WithAxis read_with_axis(ObjectReader& object) {
  WithAxis shape;
  shape.from = require_vector(object, "from", "m", "one end of the axis [x, y, z] in m");
  shape.to = require_vector(object, "to", "m", "the other end of the axis [x, y, z] in m");
  shape.radius = read_radius(object);
  if (object.find("from") && object.find("to") && !is_safe_direction(minus(shape.to, shape.from)))
    object.complain("to", "is the same point as 'from', so the axis has no direction" +
                              std::string(std::is_same_v<WithAxis, Capsule>
                                              ? "; use a {\"sphere\"}, or move one end"
                                              : "; move one end"));
  return shape;
}

/// A sphere stands for a surface that cannot be used.
Shape read_surface_shape(ObjectReader& object, Reading& reading) {
  const SurfaceFile from = read_surface_file(object, reading);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(from.file, ignored)) return Sphere{{}, 1};
  try {
    std::shared_ptr<const SolidSurface> surface =
        read_solid(from.file, from.scale, [&](std::size_t faces) {
          reading.diagnostics.note(object.path() + ": preparing " + grouped(faces) +
                                   " faces, which takes a while");
        });
    const Vec3 middle = plus(surface->middle(), from.translation);
    return Triangulated{std::move(surface), middle};
  } catch (const InputError& error) {
    object.complain("file", error.what());
  }
  return Sphere{{}, 1};
}

Shape read_shape(ObjectReader object, std::size_t kind, Reading& reading) {
  Shape shape;
  if (kind == 0) shape = read_half_space(object);
  if (kind == 1) shape = read_sphere(object);
  if (kind == 2) shape = read_with_axis<Capsule>(object);
  if (kind == 3) {
    const Selection::InBox box = read_box(object);  // reports unknown keys, too
    for (std::size_t c = 0; c < 3; ++c)
      if (box.max[c] - box.min[c] < shortest_length && object.find("min") && object.find("max"))
        object.complain(std::string("has no volume: 'min' equals 'max' along ") + "xyz"[c]);
    return Box{box.min, box.max};
  }
  if (kind == 4) shape = read_with_axis<Cylinder>(object);
  if (kind == 5) shape = read_surface_shape(object, reading);
  object.finish();
  return shape;
}

void read_motion(ObjectReader& object, const Scene& scene, Obstacle& obstacle) {
  RigidPath& motion = obstacle.motion;
  motion.centre = ball_around(obstacle.shape).centre;
  motion.centre = object.vector("centre", Limits::any("m")).value_or(motion.centre);
  for_each_object(object, "path", "stations", [&](ObjectReader& reader) {
    const RigidPath::Station station =
        read_pose(reader, motion.stations.empty() ? nullptr : &motion.stations.back());
    if (scene.solver.end && station.at > *scene.solver.end)
      reader.complain("at", "is after the end of the run (/solver/end)");
    if (station.angle != 0 && object.find("axis") == nullptr)
      reader.complain("angle", "needs an axis: give \"axis\": [x, y, z] beside the path");
    motion.stations.push_back(station);
  });
  const JsonValue* path = object.find("path");
  if (path != nullptr && path->kind == JsonValue::Kind::array && motion.stations.empty())
    object.complain("path", "is empty; give at least one station, or remove it");
  if (object.find("axis") != nullptr)
    motion.axis = read_direction(object, "axis").value_or(motion.axis);
}

/// By default as a ball of the obstacle's size that swings without overshooting, equally fast in
/// translation and rotation.
void read_coupling(ObjectReader coupling, Obstacle& obstacle) {
  Coupling c;
  coupling.require("mass", "of the tool, in kg");
  coupling.require("stiffness", "of the spring between hand and tool, in N/m");
  c.mass = coupling.number("mass", Limits::positive("kg")).value_or(1);
  c.stiffness = coupling.number("stiffness", Limits::positive("N/m")).value_or(1);
  c.damping = coupling.number("damping", Limits::not_negative("N s/m"))
                  .value_or(2 * std::sqrt(c.stiffness * c.mass));
  const double reach = obstacle.reach();
  c.inertia =
      coupling.number("inertia", Limits::positive("kg m^2")).value_or(0.4 * c.mass * reach * reach);
  const double ratio = c.inertia / c.mass;
  c.turning_stiffness = coupling.number("turning_stiffness", Limits::positive("N m/rad"))
                            .value_or(ratio * c.stiffness);
  c.turning_damping = coupling.number("turning_damping", Limits::not_negative("N m s/rad"))
                          .value_or(ratio * c.damping);
  if (std::holds_alternative<HalfSpace>(obstacle.shape))
    coupling.complain("is not possible for a half_space, which has no size; use a {\"box\"}");
  coupling.finish();
  obstacle.coupling = c;
}

void read_name(ObjectReader& object, const std::vector<Obstacle>& earlier, Obstacle& obstacle) {
  object.require("name", "the name of the columns in tools.csv");
  obstacle.name = object.string("name").value_or("");
  if (object.find("name") != nullptr && !is_good_name(obstacle.name))
    object.complain("name", "must consist of letters, digits, '_', '-' and '.'");
  if (std::ranges::find(earlier, obstacle.name, &Obstacle::name) != earlier.end())
    object.complain("name", "'" + obstacle.name +
                                "' is already the name of an earlier obstacle; names must be "
                                "unique");
}

Obstacle read_obstacle(ObjectReader& object, Reading& reading, double friction) {
  const Scene& scene = reading.scene;
  Obstacle obstacle;
  obstacle.path = object.path();
  read_name(object, scene.contact.obstacles, obstacle);
  if (const auto kind = object.one_of(shapes)) {
    const std::string& key = shapes[*kind];
    obstacle.shape =
        read_shape({*object.find(key), object.path_of(key), object.mistakes()}, *kind, reading);
  }
  read_motion(object, scene, obstacle);
  obstacle.friction = object.number("friction", Limits::not_negative("1")).value_or(friction);
  obstacle.push_out = object.boolean("push_out").value_or(false);
  if (const JsonValue* coupling = object.find("coupling"))
    read_coupling({*coupling, object.path_of("coupling"), object.mistakes()}, obstacle);
  return obstacle;
}

/// Springs keep energy, friction does not; and what starts inside an obstacle would be thrown out.
void refuse_with_penalty(ObjectReader& contact, const ContactOptions& options,
                         const SolverOptions& solver) {
  const auto refuse = [&](const std::string& what) {
    contact.complain("law", "\"penalty\" cannot be combined with " + what + "; remove one of them");
  };
  const auto any = [&](auto has) { return std::ranges::any_of(options.obstacles, has); };
  if (options.pieces) refuse("\"pieces\" and \"self\": only obstacles push with springs");
  if (any([](const Obstacle& o) { return o.friction > 0; }))
    refuse("\"friction\", which loses energy");
  if (any([](const Obstacle& o) { return o.coupling.has_value(); })) refuse("\"coupling\"");
  if (any([](const Obstacle& o) { return o.push_out; }))
    refuse("\"push_out\": springs would throw the body out");
  if (is_implicit(solver.integrator))
    refuse("the integrator '" + solver.integrator + "', which has a law of its own");
}

/// Contact that is ignored would be worse than none.
void refuse_solvers_without_contact(ObjectReader& contact, const ContactOptions& options,
                                    const SolverOptions& solver) {
  const auto refuse = [&](const std::string& what, const std::string& remedy) {
    contact.complain("cannot be combined with " + what + "; " + remedy);
  };
  if (solver.integrator == "newmark")
    refuse("the integrator 'newmark': forces of contact would feed its oscillations",
           "use \"implicit-euler\", or remove /contact");
  if (solver.budget)
    refuse("\"budget\" in /solver: contact is not found in one linearised step",
           "remove one of them");
  const bool solves = solves_equations(solver.integrator);
  if (solves && std::ranges::any_of(options.obstacles,
                                    [](const Obstacle& o) { return o.coupling.has_value(); }))
    refuse("\"coupling\" of an obstacle and the integrator '" + solver.integrator +
               "': a tool that gives way moves with explicit steps",
           "use \"symplectic-euler\" or \"velocity-verlet\", or remove \"coupling\"");
  if (solver.sleep_acceleration > 0 && (options.penalty || solves))
    refuse("\"sleep\" in /solver and " +
               (options.penalty ? "\"law\": \"penalty\""
                                : "the integrator '" + solver.integrator + "'") +
               ": an island would not wake when it is touched",
           "remove \"sleep\"");
  if (solver.step_error && solver.integrator != "newmark")  // which has it by default
    refuse("\"step_error\" in /solver: its estimate does not include impacts",
           "remove it, or remove /contact");
}

}  // namespace

void read_contact(ObjectReader& top, Reading& reading) {
  const JsonValue* value = top.find("contact");
  if (value == nullptr) return;
  ContactOptions& contact = reading.scene.contact;
  ObjectReader object(*value, "/contact", reading.mistakes);
  contact.friction = object.number("friction", Limits::not_negative("1")).value_or(0);
  contact.self = object.boolean("self").value_or(false);
  contact.pieces = object.boolean("pieces").value_or(contact.self);
  if (contact.self && !contact.pieces)
    object.complain("pieces",
                    "is false, but a body that touches itself touches its pieces, too; "
                    "remove this key, or set \"self\": false");
  contact.thickness = object.number("thickness", Limits::not_negative("m")).value_or(0);
  for_each_object(object, "obstacles", "obstacles", [&](ObjectReader& reader) {
    contact.obstacles.push_back(read_obstacle(reader, reading, contact.friction));
  });
  const JsonValue* obstacles = object.find("obstacles");
  const bool are_mistaken = obstacles && obstacles->kind != JsonValue::Kind::array;
  if (!contact.is_wanted() && !contact.self && !are_mistaken && object.is_object())
    object.complain(
        "touches nothing: give \"obstacles\", set \"pieces\": true, or remove /contact");
  contact.penalty = object.choice("law", laws) == 1u;
  if (object.is_object()) refuse_solvers_without_contact(object, contact, reading.scene.solver);
  if (contact.penalty) refuse_with_penalty(object, contact, reading.scene.solver);
  object.finish();
}

}  // namespace suture::scene_parts
