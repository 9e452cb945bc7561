// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/output_fields.hpp"

#include <algorithm>
#include <cstring>

#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {

std::vector<suture_field> output_fields(const suture_functor& functor) {
  const auto* output = extension_of<suture_output_1>(functor, SUTURE_OUTPUT_1);
  if (output == nullptr || output->field_count == 0) return {};
  std::vector<suture_field> fields(output->field_count);
  const std::size_t size = output->fields->size;  // what the entries are apart
  const char* place = reinterpret_cast<const char*>(output->fields);
  for (suture_field& field : fields) {
    std::memcpy(&field, place, std::min(size, sizeof field));
    place += size;
  }
  return fields;
}

bool provides_field(const suture_model& model, std::uint32_t dimension, std::string_view name,
                    std::uint32_t components) {
  const auto matches = [&](const auto& field) {
    return field.name == name && field.components == components;
  };
  const auto computes = [&](const suture_functor& functor) {
    return functor.dimension == dimension && std::ranges::any_of(output_fields(functor), matches);
  };
  const auto stores = [&](const suture_attribute& attribute) {
    return attribute.dimension == dimension && is_shown(attribute) && matches(attribute);
  };
  return std::ranges::any_of(std::span(model.functors, model.functor_count), computes) ||
         std::ranges::any_of(std::span(model.attributes, model.attribute_count), stores);
}

}  // namespace suture
