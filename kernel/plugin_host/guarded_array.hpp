// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace suture {

/// Memory that a plugin writes, between pages that cannot be accessed:
///
///   | no access, 1 MB | unused | doubles | no access, 1 MB |
///
/// The doubles end where the inaccessible pages begin, so a plugin that writes past the end of the
/// array is stopped there, before it damages the memory of the host, and the message names the
/// array (find_guarded). Making one takes some microseconds and a page; accessing it costs nothing.
class GuardedArray {
 public:
  /// For messages, and as long as the array: `name`, such as "force", and `advice`, the end of a
  /// message about an access outside. `size`: doubles, a multiple of 8, so that the beginning is
  /// aligned to 64 bytes. All are zero. `margin`: doubles on either side that are accessible, too,
  /// a multiple of 8. Throws std::bad_alloc.
  GuardedArray(const char* name, const char* advice, std::size_t size, std::size_t margin = 0);
  ~GuardedArray();
  GuardedArray(GuardedArray&& other) noexcept;
  GuardedArray& operator=(GuardedArray&&) = delete;

  double* data() const { return data_; }
  double* end() const { return data_ + size_; }
  std::size_t size() const { return size_; }

  struct Entry;

 private:
  double* data_;
  std::size_t size_;
  Entry* entry_;
};

/// Where an address lies in or around an array.
struct GuardHit {
  const char* name = nullptr;  ///< null: nowhere near an array
  const char* advice = nullptr;
  bool is_past_end = false;  ///< otherwise before the beginning
  /// Doubles: 1 is the first one past the end, or before the beginning; 0 lies between the
  /// guards, where an access fails only if a plugin has changed the protection of the page.
  std::size_t distance = 0;
};
/// Safe in signal handlers.
GuardHit find_guarded(const void* address);

}  // namespace suture
