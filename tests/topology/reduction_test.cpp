// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "kernel/topology/islands.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

/// Every `nth` of 1,000 operations removes an element, the others cut; together all
/// faces. With `nth` = 0 they only cut.
void reduce_to_single_elements(unsigned nth) {
  const unsigned seed = 20260105, operations = 1000;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  CellComplex map = complex_of(grid(20, 20, 20));
  Islands islands(map);
  std::vector<Dart> faces = interior_faces(map);
  ASSERT_EQ(faces.size(), 3u * 19 * 20 * 20);
  std::shuffle(faces.begin(), faces.end(), random);
  for (unsigned i = 0; i < operations; ++i) {
    std::vector<Dart> some;
    for (std::size_t f = faces.size() * i / operations; f < faces.size() * (i + 1) / operations;
         ++f)
      if (map.can_cut(faces[f])) some.push_back(faces[f]);
    islands.update(map, map.cut(some));
    if (nth != 0 && i % nth == 0) {
      Index e = static_cast<Index>(random() % 8000);
      while (!map.can_pierce(e)) e = (e + 1) % 8000;
      islands.update(map, map.pierce(std::array<Index, 1>{e}));
    }
    if (i % 100 != 99) continue;
    map.validate();
    islands.validate(map);
  }
  const Index left = map.existing(3);
  EXPECT_EQ(left, 8000 - (nth == 0 ? 0 : operations / nth));
  EXPECT_EQ(islands.existing(), left);
  EXPECT_EQ(map.existing(0), 8 * left);
  EXPECT_EQ(map.existing(1), 12 * left);
  EXPECT_EQ(map.existing(2), 6 * left);
}

TEST(Reduction, AThousandCutsToSingleElements) { reduce_to_single_elements(0); }
TEST(Reduction, AThousandCutsAndPiercingsToSingleElements) { reduce_to_single_elements(2); }

}  // namespace
}  // namespace suture
