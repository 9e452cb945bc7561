// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/isa.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"

namespace suture {
namespace {

constexpr std::array<std::string_view, 3> isa_names{"", "avx2", "avx512"};

/// The builtin asks the operating system too (XGETBV): registers that are not
/// saved on a context switch do not count.
int processor_rank() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl");
  return v4 ? 2 : v3 ? 1 : 0;
#else
  return 0;
#endif
}

}  // namespace

int isa_rank(std::string_view isa) {
  if (isa == "base") return 0;
  const auto at = std::find(isa_names.begin(), isa_names.end(), isa);
  return at == isa_names.end() ? -1 : static_cast<int>(at - isa_names.begin());
}

std::string_view best_isa() {
  int rank = processor_rank();
  if (const char* wanted = std::getenv("SUTURE_ISA"); wanted != nullptr && *wanted != '\0') {
    const int limit = isa_rank(wanted);
    if (limit < 0)
      throw UsageError("the environment variable SUTURE_ISA is " + quote(wanted) +
                       "; set it to avx512, avx2 or base, or unset it");
    rank = std::min(rank, limit);
  }
  return isa_names[static_cast<std::size_t>(rank)];
}

}  // namespace suture
