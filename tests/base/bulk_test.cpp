// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/bulk.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <numeric>

#include "kernel/base/zeroed_vector.hpp"
#include "tests/base/sanitizer.hpp"

namespace suture {
namespace {

bool is_aligned(const void* p, std::size_t alignment) {
  return reinterpret_cast<std::uintptr_t>(p) % alignment == 0;
}

TEST(Bulk, MemoryIsAlignedAndLargePagesWhereItIsLarge) {
  constexpr std::size_t large_page = std::size_t{2} << 20;
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{100}, large_page / 2 - 1}) {
    void* const memory = allocate_bulk(bytes, 64);
    EXPECT_TRUE(is_aligned(memory, 64)) << bytes;
    release_bulk(memory);
  }
  for (const std::size_t bytes : {large_page / 2, large_page, 3 * large_page + 5}) {
    void* const memory = allocate_bulk(bytes, 4);
    EXPECT_TRUE(is_aligned(memory, large_page)) << bytes;
    release_bulk(memory);
  }
}

TEST(Bulk, VectorsKeepTheirItemsWhenTheyGrowPastThePage) {
  BulkVector<std::uint32_t> grown;
  for (std::uint32_t i = 0; i < 1'000'000; ++i) grown.push_back(i);
  const std::size_t end = grown.size();
  grown.resize(2 * end);  // sets nothing, so neither does it disturb anything
  std::iota(grown.begin() + static_cast<std::ptrdiff_t>(end), grown.end(), 1'000'000u);
  for (std::uint32_t i = 0; i < grown.size(); ++i) ASSERT_EQ(grown[i], i);
}

TEST(Bulk, PagesThatWereWrittenKeepWhatTheyHold) {
  std::vector<std::uint32_t> written(3'000'000);
  std::iota(written.begin(), written.end(), 7u);
  prefer_large_pages(written.data(), written.size() * sizeof(written[0]));
  prefer_large_pages(written.data() + 1, 12);  // holds no page
  for (std::uint32_t i = 0; i < written.size(); ++i) ASSERT_EQ(written[i], i + 7);
}

TEST(Bulk, ReleasedBlocksServeAgainIfTheyFit) {
  constexpr std::size_t size = std::size_t{400} << 10;
  void* const first = allocate_bulk(size, 64);
  release_bulk(first);
  void* const second = allocate_bulk(size - 100, 64);
  if (test::sanitizer == "address") {
    EXPECT_NE(second, first) << "a use after release would not be seen";
    return release_bulk(second);
  }
  EXPECT_EQ(second, first);
  void* const larger = allocate_bulk(4 * size, 64);
  EXPECT_NE(larger, first);
  release_bulk(second);
  void* const smaller = allocate_bulk(size / 5, 64);
  EXPECT_NE(smaller, first) << "most of it would be unused";
  void* const third = allocate_bulk(size, 64);
  EXPECT_EQ(third, first);
  for (void* const block : {smaller, larger, third}) release_bulk(block);
}

/// Also after others have been taken or released since.
TEST(Bulk, EachBlockServesOnce) {
  constexpr std::size_t size = std::size_t{400} << 10;
  release_bulk(allocate_bulk(size, 64));
  void* const first = allocate_bulk(size, 64);
  void* const second = allocate_bulk(size, 64);
  EXPECT_NE(second, first);
  release_bulk(first);
  release_bulk(second);
  release_spare_bulk();
  void* const held = std::aligned_alloc(64, size);  // where the released ones were
  void* const third = allocate_bulk(size, 64);
  EXPECT_NE(third, held);
  release_bulk(third);
  std::free(held);
}

TEST(Bulk, LargeBlocksAreKeptInsteadOfSmallOnes) {
  std::vector<void*> small;
  for (int i = 0; i < 100; ++i) small.push_back(allocate_bulk(std::size_t{70} << 10, 64));
  void* const large = allocate_bulk(std::size_t{800} << 10, 64);
  for (void* const block : small) release_bulk(block);
  release_bulk(large);
  void* const again = allocate_bulk(std::size_t{800} << 10, 64);
  if (test::sanitizer != "address") {
    EXPECT_EQ(again, large);
  }
  release_bulk(again);
  release_spare_bulk();
}

TEST(Bulk, RoomIsMadeWithoutItemsAndKeepsThoseThereAre) {
  std::vector<std::uint32_t> items(1000);
  std::iota(items.begin(), items.end(), 3u);
  make_room(items, 100'000);
  ASSERT_EQ(items.size(), 1000u);
  ASSERT_GE(items.capacity(), 101'000u);
  for (std::uint32_t i = 0; i < items.size(); ++i) ASSERT_EQ(items[i], i + 3);
  const std::uint32_t* const before = items.data();
  items.resize(101'000);
  EXPECT_EQ(items.data(), before);
}

TEST(Bulk, RangesAreClearedWhetherTheyFillPagesOrNot) {
  constexpr std::size_t pages = 5, page = 4096, first = page / 2, end = pages * page - page / 2;
  ZeroedVector<std::uint8_t> bytes((pages + 1) * page, 7);
  std::uint8_t* const begin =
      bytes.data() + (page - reinterpret_cast<std::uintptr_t>(bytes.data()) % page) % page;
  clear_pages(begin + first, end - first);
  for (std::size_t i = 0; i < pages * page; ++i)
    ASSERT_EQ(begin[i], i >= first && i < end ? 0 : 7) << i;
  clear_pages(begin + 10, 20);
  for (std::size_t i = 0; i < first; ++i) ASSERT_EQ(begin[i], i >= 10 && i < 30 ? 0 : 7) << i;
}

TEST(Zeroed, NewItemsAreZeroAndAligned) {
  for (const std::size_t size : {std::size_t{3}, std::size_t{1} << 20}) {
    ZeroedVector<double> items(size);
    EXPECT_TRUE(is_aligned(items.data(), 64));
    for (const double item : items) ASSERT_EQ(item, 0);
    items.back() = 5;
    items.resize(3 * size);
    EXPECT_TRUE(is_aligned(items.data(), 64));
    EXPECT_EQ(items[size - 1], 5);
    for (std::size_t i = size; i < items.size(); ++i) ASSERT_EQ(items[i], 0);
  }
}

}  // namespace
}  // namespace suture
