// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

namespace suture::test {

/// The sanitizer of this build: "address", "thread" or "".
inline constexpr std::string_view sanitizer = SUTURE_SANITIZER;

/// Numbers of threads that must give the same bits. ThreadSanitizer sees a race with any above one.
inline std::vector<unsigned> thread_counts() {
  if (sanitizer == "thread") return {1, 3};
  return {1, 2, 3, 8};
}

}  // namespace suture::test
