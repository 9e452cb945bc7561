// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/pages.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>

namespace suture {
namespace {

/// Pages in memory of those from `begin` on.
std::size_t resident_pages(const void* begin, std::size_t bytes) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const auto first = reinterpret_cast<std::uintptr_t>(begin) / page * page;
  std::vector<unsigned char> there(bytes / page);
  if (mincore(reinterpret_cast<void*>(first), bytes / page * page, there.data()) != 0) return 0;
  return static_cast<std::size_t>(
      std::ranges::count_if(there, [](unsigned char c) { return c & 1; }));
}

/// The heap holds memory that was in use and is free now.
class UsedHeap {
 public:
  UsedHeap() {
    for (int i = 0; i < 2; ++i) {  // the first tells malloc that such blocks come and go
      auto used = std::make_unique<std::vector<char>>(16u << 20, 'x');
      above_ = std::make_unique<std::vector<char>>(1000, 'x');
    }
  }

 private:
  std::unique_ptr<std::vector<char>> above_;
};

TEST(Pages, AReserveTakesNoMemoryEvenWhereMemoryWasUsedBefore) {
  const UsedHeap heap;
  PageVector<double> values;
  values.reserve(1u << 20);
  values.resize(1000, 2.5);
  const std::size_t bytes = values.capacity() * sizeof(double);
  EXPECT_GE(resident_pages(values.data(), bytes), 2u);
  EXPECT_LT(resident_pages(values.data(), bytes), 16u);
  const double* const before = values.data();
  values.resize(1u << 20, 1);
  EXPECT_EQ(values.data(), before) << "room was reserved";
  EXPECT_EQ(values[999], 2.5);
  EXPECT_EQ(values[1000], 1);
  EXPECT_GE(resident_pages(values.data(), bytes), 2000u);
}

TEST(Pages, VectorsGrowFromTheHeapToPagesOfTheirOwn) {
  PageVector<double> values;
  for (int i = 0; i < 100'000; ++i) {
    values.push_back(i);
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(values.data()) % 64, 0u);
  }
  EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0.0), 99'999.0 * 50'000);
  const PageVector<double> copy = values;
  values = PageVector<double>();
  EXPECT_EQ(copy[99'999], 99'999);
}

}  // namespace
}  // namespace suture
