// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace suture {

/// Requests large pages (2 MiB) from the system for those parts of the range that contain whole
/// untouched pages. The first access to a page is expensive: 1.4 us per 4 KiB (measured), a third
/// of that in large pages; and address translation is faster for a table of some MiB in few pages.
/// Allocates no memory by itself. O(1), with one system call if there is such a page.
void prefer_large_pages(void* begin, std::size_t bytes) noexcept;

/// Allocates memory at a multiple of `alignment`; blocks of 1 MiB or more get their own large
/// pages. Blocks of 64 KiB or more are those that were released, if one fits: its pages need not
/// be cleared again.
void* allocate_bulk(std::size_t bytes, std::size_t alignment);

/// Releases memory of allocate_bulk(). Keeps up to 128 MiB for later calls, but for
/// AddressSanitizer.
void release_bulk(void* block) noexcept;

/// Returns what is kept to malloc. A failing allocate_bulk() does so, too.
void release_spare_bulk() noexcept;

/// 64-byte aligned memory that is 0. Where it is large, its pages take memory when they are
/// written. To be released with the same size.
void* allocate_zeroed(std::size_t bytes);
void release_zeroed(void* block, std::size_t bytes) noexcept;

/// The contents of a range become 0, and the memory of its whole pages returns to the system.
void clear_pages(void* begin, std::size_t bytes) noexcept;

/// Writes 0 at the start of each page of a range, whose contents do not matter or are 0.
void touch_pages(void* begin, std::size_t bytes) noexcept;

/// Allocator for arrays that are filled in one go: resize() leaves new elements uninitialised, so
/// they must be written before they are read.
template <class T>
struct BulkAllocator {
  static_assert(std::is_trivially_copyable_v<T>);
  using value_type = T;
  BulkAllocator() = default;
  template <class U>
  BulkAllocator(const BulkAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)
  T* allocate(std::size_t n) { return static_cast<T*>(allocate_bulk(n * sizeof(T), alignof(T))); }
  void deallocate(T* p, std::size_t) noexcept { release_bulk(p); }
  template <class U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Arguments>
  void construct(U* p, Arguments&&... arguments) {
    ::new (static_cast<void*>(p)) U(std::forward<Arguments>(arguments)...);
  }
  friend bool operator==(const BulkAllocator&, const BulkAllocator&) { return true; }
};

template <class T>
using BulkVector = std::vector<T, BulkAllocator<T>>;

/// Reserves room for `more` items and touches its pages: appending the items then neither copies
/// nor waits for the system. Items are trivially copyable. O(more).
template <class Vector>
void make_room(Vector& items, std::size_t more) {
  static_assert(std::is_trivially_copyable_v<typename Vector::value_type>);
  items.reserve(items.size() + more);
  touch_pages(items.data() + items.size(), more * sizeof(typename Vector::value_type));
}

}  // namespace suture
