// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace suture {

/// The best instruction set of plugin files that this processor supports: "avx512" (x86-64-v4),
/// "avx2" (x86-64-v3) or "" (the baseline). The environment variable SUTURE_ISA=avx2|base lowers
/// it, for tests; an unknown value is a UsageError.
std::string_view best_isa();

/// 0 baseline (""/"base"), 1 avx2, 2 avx512; -1 unknown.
int isa_rank(std::string_view isa);

}  // namespace suture
