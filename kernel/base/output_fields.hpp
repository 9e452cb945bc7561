// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "suture/plugin.h"

namespace suture {

/// The fields of a functor's suture.output/1, in its order, as this host's structs: members that
/// the plugin does not have are 0. Empty without the extension.
std::vector<suture_field> output_fields(const suture_functor& functor);

}  // namespace suture
