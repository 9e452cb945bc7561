// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/guarded_array.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <new>
#include <utility>

namespace suture {

/// The place of a mapping, which signal handlers look up. Entries are reused, but never freed.
struct GuardedArray::Entry {
  std::atomic<bool> in_use = true;
  std::atomic<std::uintptr_t> mapping = 0, mapping_end = 0, data = 0, data_end = 0;
  std::atomic<const char*> name = nullptr, advice = nullptr;
  Entry* next = nullptr;
};

namespace {

constexpr std::size_t guard_bytes = std::size_t{1} << 20;
std::atomic<GuardedArray::Entry*> entries = nullptr;

GuardedArray::Entry& free_entry() {
  for (auto* entry = entries.load(); entry != nullptr; entry = entry->next) {
    bool expected = false;
    if (entry->in_use.compare_exchange_strong(expected, true)) return *entry;
  }
  auto* added = new GuardedArray::Entry;
  added->next = entries.load();
  while (!entries.compare_exchange_weak(added->next, added)) continue;
  return *added;
}

std::uintptr_t number(const void* address) { return reinterpret_cast<std::uintptr_t>(address); }

}  // namespace

GuardedArray::GuardedArray(const char* name, const char* advice, std::size_t size,
                           std::size_t margin)
    : size_(size), entry_(&free_entry()) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t bytes = (size + margin) * sizeof(double);
  const std::size_t used = (bytes + margin * sizeof(double) + page - 1) / page * page;
  const std::size_t all = used + 2 * guard_bytes;
  constexpr int flags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void* const mapping = mmap(nullptr, all, PROT_NONE, flags, -1, 0);
  std::byte* const begin = static_cast<std::byte*>(mapping) + guard_bytes;
  if (mapping == MAP_FAILED || mprotect(begin, used, PROT_READ | PROT_WRITE) != 0) {
    if (mapping != MAP_FAILED) munmap(mapping, all);
    entry_->in_use = false;
    throw std::bad_alloc();
  }
  data_ = reinterpret_cast<double*>(begin + used - bytes);
  entry_->name = name;
  entry_->advice = advice;
  entry_->data = number(data_);
  entry_->data_end = number(data_ + size_);
  entry_->mapping = number(mapping);
  entry_->mapping_end = number(mapping) + all;
}

GuardedArray::GuardedArray(GuardedArray&& other) noexcept
    : data_(other.data_), size_(other.size_), entry_(std::exchange(other.entry_, nullptr)) {}

GuardedArray::~GuardedArray() {
  if (entry_ == nullptr) return;
  const std::uintptr_t begin = entry_->mapping, end = entry_->mapping_end;
  entry_->mapping_end = 0;
  munmap(reinterpret_cast<void*>(begin), end - begin);  // NOLINT: a number since the constructor
  entry_->in_use = false;
}

GuardHit find_guarded(const void* address) {
  const std::uintptr_t at = number(address);
  for (const auto* entry = entries.load(); entry != nullptr; entry = entry->next) {
    if (at < entry->mapping || at >= entry->mapping_end) continue;
    const std::uintptr_t begin = entry->data, end = entry->data_end;
    const bool is_accessible =
        at >= entry->mapping + guard_bytes && at < entry->mapping_end - guard_bytes;
    if (is_accessible) return {entry->name, entry->advice, false, 0};
    const bool is_past_end = at >= end;
    constexpr std::size_t one = sizeof(double);
    const std::size_t distance = is_past_end ? (at - end) / one + 1 : (begin - at + one - 1) / one;
    return {entry->name, entry->advice, is_past_end, distance};
  }
  return {};
}

}  // namespace suture
