// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "kernel/run/simulation.hpp"

namespace suture {

/// What a page may change, with its values now: {"gravity": [x, y, z], "models": [{"name",
/// "parameters": [{"name", "unit", "doc", "value", "minimum", "maximum"}]}]}. The parameters are
/// the numbers that are the same in all elements of a model.
nlohmann::json adjustable_values(Simulation& simulation);

}  // namespace suture
