// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/adjustable.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "kernel/forces/gravity.hpp"

namespace suture {
namespace {

using Json = nlohmann::json;

Json parameters_of(const Instance& instance) {
  const std::span declared(instance.model().parameters, instance.model().parameter_count);
  Json parameters = Json::array();
  for (std::size_t i = 0; i < declared.size(); ++i) {
    const suture_parameter& parameter = declared[i];
    const double value = instance.parameters()[i];
    if (parameter.type != SUTURE_NUMBER || std::isnan(value)) continue;
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"doc", parameter.doc},
                          {"value", value},
                          {"minimum", parameter.minimum},
                          {"maximum", parameter.maximum}});
  }
  return parameters;
}

}  // namespace

Json adjustable_values(Simulation& simulation) {
  Json models = Json::array();
  for (const auto& instance : simulation.attributes().instances())
    models.push_back({{"name", instance->name()}, {"parameters", parameters_of(*instance)}});
  return {{"gravity", simulation.built().gravity().value()}, {"models", models}};
}

}  // namespace suture
