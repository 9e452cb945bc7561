// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/marks.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

TEST(Marks, AreSetOnceListedInOrderAndTakenBack) {
  std::vector<std::uint64_t> bits(3);
  for (const Index i : {130u, 0u, 63u, 64u}) EXPECT_TRUE(marks::mark(bits, i));
  EXPECT_FALSE(marks::mark(bits, 63));
  EXPECT_EQ(marks::marked(bits), (std::vector<Index>{0, 63, 64, 130}));
  marks::unmark(bits, {0, 64, 130});
  EXPECT_EQ(bits, std::vector<std::uint64_t>(3));
}

}  // namespace
}  // namespace suture
