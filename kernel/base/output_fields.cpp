// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/output_fields.hpp"

#include <algorithm>
#include <cstring>

#include "kernel/base/plugin_call.hpp"

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

}  // namespace suture
