// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/live_mask.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace suture {
namespace {

TEST(LiveMask, StoresNothingUntilARowDies) {
  LiveMask mask;
  mask.resize(20);
  EXPECT_TRUE(mask.all() && mask[19] && mask.fits(20));
  EXPECT_EQ(mask.data(), nullptr);
  for (const Index row : {3u, 8u, 19u, 8u}) mask.kill(row, 20);
  EXPECT_EQ(mask.dead(), 3u) << "one of them twice";
  for (Index row = 0; row < 20; ++row) EXPECT_EQ(mask[row], row != 3 && row != 8 && row != 19);
  mask.resize(40);
  EXPECT_TRUE(mask.fits(40) && mask[20] && mask[39]) << "new rows are live";
  EXPECT_EQ(mask.data()[0], 0xFF & ~(1 << 3));
  EXPECT_EQ(mask.data()[4], LiveMask::full);
}

}  // namespace
}  // namespace suture
