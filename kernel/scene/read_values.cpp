// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values of parameters and attributes that differ from cell to cell.
#include <algorithm>
#include <array>
#include <span>

#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/scene/scene_parts.hpp"
#include "kernel/scene/start_values.hpp"

namespace suture::scene_parts {
namespace {

/// What the values of a column must be.
struct Shape {
  std::uint32_t components;
  Limits limits;
};

std::vector<double> read_value(const JsonValue& value, const std::string& path, const Shape& shape,
                               Mistakes& mistakes) {
  if (shape.components == 1) {
    const auto number = read_number(value, path, shape.limits, mistakes);
    return {number.value_or(0)};
  }
  std::vector<double> result(shape.components);
  if (value.kind != JsonValue::Kind::array || value.items.size() != shape.components) {
    mistakes.add(
        value.at, path,
        "must be " + std::to_string(shape.components) + " numbers [...], is " + describe(value));
    return result;
  }
  for (std::size_t c = 0; c < result.size(); ++c)
    result[c] =
        read_number(value.items[c], child_path(path, c), shape.limits, mistakes).value_or(0);
  return result;
}

CellValues::Part read_part(ObjectReader part, const Shape& shape) {
  CellValues::Part result;
  if (const JsonValue* region = part.require("region", "the cells with this value"))
    result.region = read_selection(*region, part.path_of("region"), part.mistakes());
  if (const JsonValue* value = part.require("value", "the value in this region"))
    result.value = read_value(*value, part.path_of("value"), shape, part.mistakes());
  part.finish();
  return result;
}

void read_table(ObjectReader& object, const Shape& shape, CellValues& values) {
  const JsonValue* regions = object.find("regions");
  const std::string path = object.path_of("regions");
  const auto* items =
      read_array(*regions, path, "objects {\"region\", \"value\"}", object.mistakes());
  if (items != nullptr && items->empty()) object.complain("regions", "is empty; give at least one");
  for (std::size_t i = 0; items != nullptr && i < items->size(); ++i)
    values.parts.push_back(
        read_part(ObjectReader((*items)[i], child_path(path, i), object.mistakes()), shape));
  if (const JsonValue* value = object.find("elsewhere"))
    values.elsewhere = read_value(*value, object.path_of("elsewhere"), shape, object.mistakes());
}

/// {"array": NAME, "scale": FACTOR} or {"regions": [...], "elsewhere": VALUE}.
CellValues read_cell_values(ObjectReader object, const Shape& shape) {
  CellValues values;
  values.path = object.path();
  const std::array<std::string, 2> keys{"array", "regions"};
  const auto kind = object.one_of(keys);
  if (kind == 0) {
    const auto name = object.string("array");
    if (name && name->empty()) object.complain("array", "is empty; name an array of the mesh");
    values.array = name.value_or("");
    values.scale = object.number("scale", Limits::any("1")).value_or(1);
  } else if (kind == 1) {
    read_table(object, shape, values);
  }
  object.finish();
  return values;
}

bool is_cell_values(const JsonValue& value) { return value.kind == JsonValue::Kind::object; }

std::uint32_t attribute_of(const suture_model& model, const suture_parameter& parameter) {
  const std::span attributes(model.attributes, model.attribute_count);
  const auto found = std::ranges::find_if(attributes, [&](const suture_attribute& a) {
    return (a.flags & SUTURE_PARAMETER) != 0 && std::string_view(a.name) == parameter.name;
  });
  return static_cast<std::uint32_t>(found - attributes.begin());
}

void complain_uniform(ObjectReader& parameters, const suture_parameter& parameter) {
  parameters.complain(
      parameter.name,
      "must be the same in all elements of a model, but is given by an object; give "
      "one value, or use one entry in /models per region");
}

void read_start_of(ObjectReader& start, const suture_attribute& attribute, std::uint32_t place,
                   ModelUse& use) {
  const JsonValue* value = start.find(attribute.name);
  if (value == nullptr) return;
  const std::string path = start.path_of(attribute.name);
  const Shape shape{attribute.components, Limits::any(attribute.unit)};
  CellValues values;
  if (!is_cell_values(*value)) {
    values.path = path;
    values.elsewhere = read_value(*value, path, shape, start.mistakes());
  } else if (attribute.dimension == 1 || attribute.dimension == 2) {
    start.complain(
        attribute.name,
        std::string("must be one value: arrays and regions are of nodes and elements, ") +
            "but this attribute belongs to " + (attribute.dimension == 1 ? "edges" : "faces"));
  } else {
    values = read_cell_values(ObjectReader(*value, path, start.mistakes()), shape);
  }
  values.attribute = place;
  use.values.push_back(std::move(values));
}

}  // namespace

Limits limits_of(const suture_parameter& parameter) {
  return {parameter.unit, parameter.minimum, parameter.maximum,
          (parameter.flags & SUTURE_MINIMUM_EXCLUDED) != 0,
          (parameter.flags & SUTURE_MAXIMUM_EXCLUDED) != 0};
}

CellValues read_element_values(ObjectReader& object, const std::string& key, const Limits& limits,
                               const std::string& what) {
  CellValues values;
  values.path = object.path_of(key);
  const JsonValue* value = object.require(key, what);
  if (value == nullptr) return values;
  const Shape shape{1, limits};
  if (is_cell_values(*value)) {
    ObjectReader table(*value, values.path, object.mistakes());
    if (table.require("regions", "a table over regions") != nullptr)
      read_table(table, shape, values);
    table.finish();
  } else {
    values.elsewhere = read_value(*value, values.path, shape, object.mistakes());
  }
  return values;
}

bool read_parameter_values(ObjectReader& parameters, const suture_parameter& parameter,
                           ModelUse& use) {
  const bool is_direction = parameter.type == SUTURE_DIRECTION;
  const JsonValue* value = parameters.find(parameter.name);
  if (value == nullptr) return is_direction;
  if (!is_direction && !is_cell_values(*value)) return false;
  if ((parameter.flags & SUTURE_PER_ELEMENT) == 0) {
    if (parameter.type != SUTURE_NUMBER && parameter.type != SUTURE_INTEGER) return false;
    complain_uniform(parameters, parameter);
    return true;
  }
  const std::string path = parameters.path_of(parameter.name);
  const Shape shape{is_direction ? 3u : 1u, is_direction ? Limits::any("1") : limits_of(parameter)};
  CellValues values;
  if (is_cell_values(*value)) {
    values = read_cell_values(ObjectReader(*value, path, parameters.mistakes()), shape);
  } else {
    values.path = path;
    const auto direction = read_direction(parameters, parameter.name).value_or(Vec3{1, 0, 0});
    values.elsewhere.assign(direction.begin(), direction.end());
  }
  values.parameter = &parameter;
  values.attribute = attribute_of(*use.model, parameter);
  use.values.push_back(std::move(values));
  return true;
}

void read_start(ObjectReader& model, ModelUse& use) {
  const JsonValue* value = model.find("start");
  if (value == nullptr) return;
  const std::span attributes(use.model->attributes, use.model->attribute_count);
  if (std::ranges::none_of(attributes, has_start))
    return model.complain("start",
                          "cannot be given: this model has no attribute that a scene sets");
  ObjectReader start(*value, model.path_of("start"), model.mistakes());
  for (std::uint32_t i = 0; i < use.model->attribute_count; ++i)
    if (has_start(use.model->attributes[i])) read_start_of(start, use.model->attributes[i], i, use);
  start.finish();
}

}  // namespace suture::scene_parts
