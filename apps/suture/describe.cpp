// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdio>

#include "apps/suture/commands.hpp"
#include "kernel/plugin_host/output_fields.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/plugin_host/table_check.hpp"

namespace suture {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string with_unit(const std::string& text, const char* unit) {
  return std::string(unit) == "1" || *unit == 0 ? text : text + " " + unit;
}

std::string default_of(const suture_parameter& parameter) {
  if ((parameter.flags & SUTURE_REQUIRED) != 0) return "required";
  if (parameter.type == SUTURE_BOOLEAN) {
    return parameter.default_value != 0 ? "default true" : "default false";
  }
  if (parameter.type == SUTURE_CHOICE) {
    return std::string("default \"") +
           parameter.choices[static_cast<std::size_t>(parameter.default_value)] + "\"";
  }
  return "default " + with_unit(number(parameter.default_value), parameter.unit);
}

std::string range_of(const suture_parameter& parameter) {
  if (parameter.type == SUTURE_BOOLEAN) return "true or false";
  if (parameter.type == SUTURE_DIRECTION) return "direction [x, y, z]";
  if (parameter.type == SUTURE_CHOICE) {
    std::string choices;
    for (std::uint32_t i = 0; i < parameter.choice_count; ++i) {
      choices += (i == 0 ? "\"" : ", \"") + std::string(parameter.choices[i]) + "\"";
    }
    return "one of " + choices;
  }
  std::string range = parameter.type == SUTURE_INTEGER ? "whole number" : "number";
  if (std::isfinite(parameter.minimum)) {
    range += (parameter.flags & SUTURE_MINIMUM_EXCLUDED) != 0 ? " > " : " >= ";
    range += number(parameter.minimum);
  }
  if (std::isfinite(parameter.maximum)) {
    range += std::isfinite(parameter.minimum) ? " and" : "";
    range += (parameter.flags & SUTURE_MAXIMUM_EXCLUDED) != 0 ? " < " : " <= ";
    range += number(parameter.maximum);
  }
  return range;
}

void print_parameters(const suture_model& model, Console& console) {
  console.print("\nparameters");
  for (std::uint32_t i = 0; i < model.parameter_count; ++i) {
    const suture_parameter& parameter = model.parameters[i];
    console.print("  " + with_unit(parameter.name, parameter.unit) + ": " + parameter.doc);
    const bool varies = (parameter.flags & SUTURE_PER_ELEMENT) != 0;
    console.print("      " + range_of(parameter) + "; " + default_of(parameter) +
                  (varies ? "; may differ from element to element" : ""));
  }
}

void print_attributes(const suture_model& model, Console& console) {
  constexpr const char* cells[] = {"vertices", "edges", "faces", "elements"};
  constexpr const char* policies[] = {"copied", "zero for a new cell", "shared by volume",
                                      "recomputed from the elements"};
  constexpr std::uint32_t unlisted = SUTURE_INTERNAL | SUTURE_PARAMETER;
  bool first = true;
  for (std::uint32_t i = 0; i < model.attribute_count; ++i) {
    const suture_attribute& attribute = model.attributes[i];
    if ((attribute.flags & unlisted) != 0) continue;
    if (first) console.print("\nattributes");
    first = false;
    console.print("  " + with_unit(attribute.name, attribute.unit) + " on " +
                  cells[attribute.dimension] + ": " + attribute.doc);
    console.print(std::string("      when its cell splits: ") + policies[attribute.policy]);
    if (!has_range(attribute)) continue;
    suture_parameter limits{};
    limits.minimum = attribute.minimum;
    limits.maximum = attribute.maximum;
    console.print("      conditions of a scene: " + range_of(limits));
  }
}

void print_functors(const suture_model& model, Console& console) {
  constexpr const char* cells[] = {"vertices", "edges", "faces", "elements"};
  console.print("\nforces");
  for (std::uint32_t i = 0; i < model.functor_count; ++i) {
    const suture_functor& functor = model.functors[i];
    console.print(std::string("  ") + functor.name + " on " + cells[functor.dimension] + ": " +
                  functor.doc);
    for (const suture_field& field : output_fields(functor))
      console.print("      field " + with_unit(field.name, field.unit) + ": " + field.doc);
  }
}

}  // namespace

int describe(const DescribeCommand& command, Console& console) {
  PluginHost host(&console.diagnostics());
  const suture_model& model = host.model(command.model);
  const suture_plugin& plugin = host.plugin_of(model);
  console.print(std::string(model.id) + ": " + model.doc);
  console.print("\n" + std::string(model.formula));
  console.print("\nsource: " + std::string(model.citation));
  print_parameters(model, console);
  print_attributes(model, console);
  print_functors(model, console);
  console.print("\nplugin " + std::string(plugin.id) + " " + plugin.version + " (" +
                plugin.license + "), " + host.file_of(model).string());
  return 0;
}

}  // namespace suture
