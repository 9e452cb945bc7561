// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <span>

#include "kernel/base/escape.hpp"
#include "kernel/plugin_host/table_check.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

using Kind = FieldCondition::Kind;

/// Whether some model has a functor that changes the field.
bool is_changed(const Scene& scene, const std::string& field) {
  return std::ranges::any_of(scene.models, [&](const ModelUse& use) {
    const std::span functors(use.model->functors, use.model->functor_count);
    return std::ranges::any_of(functors, [&](const suture_functor& f) {
      return f.field != 0 && use.model->attributes[f.field - 1].name == field;
    });
  });
}

struct DeclaredField {
  std::string name;
  std::uint32_t components = 1;
  Limits limits;  ///< of all models that declare it
};

/// The fields that models declare, each once. Models that allow no common value start from
/// different ones, too; they are refused when the scene is built (Attributes::declare).
std::vector<DeclaredField> declared_fields(const Scene& scene) {
  std::vector<DeclaredField> fields;
  for (const ModelUse& use : scene.models)
    for (const auto& a : std::span(use.model->attributes, use.model->attribute_count)) {
      if ((a.flags & SUTURE_FIELD) == 0) continue;
      auto field = std::ranges::find(fields, a.name, &DeclaredField::name);
      if (field == fields.end())
        field = fields.insert(field, {a.name, a.components, Limits::any(a.unit)});
      if (!has_range(a)) continue;
      field->limits.minimum = std::max(field->limits.minimum, a.minimum);
      field->limits.maximum = std::min(field->limits.maximum, a.maximum);
    }
  for (DeclaredField& field : fields)
    if (field.limits.minimum > field.limits.maximum) field.limits = Limits::any(field.limits.unit);
  return fields;
}

/// [[t, value], ...]
ValuePath read_path(const JsonValue& value, const std::string& path, const Limits& limits,
                    Mistakes& mistakes) {
  ValuePath result;
  const PairRules rules{"pairs [time, value]", "a time in s and a value",
                        "must be later than the one before", Limits::not_negative("s"), limits};
  for (const auto& [time, there] : read_ascending_pairs(value, path, rules, mistakes))
    result.stations.push_back({time, there});
  return result;
}

/// Which of several components.
void read_component(ObjectReader& object, const DeclaredField& field, FieldCondition& condition) {
  if (field.components == 1) return;
  const std::string last = std::to_string(field.components - 1);
  if (object.require("component", "which one of " + quote(field.name) + ", 0 to " + last))
    condition.component = object.natural("component", 0, field.components - 1).value_or(0);
}

/// What values it may have; nothing is known of a field that no model declares.
Limits read_field(ObjectReader& object, const Scene& scene, FieldCondition& condition) {
  object.require("field", "the name of a field, such as \"temperature\"");
  const auto declared = declared_fields(scene);
  std::vector<std::string> names;
  for (const DeclaredField& field : declared) names.push_back(field.name);
  if (names.empty()) {
    object.find("field");
    object.complain("no model of this scene declares a field; add one that does, such as heat");
    return {};
  }
  const auto choice = object.choice("field", names);
  if (!choice) {
    object.find("component");
    return {};
  }
  condition.field = names[*choice];
  read_component(object, declared[*choice], condition);
  return declared[*choice].limits;
}

void read_film(ObjectReader film, const Limits& limits, FieldCondition& condition) {
  film.require("coefficient", "what enters per area, second and difference of the field");
  condition.value = film.number("coefficient", Limits::not_negative("1")).value_or(0);
  film.require("outside", "the value of the field outside");
  condition.outside = film.number("outside", limits).value_or(0);
  film.finish();
}

void read_condition(ObjectReader& object, Reading& reading) {
  FieldCondition condition;
  condition.place = object.path();
  const Limits limits = read_field(object, reading.scene, condition);
  static const std::array<std::string, 6> kinds{"start", "fix", "move", "flux", "source", "film"};
  const auto kind = object.one_of(kinds);
  if (!kind) {
    for (const char* known : {"where", "ramp"}) object.find(known);
    return;
  }
  condition.kind = static_cast<Kind>(*kind);
  const std::string& key = kinds[*kind];
  const bool flows = condition.kind >= Kind::flux;
  if (condition.kind == Kind::move)
    condition.path = read_path(*object.find(key), object.path_of(key), limits, object.mistakes());
  else if (condition.kind == Kind::film)
    read_film({*object.find(key), object.path_of(key), object.mistakes()}, limits, condition);
  else
    condition.value = object.number(key, flows ? Limits() : limits).value_or(0);
  if (condition.kind == Kind::fix) condition.path.stations = {{0, condition.value}};
  if (flows && !condition.field.empty() && !is_changed(reading.scene, condition.field))
    object.complain(key, "no model of this scene changes " + quote(condition.field) +
                             ", so nothing can flow into it; add one that does, such as heat");
  if (const JsonValue* ramp = object.find("ramp")) {
    condition.ramp = read_ramp(*ramp, object.path_of("ramp"), object.mistakes());
    if (!flows)
      object.complain("ramp", "belongs to \"flux\", \"source\" and \"film\"; use \"move\"");
  }
  const char* what =
      flows && condition.kind != Kind::source ? "the nodes of the faces" : "the nodes";
  const JsonValue* where =
      condition.kind == Kind::start ? object.find("where") : object.require("where", what);
  if (where != nullptr)
    condition.where = read_selection(*where, object.path_of("where"), object.mistakes());
  condition.where.path = object.path_of("where");
  reading.scene.fields.push_back(std::move(condition));
}

/// What fields do not go together with.
void check_solver(ObjectReader& top, const Reading& reading) {
  const Scene& scene = reading.scene;
  for (const auto& [name, components, limits] : declared_fields(scene)) {
    if (!is_changed(scene, name)) continue;
    if (scene.solver.until_rest)
      top.complain("solver", "\"until\": \"rest\" looks at the motion alone, and " + quote(name) +
                                 " may still change at rest; give \"end\", or use \"static\"");
    if (scene.solver.sleep_acceleration > 0)
      top.complain("solver", "\"sleep\" looks at the motion alone, and " + quote(name) +
                                 " may wake what sleeps; remove it");
    return;
  }
}

}  // namespace

void read_field_conditions(ObjectReader& top, Reading& reading) {
  if (std::ranges::any_of(reading.scene.models,
                          [](const ModelUse& use) { return use.model == nullptr; })) {
    top.find("fields");  // a model that could not be found might declare any
    return;
  }
  for_each_object(top, "fields", "conditions",
                  [&](ObjectReader& object) { read_condition(object, reading); });
  check_solver(top, reading);
}

}  // namespace suture::scene_parts
