// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/scene/json_document.hpp"

namespace suture {

/// Applies "--set /solver/dt=1e-4", the `number`-th one (from 1): the left side is a JSON pointer
/// (RFC 6901; "-" appends to an array), the right side JSON, or a string if it is not valid JSON.
/// Missing keys are created, so that values left at their defaults can be set; unknown keys are
/// refused by the reader. Throws UsageError if there is no '=', if the pointer does not start with
/// '/', or if it leads through a value that has no such child.
void apply_override(JsonValue& root, const std::string& text, std::uint32_t number);

}  // namespace suture
