// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/part_column.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

/// In blocks of 8 rows and lanes fastest, as a functor finds them.
TEST(PartColumn, HoldsRowsFromAFirstOneOn) {
  PartColumn column(3);
  column.resize(13, 18);
  column.set(13, std::array{1., 2., 3.});
  column.set(17, std::array{4., 5., 6.});
  column.resize(13, 40);
  column.set(39, std::array{7., 8., 9.});
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(column.get(13, c), 1. + double(c));
    EXPECT_EQ(column.get(17, c), 4. + double(c));
    EXPECT_EQ(column.get(39, c), 7. + double(c));
    EXPECT_EQ(column.get(16, c), 0) << "rows that are new";
    EXPECT_EQ(column.data()[17 / 8 * 24 + 8 * c + 17 % 8], 4. + double(c));
  }
}

}  // namespace
}  // namespace suture
