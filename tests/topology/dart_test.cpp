// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/dart.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

/// Every dart of three elements is the one that its element, side and position say.
TEST(Dart, IsItsElementSideAndPosition) {
  for (Index e = 0; e < 3; ++e)
    for (int f = 0; f < 6; ++f) {
      EXPECT_EQ(sides_of(e)[static_cast<std::size_t>(f)], face_dart(e, f));
      for (Dart k = 0; k < 4; ++k) {
        const Dart d = face_dart(e, f) + k;
        EXPECT_EQ(d, 24 * e + 4 * Dart(f) + k);
        EXPECT_EQ(element_of(d), e);
        EXPECT_EQ(local_face(d), Dart(f));
        EXPECT_EQ(face_of(d), face_dart(e, f));
        EXPECT_EQ(corresponding_dart(e + 7, d), face_dart(e + 7, f) + k);
      }
    }
}

}  // namespace
}  // namespace suture
