// SPDX-License-Identifier: GPL-3.0-or-later
//
// Operations of an event besides cuts: pierce, tear, suture, remove_islands.
#include <algorithm>
#include <array>

#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/plugin_host/output_fields.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

std::optional<Selection> optional_selection(ObjectReader& object, const std::string& key) {
  const JsonValue* value = object.find(key);
  if (value == nullptr) return {};
  return read_selection(*value, object.path_of(key), object.mistakes());
}

// One number per edge or element, or a field on vertices: what tearing can compare with a
// threshold.
std::vector<std::string> scalar_fields(const suture_model& model) {
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < model.functor_count; ++i) {
    const suture_functor& functor = model.functors[i];
    const bool fits = functor.dimension == 1 || functor.dimension == 3;
    if (!fits) continue;
    for (const suture_field& field : output_fields(functor))
      if (field.components == 1) names.emplace_back(field.name);
  }
  for (const suture_attribute& a : std::span(model.attributes, model.attribute_count))
    if ((a.flags & SUTURE_FIELD) != 0 && a.components == 1) names.emplace_back(a.name);
  return names;
}

// {"model": NAME, "field": NAME}: the name of an instance, or its model's id if that
// is meant for one only.
void read_field(ObjectReader by, Tear& tear, Reading& reading) {
  by.require("model", "the name of a model of this scene");
  by.require("field", "the name of a scalar field that the model declares");
  tear.by = Tear::By::field;
  tear.model = by.string("model").value_or("");
  tear.field = by.string("field").value_or("");
  std::vector<std::string> names;
  for (const ModelUse& use : reading.scene.models) names.push_back(use.name);
  const auto use = std::find(names.begin(), names.end(), tear.model);
  if (use == names.end() && by.find("model") != nullptr) {
    by.complain("model", "no model of this scene is named " + quote(tear.model) +
                             did_you_mean(tear.model, names));
  } else if (use != names.end() && by.find("field") != nullptr) {
    const auto* model = reading.scene.models[static_cast<std::size_t>(use - names.begin())].model;
    const auto fields = model == nullptr ? std::vector{tear.field} : scalar_fields(*model);
    if (std::find(fields.begin(), fields.end(), tear.field) == fields.end()) {
      std::string text = quote(tear.model) + " has no scalar field " + quote(tear.field) +
                         " on its elements, edges or vertices" + did_you_mean(tear.field, fields);
      for (std::size_t i = 0; i < fields.size(); ++i) text += (i ? ", " : "; it has ") + fields[i];
      by.complain("field", text);
    }
  }
  by.finish();
}

void read_by(ObjectReader& tear, Tear& result, Reading& reading) {
  const JsonValue* by =
      tear.require("by", "\"principal-strain\", \"elongation\" or {\"model\", \"field\"}");
  if (by == nullptr) return;
  if (by->kind == JsonValue::Kind::object) {
    read_field({*by, tear.path_of("by"), tear.mistakes()}, result, reading);
    return;
  }
  static const std::array<std::string, 2> kinds{"principal-strain", "elongation"};
  if (tear.choice("by", kinds) == 1u) result.by = Tear::By::elongation;
}

}  // namespace

Pierce read_pierce(ObjectReader pierce) {
  Pierce result;
  static const std::array<std::string, 2> kinds{"where", "path"};
  const auto kind = pierce.one_of(kinds);
  if (kind == 0u) result.where = optional_selection(pierce, "where");
  if (kind == 1u) {
    result.path = read_points(*pierce.find("path"), pierce.path_of("path"), 2, pierce.mistakes());
    pierce.require("radius",
                   "the largest distance from the path to the centroid of a removed element, in m");
  } else if (pierce.find("radius") != nullptr) {
    pierce.complain("radius", "is only allowed with 'path'");
  }
  result.radius = pierce.number("radius", Limits::positive("m")).value_or(0);
  pierce.finish();
  return result;
}

Tear read_tear(ObjectReader tear, Reading& reading) {
  Tear result;
  read_by(tear, result, reading);
  tear.require("above", "the threshold");
  const bool strain = result.by != Tear::By::field;
  result.above = tear.number("above", strain ? Limits::positive("1") : Limits::any("")).value_or(1);
  result.where = optional_selection(tear, "where");
  result.max_fraction =
      tear.number("most", Limits{"1", 0, 1, true, false}).value_or(result.max_fraction);
  tear.finish();
  return result;
}

SewFaces read_suture(ObjectReader suture) {
  SewFaces result;
  int given = 0;
  if (const JsonValue* faces = suture.find("faces")) {
    ++given;
    result.element_pairs = read_pairs(*faces, suture.path_of("faces"), suture.mistakes());
  }
  if (const JsonValue* between = suture.find("between")) {
    ++given;
    result.between = read_two_regions(*between, suture, "between");
    suture.require("gap", "the largest distance between corners, in m");
  } else if (suture.find("gap") != nullptr) {
    suture.complain("gap", "is only allowed with 'between'");
  }
  result.gap = suture.number("gap", Limits::positive("m")).value_or(0);
  if (suture.find("where") != nullptr) ++given;
  result.where = optional_selection(suture, "where");
  if (given > 1) suture.complain("must have at most one of 'faces', 'between' and 'where'");
  suture.finish();
  return result;
}

RemoveIslands read_remove_islands(ObjectReader remove) {
  RemoveIslands result;
  result.below = remove.natural("below", 1).value_or(0);
  result.volume = remove.number("volume", Limits::positive("m^3")).value_or(0);
  if (const JsonValue* outside = remove.find("outside")) {
    ObjectReader region(*outside, remove.path_of("outside"), remove.mistakes());
    if (const JsonValue* box = region.require("box", "the region of interest {\"min\", \"max\"}"))
      result.outside = read_box({*box, region.path_of("box"), remove.mistakes()});
    region.finish();
  }
  if (remove.is_object() && remove.find("below") == nullptr && remove.find("outside") == nullptr &&
      remove.find("volume") == nullptr)
    remove.complain("must have 'below' (elements), 'volume' (m^3) or 'outside' (a region)");
  remove.finish();
  return result;
}

}  // namespace suture::scene_parts
