// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "suture/parts.h"
#include "suture/plugin.h"
#include "suture/single.h"

namespace suture {

/// The extensions that this host requests from plugins: suture_host.has_extension answers from this
/// list, and a plugin may list these under required_extensions. An id is added here together with
/// the code that uses it.
inline constexpr std::array<std::string_view, 8> host_extensions{
    SUTURE_ENERGY_1, SUTURE_STABLE_DT_1, SUTURE_TANGENT_1, SUTURE_TANGENT_SINGLE_1,
    SUTURE_OUTPUT_1, SUTURE_INSPECT_1,   SUTURE_PARTS_1,   SUTURE_DISSIPATION_1};

inline bool host_has_extension(std::string_view id) {
  return std::find(host_extensions.begin(), host_extensions.end(), id) != host_extensions.end();
}

}  // namespace suture
