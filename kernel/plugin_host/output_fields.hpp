// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "suture/plugin.h"

namespace suture {

/// The fields of a functor's suture.output/1, in its order, as this host's structs: members that
/// the plugin does not have are 0. Empty without the extension.
std::vector<suture_field> output_fields(const suture_functor& functor);

/// Whether users see this attribute in frames and probes.
inline bool is_shown(const suture_attribute& attribute) {
  return (attribute.flags & SUTURE_FIELD) != 0 ||
         (attribute.flags & (SUTURE_OUTPUT | SUTURE_SHARED_MASS)) == SUTURE_OUTPUT;
}

/// Whether the model shows such a field: an output field of a functor, or an attribute.
bool provides_field(const suture_model& model, std::uint32_t dimension, std::string_view name,
                    std::uint32_t components);

}  // namespace suture
