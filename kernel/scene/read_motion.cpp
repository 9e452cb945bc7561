// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/scene/csv_table.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }
using Factors = std::vector<std::pair<std::string, double>>;

// What a column of a table measures.
struct Quantity {
  std::string name;  // in "units"
  Factors units;     // factors to s, m and rad
};
const Quantity time_quantity{"time", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}},
    length_quantity{"length", {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}}},
    angle_quantity{"angle", {{"degrees", radians(1)}, {"deg", radians(1)}, {"rad", 1}}};

std::vector<std::string> names_of(const Factors& factors) {
  std::vector<std::string> names;
  for (const auto& [name, factor] : factors) names.push_back(name);
  return names;
}

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + quote(name);
  return text;
}

// A column that "columns" names, with its factor to SI units.
struct TableColumn {
  std::size_t index = 0;
  double factor = 1;
};

// The keys of "table", with what they refer to in the file.
class TableReader {
 public:
  TableReader(ObjectReader& object, Reading& reading)
      : object_(object), table_(file_of(object, reading)) {}

  // Stations with a time and what else is given.
  std::vector<MotionPath::Station> stations() {
    const JsonValue* columns =
        object_.require("columns", "the names of the columns: {\"time\": ..., \"x\": ..., ...}");
    const JsonValue* units = object_.find("units");
    const bool is_relative = object_.boolean("relative").value_or(false);
    object_.finish();
    if (columns == nullptr) return {};
    ObjectReader names(*columns, object_.path_of("columns"), object_.mistakes());
    std::optional<ObjectReader> given;
    if (units != nullptr) given.emplace(*units, object_.path_of("units"), object_.mistakes());
    names.require("time", "the name of the column of times");
    const std::optional<TableColumn> time = column(names, "time", time_quantity, given);
    std::array<std::optional<TableColumn>, 4> place;
    for (std::size_t c = 0; c < 4; ++c)
      place[c] = column(names, axes[c], c < 3 ? length_quantity : angle_quantity, given);
    names.finish();
    if (given) given->finish();
    if (!time) return {};
    if (std::ranges::none_of(axes, [&](const char* key) { return names.find(key) != nullptr; }))
      names.complain("names no column of displacements: give 'x', 'y', 'z' or 'angle'");
    if (std::ranges::none_of(place, [](const auto& p) { return p.has_value(); })) return {};
    return rows(*time, place, is_relative);
  }

 private:
  static constexpr const char* axes[] = {"x", "y", "z", "angle"};

  static CsvTable file_of(ObjectReader& object, Reading& reading) {
    const JsonValue* name = object.require("file", "a file of columns of numbers (CSV)");
    if (name == nullptr) throw InputError("");  // has been reported
    const std::size_t before = reading.mistakes.count();
    const std::filesystem::path file = read_file(*name, object.path_of("file"), reading);
    if (reading.mistakes.count() != before) throw InputError("");
    return CsvTable(file);
  }

  std::optional<TableColumn> column(ObjectReader& names, const char* key, const Quantity& quantity,
                                    std::optional<ObjectReader>& units) {
    const std::optional<std::string> wanted = names.string(key);
    if (!wanted) return std::nullopt;
    const auto is_wanted = [&](const std::string& name) {
      return name == *wanted || split_unit(name).name == *wanted;
    };
    const auto found = std::ranges::find_if(table_.names(), is_wanted);
    if (found == table_.names().end()) {
      std::vector<std::string> bare;
      for (const std::string& name : table_.names()) bare.emplace_back(split_unit(name).name);
      names.complain(key, "the file has no column " + quote(*wanted) + did_you_mean(*wanted, bare) +
                              "; its columns are " + list_of(table_.names()));
      return std::nullopt;
    }
    std::string unit(split_unit(*found).unit);
    if (units) {
      const std::optional<std::string> text = units->string(quantity.name);
      if (text && unit.empty()) unit = *text;
      if (text && unit != *text)
        units->complain(quantity.name, "differs from the unit of column " + quote(*found));
    }
    const auto factor = std::ranges::find(quantity.units, unit, &Factors::value_type::first);
    if (factor == quantity.units.end()) {
      const std::vector<std::string> known = names_of(quantity.units);
      names.complain(
          key, "column " + quote(*found) +
                   (unit.empty()
                        ? " has no unit: name it in the file, as " +
                              quote(*found + " [" + known.front() + "]") +
                              ", or give \"units\": {" + quote(quantity.name) + ": ...}; one of "
                        : " has the unit " + quote(unit) + ", expected one of ") +
                   list_of(known));
      return std::nullopt;
    }
    return TableColumn{static_cast<std::size_t>(found - table_.names().begin()), factor->second};
  }

  std::vector<MotionPath::Station> rows(const TableColumn& time,
                                        const std::array<std::optional<TableColumn>, 4>& place,
                                        bool is_relative) const {
    std::vector<MotionPath::Station> stations;
    for (std::size_t row = 0; row < table_.row_count(); ++row) {
      MotionPath::Station& station = stations.emplace_back();
      station.at = time.factor * table_.number(row, time.index);
      for (std::size_t c = 0; c < 4; ++c)
        if (place[c]) station.place[c] = place[c]->factor * table_.number(row, place[c]->index);
      if (station.at < 0) throw InputError(table_.place(row) + ": the time is negative");
      if (row > 0 && station.at <= stations[row - 1].at)
        throw InputError(table_.place(row) + ": the time is not later than in the row before");
    }
    const std::array<double, 4> first = stations.front().place;
    if (is_relative)
      for (MotionPath::Station& station : stations)
        for (std::size_t c = 0; c < 4; ++c) station.place[c] -= first[c];
    else if (first != std::array<double, 4>{})
      throw InputError(table_.place(0) +
                       ": the motion begins away from where the nodes are at rest; "
                       "\"relative\": true subtracts the first row");
    return stations;
  }

  ObjectReader& object_;
  CsvTable table_;
};

std::vector<MotionPath::Station> read_table(const JsonValue& value, const std::string& path,
                                            Reading& reading) {
  ObjectReader object(value, path, reading.mistakes);
  if (!object.is_object()) return {};
  try {
    return TableReader(object, reading).stations();
  } catch (const InputError& error) {
    if (*error.what() != '\0') object.complain(error.what());
    return {};
  }
}

std::vector<MotionPath::Station> read_path(ObjectReader& move) {
  std::vector<MotionPath::Station> stations;
  std::optional<RigidPath::Station> previous;
  for_each_object(move, "path", "stations", [&](ObjectReader& object) {
    previous = read_pose(object, previous ? &*previous : nullptr);
    const auto& [x, y, z] = previous->translation;
    const std::array<double, 4> place{x, y, z, previous->angle};
    if (stations.empty() && place != std::array<double, 4>{})
      object.complain("begins away from where the nodes are at rest; begin with {\"at\": s}");
    stations.push_back({previous->at, place, {}});
  });
  return stations;
}

void read_shape(ObjectReader& move, MotionPath& path) {
  static const std::array<std::string, 3> kinds{"linear", "smooth", "cubic"};
  const std::size_t shape = move.choice("shape", kinds).value_or(0);
  path.is_linear = shape == 0;
  if (path.stations.size() < 2) return;  // which has been reported
  if (shape == 2 && path.stations.size() < 4)
    move.complain("shape", "\"cubic\" needs at least 4 stations; there are " +
                               std::to_string(path.stations.size()));
  else if (shape == 2)
    path.make_monotone();
}

void read_axis(ObjectReader& rotation, Constraint& constraint) {
  rotation.require("axis", "the direction of the axis [x, y, z]");
  constraint.axis = read_direction(rotation, "axis").value_or(Vec3{0, 0, 1});
  constraint.centre = rotation.vector("centre", Limits::any("m")).value_or(Vec3{});
}

// Stations, inline or from a file.
void read_stations(ObjectReader& object, ObjectReader& move, Reading& reading,
                   Constraint& constraint) {
  const JsonValue* table = move.find("table");
  constraint.path.stations =
      table ? read_table(*table, move.path_of("table"), reading) : read_path(move);
  if (table == nullptr && constraint.path.stations.size() < 2)
    move.complain("path", "must have at least 2 stations");
  else if (constraint.path.stations.size() == 1)
    move.complain("table", "has one row of numbers; a motion has at least two");
  read_shape(move, constraint.path);
  if (const JsonValue* value = move.find("rotation")) {
    ObjectReader rotation(*value, move.path_of("rotation"), object.mistakes());
    read_axis(rotation, constraint);
    rotation.finish();
  } else if (constraint.path.turns()) {
    move.complain("turns, but has no axis: give \"rotation\": {\"axis\": [x, y, z]}");
  }
  if (object.find("ramp") != nullptr)
    object.complain("ramp", "has no meaning here: the stations of the motion have times");
}

// One translation and rotation, along a ramp.
void read_ramped(ObjectReader& object, ObjectReader& move, Constraint& constraint) {
  constraint.translation = move.vector("translation", Limits::any("m")).value_or(Vec3{});
  if (const JsonValue* value = move.find("rotation")) {
    ObjectReader rotation(*value, move.path_of("rotation"), object.mistakes());
    read_axis(rotation, constraint);
    rotation.require("angle", "the angle at the end of the ramp, in degrees");
    constraint.angle = radians(rotation.number("angle", Limits::any("degrees")).value_or(0));
    rotation.finish();
  } else if (move.find("translation") == nullptr && move.is_object()) {
    move.complain("must have 'translation', 'rotation', 'path' or 'table'");
  }
  if (const JsonValue* ramp =
          object.require("ramp", "the duration of the motion in s, or {\"from\", \"to\"}")) {
    constraint.ramp = read_ramp(*ramp, object.path_of("ramp"), object.mistakes());
    if (constraint.ramp.to <= constraint.ramp.from)
      object.complain("ramp", "must last longer than 0 s: a jump would mean infinite velocity");
  }
}

/// Whether the motion changes a component: along the axis, or by a turn about another axis.
bool changes(const Constraint& constraint, std::size_t component) {
  bool shifts = constraint.translation[component] != 0, turns = constraint.angle != 0;
  for (const MotionPath::Station& station : constraint.path.stations) {
    shifts = shifts || station.place[component] != 0;
    turns = turns || station.place[3] != 0;
  }
  const Vec3& axis = constraint.axis;
  const bool is_across = axis[(component + 1) % 3] != 0 || axis[(component + 2) % 3] != 0;
  return shifts || (turns && is_across);
}

/// The components that follow the motion; the body finds the others.
void read_moved_components(ObjectReader& object, Constraint& constraint) {
  constraint.components = read_components(object, "components");
  if (constraint.components == 0) return;  // which has been reported
  for (std::size_t c = 0; c < 3; ++c)
    if (!(constraint.components >> c & 1) && changes(constraint, c))
      object.complain("components", std::string("leaves ") + "xyz"[c] +
                                        " free, but the motion changes it; add it, or change the "
                                        "motion");
}

}  // namespace

RigidPath::Station read_pose(ObjectReader& object, const RigidPath::Station* previous) {
  RigidPath::Station station;
  object.require("at", "the time of the station, in s");
  station.at = object.number("at", Limits::not_negative("s")).value_or(0);
  if (previous && station.at <= previous->at)
    object.complain("at", "must be later than the previous station");
  station.translation = object.vector("translation", Limits::any("m")).value_or(Vec3{});
  station.angle = radians(object.number("angle", Limits::any("degrees")).value_or(0));
  return station;
}

void read_motion(ObjectReader& object, Reading& reading, Constraint& constraint) {
  ObjectReader move(*object.find("move"), object.path_of("move"), object.mistakes());
  constraint.moves = true;
  const bool has_path = move.find("path") != nullptr, has_table = move.find("table") != nullptr;
  if (has_path && has_table) move.complain("has both 'path' and 'table'; give one of them");
  if (has_path || has_table)
    read_stations(object, move, reading, constraint);
  else
    read_ramped(object, move, constraint);
  move.finish();
  read_moved_components(object, constraint);
}

}  // namespace suture::scene_parts
