// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/attributes/lips.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

// "E (Pa): Young's modulus"
std::string summary(const suture_parameter& parameter) {
  const std::string unit = parameter.unit;
  return std::string(parameter.doc) + (unit == "1" || unit.empty() ? "" : ", in " + unit);
}

std::optional<double> read_integer(ObjectReader& object, const suture_parameter& parameter) {
  const auto number = object.number(parameter.name, limits_of(parameter));
  if (number && *number != std::trunc(*number)) {
    object.complain(parameter.name, "must be a whole number");
  }
  return number;
}

std::optional<double> read_parameter(ObjectReader& object, const suture_parameter& parameter) {
  switch (parameter.type) {
    case SUTURE_INTEGER:
      return read_integer(object, parameter);
    case SUTURE_BOOLEAN: {
      const auto value = object.boolean(parameter.name);
      return value ? std::optional(*value ? 1.0 : 0.0) : std::nullopt;
    }
    case SUTURE_CHOICE: {
      const std::vector<std::string> choices(parameter.choices,
                                             parameter.choices + parameter.choice_count);
      const auto index = object.choice(parameter.name, choices);
      return index ? std::optional(static_cast<double>(*index)) : std::nullopt;
    }
    default:
      return object.number(parameter.name, limits_of(parameter));
  }
}

void read_parameters(const JsonValue& value, const std::string& path, ModelUse& use,
                     Mistakes& mistakes) {
  ObjectReader object(value, path, mistakes);
  for (std::uint32_t i = 0; i < use.model->parameter_count; ++i) {
    const suture_parameter& parameter = use.model->parameters[i];
    if ((parameter.flags & SUTURE_REQUIRED) != 0)
      object.require(parameter.name, summary(parameter));
    if (read_parameter_values(object, parameter, use))
      use.parameters.push_back(std::numeric_limits<double>::quiet_NaN());
    else
      use.parameters.push_back(read_parameter(object, parameter).value_or(parameter.default_value));
  }
  object.finish();
}

const suture_model* look_up(ObjectReader& object, const std::string& id, Reading& reading) {
  try {
    return &reading.lookup.model(id);
  } catch (const PluginError& error) {
    const JsonValue* value = object.find("model");
    reading.mistakes.add_plugin(value->at, object.path_of("model"), error.what());
    return nullptr;
  }
}

bool is_taken(const Scene& scene, const std::string& name) {
  return std::any_of(scene.models.begin(), scene.models.end(),
                     [&](const ModelUse& use) { return use.name == name; });
}

// The model's id, "id-2", "id-3", ...: the first that is free.
std::string free_name(const Scene& scene, const std::string& id) {
  std::string name = id;
  for (int n = 2; is_taken(scene, name); ++n) name = id + "-" + std::to_string(n);
  return name;
}

std::string read_name(ObjectReader& object, const std::string& id, const Scene& scene) {
  const auto name = object.string("name");
  if (!name) return free_name(scene, id);
  if (!is_good_name(*name)) {
    object.complain("name",
                    "must consist of letters, digits, '_', '-' and '.', is " + quote(*name));
  } else if (is_taken(scene, *name)) {
    object.complain(
        "name", quote(*name) + " is already the name of an earlier model; names must be unique");
  }
  return *name;
}

/// Elements of a region or, of a model that acts on lips, two of them.
void read_region(ObjectReader& object, ModelUse& use, Mistakes& mistakes) {
  use.region.path = object.path_of("region");
  const JsonValue* const region = object.find("region");
  const JsonValue* const between = object.find("between");
  if (region != nullptr) use.region = read_selection(*region, use.region.path, mistakes);
  if (between != nullptr) use.between = read_two_regions(*between, object, "between");
  if (use.model == nullptr) return;
  if (!acts_on_lips(*use.model)) {
    if (between != nullptr)
      object.complain("between", "is for models that act between two regions; " + quote(use.name) +
                                     " acts in one, which \"region\" names");
    return;
  }
  object.require("between", "two selections of elements; the model acts where they meet");
  if (region != nullptr)
    object.complain("region", "is not allowed for a model that acts between two regions");
}

/// What the model does where earlier models are.
void read_overlap(ObjectReader& object, ModelUse& use, const Scene& scene) {
  use.adds = object.boolean("adds").value_or(false);
  if (object.find("over") == nullptr) return;
  std::vector<std::string> earlier;
  for (const ModelUse& other : scene.models)
    if (!other.between) earlier.push_back(other.name);
  if (earlier.empty())
    object.complain("over", "names no earlier model: this is the first one");
  else if (const auto place = object.choice("over", earlier))
    use.over = earlier[*place];
  if (use.adds) object.complain("adds", "contradicts 'over'; give one of them");
  if (use.between) object.complain("over", "is not allowed for a model between two regions");
}

void read_model(ObjectReader& object, Reading& reading) {
  ModelUse use;
  use.path = object.path();
  object.require("model", "the id of a model; 'suture models' lists them");
  const auto id = object.string("model");
  if (id) use.model = look_up(object, *id, reading);
  use.name = read_name(object, id.value_or(""), reading.scene);
  read_region(object, use, reading.mistakes);
  read_overlap(object, use, reading.scene);
  use.on_inversion = read_on_inversion(object);

  const JsonValue* parameters = object.find("parameters");
  JsonValue defaults;  // what an absent object stands for
  defaults.kind = JsonValue::Kind::object;
  defaults.at = object.at();
  if (use.model != nullptr) {
    read_parameters(parameters ? *parameters : defaults, object.path_of("parameters"), use,
                    reading.mistakes);
    read_start(object, use);
  } else {
    object.find("start");  // a known key, whatever the model is
  }
  reading.scene.models.push_back(std::move(use));
}

void read_plugins(ObjectReader& top, Reading& reading) {
  const JsonValue* value = top.find("plugins");
  if (value == nullptr) return;
  const auto* items = read_array(*value, "/plugins", "file names", reading.mistakes);
  if (items == nullptr) return;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const std::string path = child_path("/plugins", i);
    const auto name = read_string((*items)[i], path, reading.mistakes);
    if (!name) continue;
    try {
      reading.lookup.add_plugin((reading.folder / *name).lexically_normal());
    } catch (const PluginError& error) {
      reading.mistakes.add_plugin((*items)[i].at, path, error.what());
    }
  }
}

}  // namespace

void read_changes(ObjectReader& object, const suture_model& model, std::vector<double>& values) {
  for (std::uint32_t i = 0; i < model.parameter_count; ++i) {
    const suture_parameter& parameter = model.parameters[i];
    if (object.find(parameter.name) == nullptr) continue;
    if (std::isnan(values[i]))
      object.complain(parameter.name,
                      "is a direction, or given by an array or a table of the scene, and cannot be "
                      "changed during a run");
    else
      values[i] = read_parameter(object, parameter).value_or(values[i]);
  }
  object.finish();
}

void read_models(ObjectReader& top, Reading& reading) {
  read_plugins(top, reading);
  const JsonValue* models = top.require("models", "the models of the elements");
  for_each_object(top, "models", "models",
                  [&](ObjectReader& object) { read_model(object, reading); });
  if (models != nullptr && models->kind == JsonValue::Kind::array && models->items.empty()) {
    reading.mistakes.add(models->at, "/models", "is empty; at least one model is needed");
  }
}

}  // namespace suture::scene_parts
