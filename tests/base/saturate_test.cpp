// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/saturate.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace suture {
namespace {

TEST(Saturate, DropsTheFraction) {
  EXPECT_EQ(saturate<int>(2.9), 2);
  EXPECT_EQ(saturate<int>(-2.9), -2);
  EXPECT_EQ(saturate<std::uint32_t>(-0.5), 0u);
}

TEST(Saturate, StopsAtTheLimits) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(saturate<int>(1e300), std::numeric_limits<int>::max());
  EXPECT_EQ(saturate<std::int64_t>(-infinite), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(saturate<std::uint64_t>(18446744073709551616.0), ~std::uint64_t{0});
  EXPECT_EQ(saturate<std::int64_t>(9223372036854774784.0), 9223372036854774784);
  EXPECT_EQ(saturate<std::uint8_t>(-1), 0);
  EXPECT_EQ(saturate<int>(std::numeric_limits<double>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace suture
