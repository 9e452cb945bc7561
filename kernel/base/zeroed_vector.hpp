// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "kernel/base/bulk.hpp"

namespace suture {

/// Allocator of 64-byte aligned memory that is 0, for arrays of which a process may use a part:
/// pages of a large array take memory only where they are written. resize() writes nothing: new
/// items are 0 where the vector had none before. One that has become shorter keeps what was
/// there: clear it behind its end before it grows again, or write all new items.
template <class T>
struct ZeroedAllocator {
  static_assert(std::is_arithmetic_v<T>);
  using value_type = T;
  ZeroedAllocator() = default;
  template <class U>
  ZeroedAllocator(const ZeroedAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)
  T* allocate(std::size_t n) { return static_cast<T*>(allocate_zeroed(n * sizeof(T))); }
  void deallocate(T* items, std::size_t n) noexcept { release_zeroed(items, n * sizeof(T)); }
  void construct(T*) noexcept {}
  template <class... Arguments>
  void construct(T* item, Arguments&&... arguments) {
    ::new (static_cast<void*>(item)) T(std::forward<Arguments>(arguments)...);
  }
  friend bool operator==(const ZeroedAllocator&, const ZeroedAllocator&) { return true; }
};

template <class T>
using ZeroedVector = std::vector<T, ZeroedAllocator<T>>;

}  // namespace suture
