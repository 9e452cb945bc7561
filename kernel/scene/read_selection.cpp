// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cctype>

#include "kernel/base/escape.hpp"
#include "kernel/base/safe_range.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

Selection::Plane read_plane(ObjectReader plane) {
  Selection::Plane result{};
  result.point = require_vector(plane, "point", "m", "a point of the plane [x, y, z] in m");
  plane.require("normal", "the direction normal to the plane [x, y, z]");
  result.normal = read_direction(plane, "normal").value_or(Vec3{0, 0, 1});
  result.tolerance = plane.number("tolerance", Limits::not_negative("m")).value_or(-1);
  plane.finish();
  return result;
}

Selection::HalfSpace read_half_space(ObjectReader half) {
  Selection::HalfSpace result{};
  result.point = require_vector(half, "point", "m", "a point of the boundary [x, y, z] in m");
  half.require("normal", "the direction into the half space [x, y, z]");
  result.normal = read_direction(half, "normal").value_or(Vec3{0, 0, 1});
  half.finish();
  return result;
}

Selection::Sphere read_sphere(ObjectReader sphere) {
  Selection::Sphere result{};
  result.centre = require_vector(sphere, "centre", "m", "the centre [x, y, z] in m");
  sphere.require("radius", "the radius in m");
  result.radius = sphere.number("radius", Limits::positive("m")).value_or(1);
  sphere.finish();
  return result;
}

Selection::Cylinder read_cylinder(ObjectReader cylinder) {
  Selection::Cylinder result{};
  result.from = require_vector(cylinder, "from", "m", "the centre of one end [x, y, z] in m");
  result.to = require_vector(cylinder, "to", "m", "the centre of the other end [x, y, z] in m");
  cylinder.require("radius", "the radius in m");
  result.radius = cylinder.number("radius", Limits::positive("m")).value_or(1);
  if (result.from == result.to)
    cylinder.complain("to", "is the same point as 'from', so the cylinder has no axis");
  cylinder.finish();
  return result;
}

Selection::Combined read_combined(Selection::Combined::How how, const JsonValue& value,
                                  const std::string& path, Mistakes& mistakes) {
  Selection::Combined result{how, {}};
  if (how == Selection::Combined::How::none_of) {
    result.parts.push_back(read_selection(value, path, mistakes));
    return result;
  }
  if (const auto* items = read_array(value, path, "selections", mistakes)) {
    if (items->empty()) mistakes.add(value.at, path, "is empty; give at least one selection");
    for (std::size_t i = 0; i < items->size(); ++i)
      result.parts.push_back(read_selection((*items)[i], child_path(path, i), mistakes));
  }
  if (result.parts.empty()) result.parts.emplace_back();
  return result;
}

Selection::Ids read_ids(const JsonValue& value, const std::string& path, Mistakes& mistakes) {
  Selection::Ids result;
  const auto* items = read_array(value, path, "numbers of the mesh", mistakes);
  if (items == nullptr) return result;
  if (items->empty()) mistakes.add(value.at, path, "is empty; name at least one");
  for (std::size_t i = 0; i < items->size(); ++i) {
    const auto id = read_natural((*items)[i], child_path(path, i), 0, UINT64_MAX, mistakes);
    if (id) result.ids.push_back(*id);
  }
  return result;
}

}  // namespace

Selection::InBox read_box(ObjectReader box) {
  Selection::InBox result;
  result.min =
      require_vector(box, "min", "m", "the corner with the smallest coordinates [x, y, z] in m");
  result.max =
      require_vector(box, "max", "m", "the corner with the largest coordinates [x, y, z] in m");
  for (int a = 0; a < 3; ++a) {
    if (result.min[a] > result.max[a]) {
      box.complain(std::string("'min' is larger than 'max' along ") + "xyz"[a]);
    }
  }
  box.finish();
  return result;
}

Selection read_selection(const JsonValue& value, const std::string& path, Mistakes& mistakes) {
  Selection selection;
  selection.path = path;
  if (value.kind == JsonValue::Kind::string && value.text == "all") return selection;
  if (value.kind != JsonValue::Kind::object) {
    mistakes.add(value.at, path,
                 "must be \"all\" or an object with one of box, plane, half_space, sphere, "
                 "cylinder, nearest, ids, set, and, or, not; is " +
                     describe(value));
    return selection;
  }
  static const std::array<std::string, 11> kinds{"box",     "plane", "half_space", "sphere",
                                                 "nearest", "ids",   "set",        "cylinder",
                                                 "and",     "or",    "not"};
  ObjectReader object(value, path, mistakes);
  if (const auto kind = object.one_of(kinds)) {
    const JsonValue& inner = *object.find(kinds[*kind]);
    const std::string inner_path = object.path_of(kinds[*kind]);
    const auto reader = [&] { return ObjectReader(inner, inner_path, mistakes); };
    switch (*kind) {
      case 0:
        selection.what = read_box(reader());
        break;
      case 1:
        selection.what = read_plane(reader());
        break;
      case 2:
        selection.what = read_half_space(reader());
        break;
      case 3:
        selection.what = read_sphere(reader());
        break;
      case 4:
        selection.what = Selection::Nearest{
            read_vector(inner, inner_path, Limits::any("m"), mistakes).value_or(Vec3{})};
        break;
      case 5:
        selection.what = read_ids(inner, inner_path, mistakes);
        break;
      case 6:
        selection.what = Selection::Named{read_string(inner, inner_path, mistakes).value_or("")};
        break;
      case 7:
        selection.what = read_cylinder(reader());
        break;
      default: {
        using How = Selection::Combined::How;
        constexpr How hows[] = {How::all_of, How::any_of, How::none_of};
        selection.what = read_combined(hows[*kind - 8], inner, inner_path, mistakes);
      }
    }
  }
  object.finish();
  return selection;
}

/// Calls visit(name) for each set that a selection uses.
void for_each_named(const Selection& selection,
                    const std::function<void(const std::string&)>& visit) {
  if (const auto* named = std::get_if<Selection::Named>(&selection.what)) visit(named->set);
  if (const auto* combined = std::get_if<Selection::Combined>(&selection.what))
    for (const Selection& part : combined->parts) for_each_named(part, visit);
}

/// The key "sets": {"NAME": selection, ...}.
void read_sets(ObjectReader& top, Reading& reading) {
  const JsonValue* value = top.find("sets");
  if (value == nullptr) return;
  if (value->kind != JsonValue::Kind::object) {
    reading.mistakes.add(value->at, "/sets",
                         "must be an object {\"NAME\": selection, ...}, is " + describe(*value));
    return;
  }
  for (const JsonMember& member : value->members) {
    const std::string path = child_path("/sets", member.key);
    if (!is_good_name(member.key))
      reading.mistakes.add(member.value.at, path,
                           "the name of a set consists of letters, digits, '_', '-' and '.'");
    reading.scene.sets.push_back(
        {member.key, read_selection(member.value, path, reading.mistakes)});
  }
  const auto& sets = reading.scene.sets;
  for (std::size_t i = 0; i < sets.size(); ++i)
    for_each_named(sets[i].where, [&](const std::string& name) {
      const auto used = std::ranges::find(sets, name, &NamedSelection::name);
      if (used != sets.end() && used - sets.begin() >= std::ptrdiff_t(i))
        reading.mistakes.add(value->members[i].value.at, sets[i].where.path,
                             "uses the set " + quote(name) + ", which is defined " +
                                 (sets[i].name == name ? "here" : "below; define it above"));
    });
}

std::optional<Vec3> read_direction(ObjectReader& object, const std::string& key) {
  const auto vector = object.vector(key, Limits::any("1"));
  if (vector && *vector == Vec3{}) {
    object.complain(key, "must not be [0, 0, 0]: a direction is expected");
    return {};
  }
  if (vector && !is_safe_direction(*vector)) {
    object.complain(key,
                    "must have a largest component between 1e-30 and 1e30; only the direction "
                    "counts, so multiply all three by the same number");
    return {};
  }
  return vector;
}

Vec3 require_vector(ObjectReader& object, const std::string& key, const std::string& unit,
                    const std::string& what) {
  object.require(key, what);
  return object.vector(key, Limits::any(unit)).value_or(Vec3{});
}

std::optional<std::array<Selection, 2>> read_two_regions(const JsonValue& value,
                                                         ObjectReader& object,
                                                         const std::string& key) {
  const std::string path = object.path_of(key);
  Mistakes& mistakes = object.mistakes();
  const auto* items = read_array(value, path, "two selections", mistakes);
  if (items == nullptr) return {};
  if (items->size() == 2)
    return std::array{read_selection((*items)[0], child_path(path, 0), mistakes),
                      read_selection((*items)[1], child_path(path, 1), mistakes)};
  object.complain(
      key, "must be two selections of elements [A, B], has " + std::to_string(items->size()));
  return {};
}

std::vector<Vec3> read_points(const JsonValue& value, const std::string& path, std::size_t least,
                              Mistakes& mistakes) {
  std::vector<Vec3> points;
  const auto* items = read_array(value, path, "points [x, y, z] in m", mistakes);
  if (items == nullptr) return points;
  if (items->size() < least) {
    mistakes.add(value.at, path,
                 "must have at least " + std::to_string(least) + " points, has " +
                     std::to_string(items->size()));
  }
  for (std::size_t i = 0; i < items->size(); ++i) {
    points.push_back(
        read_vector((*items)[i], child_path(path, i), Limits::any("m"), mistakes).value_or(Vec3{}));
  }
  return points;
}

void for_each_object(ObjectReader& parent, const std::string& key, const std::string& of_what,
                     const std::function<void(ObjectReader&)>& read) {
  const JsonValue* value = parent.find(key);
  if (value == nullptr) return;
  const std::string path = parent.path_of(key);
  const auto* items = read_array(*value, path, of_what, parent.mistakes());
  if (items == nullptr) return;
  for (std::size_t i = 0; i < items->size(); ++i) {
    ObjectReader object((*items)[i], child_path(path, i), parent.mistakes());
    if (!object.is_object()) continue;
    read(object);
    object.finish();
  }
}

bool is_good_name(std::string_view name) {
  const auto good = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), good);
}

}  // namespace suture::scene_parts
