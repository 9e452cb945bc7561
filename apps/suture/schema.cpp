// SPDX-License-Identifier: GPL-3.0-or-later
//
// A JSON schema (draft 2020-12) of scenes: scene_schema.json, with the parameters of all models and
// with what the tables of docs/scene-format.md say about each key. A table follows a line
// "<!-- keys of PLACE -->", where PLACE is "the scene", or the path of an object or a definition.
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <span>
#include <sstream>

#include "apps/suture/commands.hpp"
#include "kernel/base/error.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/scene/start_values.hpp"

namespace suture {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* scene_schema =
#include "scene_schema.inc"
    ;
constexpr const char* tables_of_keys =
#include "scene_keys.inc"
    ;

const Json a_vector = {{"$ref", "#/$defs/vector"}};
const Json cell_values = {{"$ref", "#/$defs/cell_values"}};

/// The schema of `key` in an object, an array of objects, or one of several kinds of value.
Json* find_key(Json& scene, Json& node, const std::string& key) {
  if (node.contains("properties") && node["properties"].contains(key))
    return &node["properties"][key];
  if (node.contains("$ref"))
    return find_key(scene, scene[Json::json_pointer(node["$ref"].get<std::string>().substr(1))],
                    key);
  if (node.contains("items")) return find_key(scene, node["items"], key);
  for (const char* kinds : {"anyOf", "oneOf"}) {
    if (!node.contains(kinds)) continue;
    for (Json& kind : node[kinds])
      if (Json* found = find_key(scene, kind, key)) return found;
  }
  return nullptr;
}

/// "events.grasp": the object, or array of objects, at this path of keys.
Json& object_at(Json& scene, const std::string& place) {
  if (place == "the scene") return scene;
  std::istringstream keys(place);
  std::string key;
  std::getline(keys, key, '.');
  Json* object = scene["$defs"].contains(key) ? &scene["$defs"][key] : find_key(scene, scene, key);
  while (object != nullptr && std::getline(keys, key, '.')) object = find_key(scene, *object, key);
  if (object == nullptr) throw InputError("the schema has no object '" + place + "'");
  return *object;
}

/// "| `end` | number > 0, s | none | meaning |": its cells without blanks around them and links.
std::vector<std::string> cells_of(const std::string& row) {
  static const std::regex link(R"(\[([^\]]*)\]\([^)]*\))"), cell(R"(\| *([^|]*[^| ])? *(?=\|))");
  const std::string text = std::regex_replace(row, link, "$1");
  std::vector<std::string> cells;
  for (std::sregex_iterator next(text.begin(), text.end(), cell), end; next != end; ++next)
    cells.push_back((*next)[1]);
  return cells;
}

/// "meaning (number > 0, s; default: none)".
std::string description_of(const std::vector<std::string>& cells) {
  std::string text = std::regex_replace(cells.back(), std::regex("; or$"), "");
  if (cells.size() < 3) return text;
  text += (text.empty() ? "(" : " (") + cells[1];
  if (cells.size() > 3 && !cells[2].empty())
    text += cells[2] == "required" ? "; required" : "; default: " + cells[2];
  return text + ")";
}

void describe_keys(Json& scene) {
  static const std::regex place("<!-- keys of (.*) -->"), word("`([a-z_]+)`");
  std::istringstream lines(tables_of_keys);
  Json* object = &scene;
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, match, place)) {
      object = &object_at(scene, match[1]);
      continue;
    }
    const std::vector<std::string> cells = cells_of(line);
    for (std::sregex_iterator key(cells[0].begin(), cells[0].end(), word), end; key != end; ++key) {
      Json* described = find_key(scene, *object, (*key)[1]);
      if (described == nullptr || described->contains("description"))
        throw InputError("the schema has no key, or describes it, too: " + line);
      (*described)["description"] = description_of(cells);
    }
  }
}

std::string doc_with_unit(const char* doc, const char* unit) {
  const std::string text = doc, of = unit;
  return of.empty() || of == "1" ? text : text + ", " + of;
}

Json number_schema(const suture_parameter& p) {
  Json schema = {{"type", p.type == SUTURE_INTEGER ? "integer" : "number"}};
  const auto limit = [&](const char* included, const char* excluded, std::uint32_t flag, double x) {
    if (std::isfinite(x)) schema[(p.flags & flag) != 0 ? excluded : included] = x;
  };
  limit("minimum", "exclusiveMinimum", SUTURE_MINIMUM_EXCLUDED, p.minimum);
  limit("maximum", "exclusiveMaximum", SUTURE_MAXIMUM_EXCLUDED, p.maximum);
  return schema;
}

Json type_schema(const suture_parameter& p) {
  if (p.type == SUTURE_BOOLEAN) return {{"type", "boolean"}};
  if (p.type == SUTURE_CHOICE)
    return {{"enum", std::vector<std::string>(p.choices, p.choices + p.choice_count)}};
  return p.type == SUTURE_DIRECTION ? a_vector : number_schema(p);
}

Json default_value_of(const suture_parameter& p) {
  if (p.type == SUTURE_BOOLEAN) return p.default_value != 0;
  if (p.type == SUTURE_CHOICE) return p.choices[static_cast<std::size_t>(p.default_value)];
  return p.default_value;
}

Json parameter_schema(const suture_parameter& p) {
  const bool varies = (p.flags & SUTURE_PER_ELEMENT) != 0;
  Json schema =
      varies ? Json{{"anyOf", Json::array({type_schema(p), cell_values})}} : type_schema(p);
  schema["description"] = doc_with_unit(p.doc, p.unit);
  if ((p.flags & SUTURE_REQUIRED) == 0) schema["default"] = default_value_of(p);
  return schema;
}

Json object_schema() {
  return {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
}

Json parameters_schema(const suture_model& model) {
  Json schema = object_schema(), required = Json::array();
  for (const suture_parameter& p : std::span(model.parameters, model.parameter_count)) {
    schema["properties"][p.name] = parameter_schema(p);
    if ((p.flags & SUTURE_REQUIRED) != 0) required.push_back(p.name);
  }
  if (!required.empty()) schema["required"] = required;
  return schema;
}

Json start_schema(const suture_model& model) {
  Json schema = object_schema();
  for (const suture_attribute& a : std::span(model.attributes, model.attribute_count))
    if (has_start(a))
      schema["properties"][a.name] = {{"description", doc_with_unit(a.doc, a.unit)}};
  return schema;
}

/// What an entry of /models with this model must be.
Json rule_of(const suture_model& model) {
  const Json parameters = parameters_schema(model);
  Json then = {{"properties", {{"parameters", parameters}, {"start", start_schema(model)}}}};
  if (parameters.contains("required")) then["required"] = {"parameters"};
  return {{"if", {{"properties", {{"model", {{"const", model.id}}}}}, {"required", {"model"}}}},
          {"then", then}};
}

std::set<std::string> ids_of(const PluginHost& host) {
  std::set<std::string> ids;
  for (const PluginHost::Listing& file : host.list())
    if (file.problem.empty()) ids.insert(file.models.begin(), file.models.end());
  return ids;
}

}  // namespace

int schema(const SchemaCommand&, Console& console) {
  PluginHost host(&console.diagnostics());
  Json scene = Json::parse(scene_schema), rules = Json::array(), known = Json::array();
  describe_keys(scene);
  for (const std::string& id : ids_of(host)) {
    try {
      const suture_model& model = host.model(id);
      rules.push_back(rule_of(model));
      known.push_back({{"const", id}, {"description", model.doc}});
    } catch (const PluginError& error) {
      console.diagnostics().warn("model '" + id + "' is left out: " + error.what());
    }
  }
  known.push_back({{"type", "string"}});  // of plugins that a scene names
  Json& entry = scene["$defs"]["model"];
  entry["properties"]["model"]["anyOf"] = known;
  entry["allOf"] = rules;
  console.print(scene.dump(1));
  return 0;
}

}  // namespace suture
