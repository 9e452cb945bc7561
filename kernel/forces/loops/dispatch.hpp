// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "kernel/forces/loops/loops.hpp"

namespace suture {

/// The loops for an instruction set: "avx512", "avx2" or "" (part of the program);
/// loads the module at the first call. Throws IoError if the module is missing.
const loops::Table& hot_loops(std::string_view isa);

/// The loops for the best instruction set of this processor (best_isa()).
const loops::Table& hot_loops();

}  // namespace suture
