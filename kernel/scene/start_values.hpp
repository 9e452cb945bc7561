// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "suture/plugin.h"

namespace suture {

/// Whether a scene may set an attribute at the start of a run.
inline bool has_start(const suture_attribute& attribute) {
  constexpr std::uint32_t own =
      SUTURE_PARAMETER | SUTURE_INTERNAL | SUTURE_SHARED_MASS | SUTURE_FIELD;
  return attribute.policy != SUTURE_FROM_VOLUMES && (attribute.flags & own) == 0;
}

}  // namespace suture
