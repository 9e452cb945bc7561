// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/bulk.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>

namespace suture {
namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;

}  // namespace

void prefer_large_pages(void* begin, std::size_t bytes) noexcept {
  const auto from = reinterpret_cast<std::uintptr_t>(begin), to = from + bytes;
  const std::uintptr_t first = (from + large_page - 1) / large_page * large_page;
  const std::uintptr_t last = to / large_page * large_page;
  // Where the system has none to give, nothing is lost.
  if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

void* allocate_bulk(std::size_t bytes, std::size_t alignment) {
  const bool large = bytes >= large_page / 2;
  const std::size_t multiple = large ? large_page : std::max(alignment, sizeof(void*));
  const std::size_t size = (bytes + multiple - 1) / multiple * multiple;
  void* const memory = std::aligned_alloc(multiple, size);
  if (!memory) throw std::bad_alloc();
  if (large) prefer_large_pages(memory, size);
  return memory;
}

}  // namespace suture
