// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <new>

namespace suture {

/// Thrown instead of std::bad_alloc where it is known what the memory was for. Allocates nothing.
class OutOfMemory : public std::bad_alloc {
 public:
  /// `what` needs the `bytes`.
  OutOfMemory(const char* what, double bytes) noexcept {
    std::snprintf(text_, sizeof text_, "%s needs %.0f MB", what, bytes / 1e6);
  }
  const char* what() const noexcept override { return text_; }

 private:
  char text_[160];
};

}  // namespace suture
