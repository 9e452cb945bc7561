// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/vertex_selection.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

TEST(VertexSelection, NumbersInTheGivenOrderAndForgetsTheLastOne) {
  VertexSelection selection;
  selection.select(std::array<Index, 3>{4, 1, 3}, 6);
  EXPECT_EQ(selection.slot(1), 1u);
  selection.select(std::array<Index, 2>{5, 4}, 8);  // more vertices, after a cut
  EXPECT_TRUE(selection.contains(5) && selection.contains(4));
  EXPECT_FALSE(selection.contains(1) || selection.contains(7));
  EXPECT_EQ(selection.slot(4), 1u);
}

}  // namespace
}  // namespace suture
