// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/model_check/check_list.hpp"

namespace suture::checks {

// derivative_checks.cpp
Result gradient(const BatchCase&);
Result tangent(const BatchCase&);
Result single_tangent(const BatchCase&);
Result step_bounds(const BatchCase&);
// allocation_checks.cpp
Result no_allocation(const BatchCase&);
// output_checks.cpp
Result outputs(const BatchCase&);
Result lanes(const BatchCase&);
// input_checks.cpp
Result declared_inputs(const BatchCase&);
Result bad_states(const BatchCase&);
// balance_checks.cpp
Result balance(const BatchCase&);
Result translation(const BatchCase&);
Result objectivity(const BatchCase&);
// rate_checks.cpp
Result rates(const BatchCase&);
Result field_cut(const BodyCase&);
Result coupling(const BodyCase&);
// part_checks.cpp
Result patch(const BatchCase&);
// repeated_checks.cpp
Result repetition(const BatchCase&);
Result state(const BatchCase&);
Result order(const BatchCase&);
Result speed(const BatchCase&);
// body_checks.cpp
Result rest(const BodyCase&);
Result stiffness(const BodyCase&);
Result mass(const BodyCase&);
Result cut(const BodyCase&);
Result parameters(const BodyCase&);
// slope_checks.cpp
Result slopes(const BodyCase&);
// whole_checks.cpp
Result orientation(const BodyCase&);
Result shapes(const BodyCase&);
Result regions(const BodyCase&);
Result instances(const BodyCase&);
Result builds(const BodyCase&);

}  // namespace suture::checks
