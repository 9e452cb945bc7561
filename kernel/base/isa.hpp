// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace suture {

/// The best instruction set of plugin files that this processor runs: "avx512"
/// (x86-64-v4), "avx2" (x86-64-v3) or "" (the base line).
/// SUTURE_ISA=avx2|base in the environment lowers it, for tests; a value that it
/// does not know is a UsageError.
std::string_view best_isa();

/// 0 base line (""/"base"), 1 avx2, 2 avx512; -1 unknown.
int isa_rank(std::string_view isa);

}  // namespace suture
