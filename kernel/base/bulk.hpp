// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace suture {

/// Asks the system for large pages (2 MiB) where these bytes hold whole ones that were
/// never touched. A page costs when it is first touched: 4 KiB 1.4 us, measured, and in
/// large pages a third of that; and a table of some MiB in few pages is found faster. Takes
/// no memory by itself. O(1), one call of the system if there is such a page.
void prefer_large_pages(void* begin, std::size_t bytes) noexcept;

/// Memory at a multiple of `alignment`; from 1 MiB on in large pages of its own.
void* allocate_bulk(std::size_t bytes, std::size_t alignment);

/// Allocator of arrays that are filled in one go: what resize() adds is not set, so it
/// must be written before it is read.
template <class T>
struct BulkAllocator {
  static_assert(std::is_trivially_copyable_v<T>);
  using value_type = T;
  BulkAllocator() = default;
  template <class U>
  BulkAllocator(const BulkAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)
  T* allocate(std::size_t n) { return static_cast<T*>(allocate_bulk(n * sizeof(T), alignof(T))); }
  void deallocate(T* p, std::size_t) noexcept { std::free(p); }
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

}  // namespace suture
