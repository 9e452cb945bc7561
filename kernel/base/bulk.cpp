// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/bulk.hpp"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <span>
#include <utility>

#if defined(__SANITIZE_ADDRESS__)
#define SUTURE_WATCHES_MEMORY 1
#elif defined(__has_feature)
#define SUTURE_WATCHES_MEMORY __has_feature(address_sanitizer)
#else
#define SUTURE_WATCHES_MEMORY 0
#endif

namespace suture {
namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;

/// Blocks that were released, with the pages that they have. Two thirds of a large cut were the
/// system's time for fresh pages: every cut got new memory for its change and returned it.
class SpareBlocks {
 public:
  static constexpr std::size_t least = std::size_t{64} << 10;
  /// None where AddressSanitizer would not see that they are used after their release.
  static constexpr std::size_t max_kept = SUTURE_WATCHES_MEMORY ? 0 : std::size_t{128} << 20;

  /// The smallest one that fits, unless most of it would be unused; null if there is none.
  void* take(std::size_t bytes, std::size_t multiple) {
    const std::lock_guard lock(mutex_);
    Block* best = nullptr;
    for (Block& block : std::span(blocks_).first(count_)) {
      const bool fits = block.bytes >= bytes && block.bytes / 4 <= bytes &&
                        reinterpret_cast<std::uintptr_t>(block.memory) % multiple == 0;
      if (fits && (!best || block.bytes < best->bytes)) best = &block;
    }
    if (!best) return nullptr;
    void* const memory = best->memory;
    kept_ -= best->bytes;
    *best = blocks_[--count_];
    return memory;
  }

  /// Keeps a block, and returns one that is to be released: null, the smallest, or this one.
  void* keep(void* memory, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (kept_ + bytes > max_kept) return memory;
    if (count_ < blocks_.size()) {
      blocks_[count_++] = {memory, bytes};
      kept_ += bytes;
      return nullptr;
    }
    Block& smallest = *std::ranges::min_element(blocks_, {}, &Block::bytes);
    if (smallest.bytes >= bytes) return memory;
    const Block released = std::exchange(smallest, {memory, bytes});
    kept_ += bytes - released.bytes;
    return released.memory;
  }

  /// Releases all; false if there was none.
  bool release() {
    const std::lock_guard lock(mutex_);
    const bool had_any = count_ != 0;
    for (; count_ != 0; --count_) std::free(blocks_[count_ - 1].memory);
    kept_ = 0;
    return had_any;
  }

 private:
  struct Block {
    void* memory = nullptr;
    std::size_t bytes = 0;
  };
  std::mutex mutex_;
  std::array<Block, 32> blocks_;
  std::size_t count_ = 0, kept_ = 0;
};

/// Never destroyed: objects with static storage may release blocks after it.
SpareBlocks& spare_blocks() {
  static SpareBlocks& blocks = *new SpareBlocks;
  return blocks;
}

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
  if (size >= SpareBlocks::least)
    if (void* const spare = spare_blocks().take(size, multiple)) return spare;
  void* memory = std::aligned_alloc(multiple, size);
  if (!memory && spare_blocks().release()) memory = std::aligned_alloc(multiple, size);
  if (!memory) throw std::bad_alloc();
  if (large) prefer_large_pages(memory, size);
  return memory;
}

void release_bulk(void* block) noexcept {
  const std::size_t bytes = malloc_usable_size(block);
  std::free(bytes < SpareBlocks::least ? block : spare_blocks().keep(block, bytes));
}

void release_spare_bulk() noexcept { spare_blocks().release(); }

namespace {

/// malloc may have used its memory for smaller blocks before, and would have to clear it.
bool is_mapped(std::size_t bytes) { return bytes >= large_page / 2; }

constexpr std::align_val_t zeroed_alignment{64};

}  // namespace

void* allocate_zeroed(std::size_t bytes) {
  if (!is_mapped(bytes)) return std::memset(::operator new(bytes, zeroed_alignment), 0, bytes);
  void* const memory =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return memory;
}

void release_zeroed(void* block, std::size_t bytes) noexcept {
  if (is_mapped(bytes))
    munmap(block, bytes);
  else
    ::operator delete(block, zeroed_alignment);
}

void clear_pages(void* begin, std::size_t bytes) noexcept {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto clear = [](std::uintptr_t from, std::uintptr_t to) {
    std::memset(reinterpret_cast<void*>(from), 0, to - from);
  };
  const auto from = reinterpret_cast<std::uintptr_t>(begin), to = from + bytes;
  const std::uintptr_t first = (from + page - 1) / page * page, last = to / page * page;
  if (first >= last) return clear(from, to);
  clear(from, first);
  clear(last, to);
  // The system may refuse, as for locked pages.
  if (madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED) != 0) clear(first, last);
}

void touch_pages(void* begin, std::size_t bytes) noexcept {
  constexpr std::size_t page = 4096;
  volatile char* const memory = static_cast<char*>(begin);
  for (std::size_t at = 0; at < bytes; at += page) memory[at] = 0;
  if (bytes != 0) memory[bytes - 1] = 0;
}

}  // namespace suture
