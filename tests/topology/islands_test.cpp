// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/islands.hpp"

#include <gtest/gtest.h>

#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;
using Elements = std::vector<Index>;

/// The islands are the components that the map itself finds, and sizes and lists agree.
void expect_components(Islands& islands, const CellComplex& map) {
  Index components = 0;
  const std::vector<Index> component = map.islands(&components);
  EXPECT_EQ(islands.existing(), components);
  std::map<Index, Index> island_of;
  std::map<Index, Elements> members;
  for (Index e = 0; e < map.element_count(); ++e) {
    const Index island = islands.of(e);
    ASSERT_EQ(island == none, component[e] == none);
    if (island == none) continue;
    ASSERT_EQ(island_of.try_emplace(component[e], island).first->second, island);
    members[island].push_back(e);
  }
  EXPECT_EQ(members.size(), components);
  for (Index i = 0; i < islands.count(); ++i) {
    EXPECT_EQ(islands.size(i), members[i].size());
    EXPECT_EQ(islands.elements(map, i), members[i]);
  }
}

/// The number of a part is that of the island in which its elements were, if it is the
/// largest part of it and no larger island was sewn to it: computed from complete lists.
void expect_names(const Islands& before, const Islands& after, const IslandChange& change) {
  std::map<Index, std::map<Index, Elements>> parts;  // by island before, then after
  for (Index e = 0; e < before.of_elements().size(); ++e)
    if (after.of(e) != none) parts[before.of(e)][after.of(e)].push_back(e);
  std::map<Index, Elements> fresh;
  for (const auto& part : parts) {
    const Index old = part.first;
    const std::map<Index, Elements>& now = part.second;
    const bool merged =
        std::ranges::any_of(change.merges, [&](const Merge& m) { return m.gone == old; });
    if (merged) continue;
    ASSERT_TRUE(now.contains(old)) << "island " << old << " lost its number";
    for (const auto& [island, elements] : now) {
      if (island == old) continue;
      fresh[island] = elements;
      const Elements& kept = now.at(old);
      EXPECT_TRUE(kept.size() > elements.size() ||
                  (kept.size() == elements.size() && kept[0] < elements[0]));
    }
  }
  Index next = before.count(), last = 0;
  for (const auto& [island, elements] : fresh) {
    EXPECT_EQ(island, next++);
    EXPECT_GE(elements[0], last);
    last = elements[0];
  }
  EXPECT_EQ(next, after.count());
  EXPECT_EQ(change.splits.size(), fresh.size());
  for (const Merge& m : change.merges) {
    EXPECT_EQ(after.size(m.gone), 0u);
    EXPECT_TRUE(before.size(m.kept) > before.size(m.gone) ||
                (before.size(m.kept) == before.size(m.gone) && m.kept < m.gone));
  }
}

TEST(Islands, OfABlobAreItsComponents) {
  std::mt19937 random(7);
  const CellComplex map = complex_of(blob(6, 0.3, random));
  Islands islands(map);
  expect_components(islands, map);
  EXPECT_TRUE(std::ranges::equal(islands.of_elements(), map.islands()));
}

TEST(Islands, TheLargestPartKeepsTheNumber) {
  CellComplex map = complex_of(grid(10, 1, 1));
  Islands islands(map);
  IslandChange change = islands.update(map, map.cut(std::array<Dart, 1>{24 * 2 + 8}));
  EXPECT_EQ(islands.of(0), 1u);
  EXPECT_EQ(islands.of(9), 0u);
  EXPECT_EQ(islands.size(1), 3u);
  EXPECT_EQ(change.touched, (Elements{0, 1}));
  change = islands.update(map, map.pierce(Elements{6}));  // 3 + hole + 3: equal parts
  EXPECT_EQ(islands.of(3), 0u);
  EXPECT_EQ(islands.of(7), 2u);
  EXPECT_EQ(islands.of(6), none);
  EXPECT_EQ(islands.smaller_than(4), (Elements{0, 1, 2}));
  change = islands.update(map, map.pierce(Elements{7, 8, 9}));
  EXPECT_EQ(change.removed, (Elements{2}));
  EXPECT_TRUE(change.touched.empty());
  EXPECT_EQ(islands.smaller_than(4), (Elements{0, 1}));
  change = islands.update(map, map.sew(std::array<Seam, 1>{{{24 * 2 + 8, 24 * 3}}}));
  ASSERT_EQ(change.merges.size(), 1u);
  EXPECT_EQ(change.merges[0].kept, 0u);
  EXPECT_EQ(islands.size(0), 6u);
  expect_components(islands, map);
}

TEST(Islands, ASlitTouchesButDoesNotSeparate) {
  CellComplex map = complex_of(grid(6, 6, 6));
  Islands islands(map);
  const IslandChange change = islands.update(map, map.cut(std::array<Dart, 1>{24 * 86 + 8}));
  EXPECT_TRUE(change.splits.empty());
  EXPECT_EQ(change.touched, Elements{0});
  EXPECT_EQ(islands.count(), 1u);
}

TEST(Islands, HalvesOfABlock) {
  CellComplex map = complex_of(grid(12, 12, 16));
  Islands islands(map);
  for (const Index z : {7, 3}) {  // equal halves, then a quarter of the first one
    std::vector<Dart> faces;
    for (Index i = 0; i < 144; ++i) faces.push_back(24 * (144 * z + i) + 20);
    const Islands before = islands;
    const IslandChange change = islands.update(map, map.cut(faces));
    EXPECT_EQ(change.splits.size(), 1u);
    expect_components(islands, map);
    expect_names(before, islands, change);
  }
  EXPECT_EQ(islands.of(0), 0u);
}

/// Seams of some faces that were cut and whose elements are still there.
std::vector<Seam> take_seams(std::vector<Seam>& open, const CellComplex& map,
                             std::mt19937& random) {
  std::erase_if(open, [&](const Seam& s) { return !map.can_sew(s.one, s.other); });
  std::shuffle(open.begin(), open.end(), random);
  const auto keep = std::ptrdiff_t(open.size() - open.size() / 2);
  std::vector<Seam> seams(open.begin() + keep, open.end());
  open.erase(open.begin() + keep, open.end());
  return seams;
}

TEST(Islands, FollowRandomSequences) {
  const unsigned seed = 20260104;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 60; ++round) {
    CellComplex map = complex_of(shuffled(blob(6, 0.4 + 0.1 * (round % 7), random), random));
    Islands islands(map);
    std::vector<Seam> open;
    for (int step = 0; step < 10; ++step) {
      const Islands before = islands;
      TopologyChange change;
      const auto kind = random() % 4;
      if (kind < 2) {
        std::vector<Dart> faces = interior_faces(map);
        std::shuffle(faces.begin(), faces.end(), random);
        faces.resize(kind == 0 ? faces.size() / 3 : std::min<std::size_t>(faces.size(), 3));
        for (const Dart d : faces) open.push_back({d, map.beta3(d)});
        change = map.cut(faces);
      } else if (kind == 2) {
        Elements elements;
        for (Index e = 0; e < map.element_count(); ++e)
          if (map.can_pierce(e) && random() % 8 == 0) elements.push_back(e);
        if (elements.size() == map.existing(3)) elements.pop_back();
        change = map.pierce(elements);
      } else {
        try {
          change = map.sew(take_seams(open, map, random));
        } catch (const std::exception&) {  // one of them is possible, all are not
        }
      }
      const IslandChange reported = islands.update(map, change);
      ASSERT_NO_FATAL_FAILURE(expect_components(islands, map));
      ASSERT_NO_FATAL_FAILURE(expect_names(before, islands, reported));
    }
  }
}

}  // namespace
}  // namespace suture
