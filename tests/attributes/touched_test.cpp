// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/touched.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

TEST(TouchedElements, AreNumberedWithinTheirRegion) {
  const CellSet region = CellSet::of({1, 2, 5, 7}, 9);
  TouchedElements touched;
  touched.reserve(9);
  touched.select(region, std::array<Index, 4>{0, 2, 5, 8});
  EXPECT_EQ(std::vector<Index>(touched.members().begin(), touched.members().end()),
            (std::vector<Index>{2, 5}));
  EXPECT_EQ(touched.slot(5), 1u);
  EXPECT_EQ(touched.slot(8), none);
}

}  // namespace
}  // namespace suture
