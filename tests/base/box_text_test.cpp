// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/box_text.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace suture {
namespace {

TEST(BoxText, HasTheDigitsThatShowTheSize) {
  EXPECT_EQ(box_text({0, 0, 0}, {1, 0.25, 0.123456789}, 4), "[0, 0, 0] to [1, 0.25, 0.1235]");
  EXPECT_EQ(box_text({1e7, 0, -3e6}, {1e7 + 1, 0.25, -3e6 + 0.5}, 4),
            "[10000000, 0, -3000000] to [10000001, 0.25, -2999999.5]");
}

TEST(BoxText, OfNothingAndOfEverything) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(box_text({5, 5, 5}, {5, 5, 5}, 4), "[5, 5, 5] to [5, 5, 5]");
  EXPECT_EQ(box_text({-infinity, 0, 0}, {infinity, 1, 1}, 4), "[-inf, 0, 0] to [inf, 1, 1]");
}

}  // namespace
}  // namespace suture
