// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/base/escape.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

Selection require_where(ObjectReader& object, const std::string& what) {
  const JsonValue* where = object.require("where", what);
  if (where == nullptr) return {};
  return read_selection(*where, object.path_of("where"), object.mistakes());
}

TimeRamp optional_ramp(ObjectReader& object) {
  const JsonValue* ramp = object.find("ramp");
  return ramp ? read_ramp(*ramp, object.path_of("ramp"), object.mistakes()) : TimeRamp{};
}

void read_constraint(ObjectReader& object, Reading& reading) {
  Constraint constraint;
  constraint.name = read_name(object);
  static const std::array<std::string, 2> kinds{"fix", "move"};
  const auto kind = object.one_of(kinds);
  if (kind == 0u) constraint.components = read_components(object, "fix");
  if (kind == 0u && object.find("components") != nullptr)
    object.complain("components", "is only allowed with 'move': 'fix' names its components itself");
  if (kind == 1u) read_motion(object, reading, constraint);
  constraint.where = require_where(object, "the constrained nodes");
  reading.scene.constraints.push_back(std::move(constraint));
}

/// {"along": direction, "values": [[s, factor], ...]}
LoadProfile read_profile(const JsonValue& value, const std::string& path, Mistakes& mistakes) {
  LoadProfile profile;
  ObjectReader object(value, path, mistakes);
  object.require("along", "the direction [x, y, z] in which the load varies");
  profile.along = read_direction(object, "along").value_or(Vec3{0, 0, 1});
  profile.along = scaled(1 / norm(profile.along), profile.along);
  const JsonValue* values = object.require("values", "points [[m, factor], ...]");
  if (values != nullptr)
    profile.points = read_ascending_pairs(
        *values, object.path_of("values"),
        {"pairs [coordinate, factor]", "a coordinate in m and a factor",
         "must have a larger coordinate than the pair before", Limits::any("m"), Limits::any("1")},
        mistakes);
  object.finish();
  return profile;
}

void read_load(ObjectReader& object, Reading& reading) {
  Load load;
  static const std::array<std::string, 4> kinds{"force", "traction", "pressure", "volume"};
  const auto kind = object.one_of(kinds);
  if (kind == 0u) load.value = object.vector("force", Limits::any("N")).value_or(Vec3{});
  if (kind == 1u) {
    load.kind = Load::Kind::traction;
    load.value = object.vector("traction", Limits::any("Pa")).value_or(Vec3{});
  }
  if (kind == 2u) {
    load.kind = Load::Kind::pressure;
    load.pressure = object.number("pressure", Limits::any("Pa")).value_or(0);
  }
  if (kind == 3u) {
    load.kind = Load::Kind::volume;
    load.pressure = object.number("volume", Limits::positive("Pa")).value_or(0);
  }
  load.ramp = optional_ramp(object);
  if (const JsonValue* profile = object.find("profile")) {
    load.profile = read_profile(*profile, object.path_of("profile"), object.mistakes());
    if (load.kind != Load::Kind::traction && load.kind != Load::Kind::pressure)
      object.complain("profile", "is only allowed with 'traction' and 'pressure'");
  }
  load.where = require_where(object, "the loaded nodes");
  reading.scene.loads.push_back(std::move(load));
}

}  // namespace

std::uint8_t read_components(ObjectReader& object, const char* key) {
  const std::string text = object.string(key).value_or("xyz");
  std::uint8_t bits = 0;
  for (const char c : text) {
    const std::size_t axis = std::string_view("xyz").find(c);
    const bool good = axis != std::string_view::npos && (bits >> axis & 1) == 0;
    if (!good) bits = 0;
    if (!good) break;
    bits = static_cast<std::uint8_t>(bits | 1u << axis);
  }
  if (bits == 0)
    object.complain(
        key, "must name components, each once: \"xyz\", \"xy\", \"z\", ...; is " + quote(text));
  return bits;
}

std::vector<std::array<double, 2>> read_ascending_pairs(const JsonValue& value,
                                                        const std::string& path,
                                                        const PairRules& rules,
                                                        Mistakes& mistakes) {
  std::vector<std::array<double, 2>> pairs;
  const auto* items = read_array(value, path, rules.pairs, mistakes);
  for (std::size_t i = 0; items != nullptr && i < items->size(); ++i) {
    const JsonValue& item = (*items)[i];
    const std::string at = child_path(path, i);
    if (item.kind != JsonValue::Kind::array || item.items.size() != 2) {
      mistakes.add(item.at, at, std::string("must be ") + rules.pair + ", is " + describe(item));
      continue;
    }
    const auto x = read_number(item.items[0], child_path(at, 0), rules.first, mistakes);
    const auto y = read_number(item.items[1], child_path(at, 1), rules.second, mistakes);
    if (x && !pairs.empty() && *x <= pairs.back()[0]) mistakes.add(item.at, at, rules.order);
    pairs.push_back({x.value_or(0), y.value_or(0)});
  }
  if (items != nullptr && items->size() < 2)
    mistakes.add(value.at, path, "needs two pairs or more");
  return pairs;
}

TimeRamp read_ramp(const JsonValue& value, const std::string& path, Mistakes& mistakes) {
  TimeRamp ramp;
  if (value.kind == JsonValue::Kind::number) {
    ramp.to = read_number(value, path, Limits::not_negative("s"), mistakes).value_or(0);
    return ramp;
  }
  if (value.kind != JsonValue::Kind::object) {
    mistakes.add(value.at, path,
                 "must be a duration in s or {\"from\", \"to\", \"shape\"}, is " + describe(value));
    return ramp;
  }
  ObjectReader object(value, path, mistakes);
  ramp.from = object.number("from", Limits::not_negative("s")).value_or(0);
  object.require("to", "the time at which the full value is reached, in s");
  ramp.to = object.number("to", Limits::not_negative("s")).value_or(ramp.from);
  if (ramp.to < ramp.from) object.complain("to", "is before 'from'");
  static const std::array<std::string, 2> shapes{"linear", "smooth"};
  ramp.smooth = object.choice("shape", shapes) == 1u;
  object.finish();
  return ramp;
}

void read_gravity(ObjectReader& top, Reading& reading) {
  const JsonValue* value = top.find("gravity");
  if (value == nullptr) return;
  if (value->kind != JsonValue::Kind::object) {
    reading.scene.gravity =
        read_vector(*value, "/gravity", Limits::any("m/s^2"), reading.mistakes).value_or(Vec3{});
    return;
  }
  ObjectReader gravity(*value, "/gravity", reading.mistakes);
  reading.scene.gravity = require_vector(gravity, "value", "m/s^2", "[x, y, z] in m/s^2");
  reading.scene.gravity_ramp = optional_ramp(gravity);
  gravity.finish();
}

void read_constraints(ObjectReader& top, Reading& reading) {
  for_each_object(top, "constraints", "constraints",
                  [&](ObjectReader& object) { read_constraint(object, reading); });
}

void read_initial_motion(ObjectReader& top, Reading& reading) {
  for_each_object(top, "initial_motion", "initial motions", [&](ObjectReader& object) {
    InitialMotion motion;
    const auto velocity = object.vector("velocity", Limits::any("m/s"));
    const auto spin = object.vector("spin", Limits::any("rad/s"));
    motion.velocity = velocity.value_or(Vec3{});
    motion.spin = spin.value_or(Vec3{});
    motion.centre = object.vector("centre", Limits::any("m"));
    if (object.find("velocity") == nullptr && object.find("spin") == nullptr)
      object.complain("needs 'velocity', [x, y, z] in m/s, or 'spin', [x, y, z] in rad/s");
    if (motion.centre && object.find("spin") == nullptr)
      object.complain("centre", "is that of a 'spin', which is missing");
    motion.where = require_where(object, "the moving nodes");
    reading.scene.initial_motion.push_back(std::move(motion));
  });
}

void read_foundations(ObjectReader& top, Reading& reading) {
  for_each_object(top, "foundations", "foundations", [&](ObjectReader& object) {
    Foundation foundation;
    const auto read = [&](const char* key, const char* unit) {
      return object.number(key, Limits::not_negative(unit)).value_or(0);
    };
    foundation.normal = read("normal", "Pa/m");
    foundation.tangential = read("tangential", "Pa/m");
    foundation.damping = read("damping", "Pa s/m");
    if (foundation.normal + foundation.tangential + foundation.damping == 0)
      object.complain("needs 'normal' or 'tangential', stiffness in Pa/m, or 'damping', in Pa s/m");
    foundation.where = require_where(object, "the faces that it supports");
    reading.scene.foundations.push_back(std::move(foundation));
  });
}

void read_loads(ObjectReader& top, Reading& reading) {
  for_each_object(top, "loads", "loads", [&](ObjectReader& object) { read_load(object, reading); });
}

}  // namespace suture::scene_parts
