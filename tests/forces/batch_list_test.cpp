// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/batch_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace suture {
namespace {

/// Rows of two vertices each, near each other as in a mesh.
std::vector<Index> random_rows(Index rows, Index vertices, std::mt19937& random) {
  std::vector<Index> nodes;
  for (Index row = 0; row < rows; ++row) {
    const Index near = row * std::uint64_t{vertices} / rows;
    nodes.push_back(near);
    nodes.push_back((near + 1 + random() % 40) % vertices);
  }
  return nodes;
}

/// Every row is in one chunk, and chunks of one colour share no vertex.
void expect_lawful(const BatchList& list, const Connectivity& cells, Index rows) {
  std::vector<int> visits(rows);
  for (Index colour = 0; colour < list.colour_count(); ++colour) {
    std::set<Index> of_colour;
    for (Index c = list.chunk_begin(colour); c < list.chunk_end(colour); ++c) {
      std::set<Index> of_chunk;
      for (const loops::Rows& range : list.ranges(c))
        for (Index row = range.begin; row < range.end; ++row) {
          ++visits[row];
          for (const Index vertex : cells.of(row)) of_chunk.insert(vertex);
        }
      for (const Index vertex : of_chunk)
        EXPECT_TRUE(of_colour.insert(vertex).second)
            << "vertex " << vertex << " twice in colour " << colour;
    }
  }
  EXPECT_EQ(std::ranges::count(visits, 1), rows);
  EXPECT_EQ(list.cell_count(), rows);
}

/// Where two chunks share a vertex, the later waits for the earlier, by itself or
/// through others; the places are a permutation.
void expect_ordered(const BatchList& list, const Connectivity& cells, Index vertices) {
  const TaskOrder& order = list.order();
  ASSERT_EQ(order.before.size(), list.chunk_count());
  std::vector<std::set<Index>> waits(list.chunk_count());  // for these, in the end
  std::vector<std::set<Index>> chunks_at(vertices);
  for (Index c = 0; c < list.chunk_count(); ++c) {
    for (const Index earlier : order.before[c]) {
      ASSERT_LT(earlier, c);
      waits[c].insert(earlier);
      waits[c].insert(waits[earlier].begin(), waits[earlier].end());
    }
    for (const loops::Rows& range : list.ranges(c))
      for (Index row = range.begin; row < range.end; ++row)
        for (const Index vertex : cells.of(row)) chunks_at[vertex].insert(c);
  }
  for (const auto& chunks : chunks_at)
    for (const Index c : chunks)
      for (const Index earlier : chunks)
        EXPECT_TRUE(earlier >= c || waits[c].contains(earlier)) << earlier << " and " << c;
  std::vector<Index> places(order.place);
  std::ranges::sort(places);
  for (Index place = 0; place < list.chunk_count(); ++place) EXPECT_EQ(places[place], place);
}

TEST(BatchList, RowsThatCutsAppendKeepTheColoursApart) {
  const unsigned seed = 20260307;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Index first_rows = 4000, vertices = 3000;
  std::vector<Index> nodes = random_rows(first_rows, vertices, random);
  BatchList list({nodes.data(), nullptr, 2}, {{0, first_rows}}, vertices);
  expect_lawful(list, {nodes.data(), nullptr, 2}, first_rows);
  expect_ordered(list, {nodes.data(), nullptr, 2}, vertices);
  const Index colours = list.colour_count();
  Index rows = first_rows;
  for (const Index added : {3u, 400u, 1u, 2500u, 5u, 900u, 700u}) {
    const std::vector<Index> more = random_rows(added, vertices, random);
    nodes.insert(nodes.end(), more.begin(), more.end());
    ASSERT_TRUE(list.append({nodes.data(), nullptr, 2}, rows, rows + added, vertices));
    rows += added;
    expect_lawful(list, {nodes.data(), nullptr, 2}, rows);
    expect_ordered(list, {nodes.data(), nullptr, 2}, vertices);
  }
  EXPECT_GT(list.chunk_count(), 64u + 20u);  // the tails have been divided
  EXPECT_GT(list.colour_count(), colours);
}

TEST(BatchList, WithoutStillRowsKeepsTheOrderOfTheOthers) {
  std::mt19937 random(11);
  const Index rows = 5000, vertices = 3000;
  const std::vector<Index> nodes = random_rows(rows, vertices, random);
  const Connectivity cells{nodes.data(), nullptr, 2};
  BatchList list(cells, {{0, rows}}, vertices);
  std::vector<bool> fixed(vertices);
  for (Index v = 0; v < 1000; ++v) fixed[v] = true;
  list.leave_out(cells, fixed);
  EXPECT_GT(list.left_out(), 1000u);
  EXPECT_LT(list.chunk_count(), 64u);
  expect_ordered(list, cells, vertices);
}

/// Functors treat the rows of each range by another formula, so that no batch may hold both.
TEST(BatchList, WithoutStillRowsKeepsRangesApart) {
  std::mt19937 random(13);
  const Index rows = 1000, vertices = 600;
  const std::vector<Index> nodes = random_rows(rows, vertices, random);
  const Connectivity cells{nodes.data(), nullptr, 2};
  for (const Index border : {405u, 408u}) {
    BatchList list(cells, {{0, border}, {border, rows}}, vertices);
    const Index batches = list.batch_count();
    list.leave_out(cells, std::vector<bool>(vertices));
    for (Index c = 0; c < list.chunk_count(); ++c)
      for (const loops::Rows& range : list.ranges(c))
        EXPECT_TRUE(range.end <= border || range.begin >= border) << range.begin;
    EXPECT_EQ(list.batch_count(), batches);
  }
}

/// Two chunks that had nothing to do with each other share a vertex since a seam.
TEST(BatchList, ChunksThatMeetWaitForEachOther) {
  std::mt19937 random(12);
  const Index rows = 4000, vertices = 3000;
  std::vector<Index> nodes = random_rows(rows, vertices, random);
  const Connectivity cells{nodes.data(), nullptr, 2};
  BatchList list(cells, {{0, rows}}, vertices);
  const ChunkFinder finder(list);
  nodes[2 * 3000] = nodes[2 * 100];
  std::vector<Index> chunks;
  for (Index row = 0; row < rows; ++row)
    if (std::ranges::count(cells.of(row), nodes[2 * 100]) != 0) chunks.push_back(finder.chunk(row));
  std::ranges::sort(chunks);
  chunks.erase(std::unique(chunks.begin(), chunks.end()), chunks.end());
  ASSERT_GT(chunks.size(), 1u);
  list.meet(chunks);
  expect_ordered(list, cells, vertices);
}

TEST(BatchList, WithTooManyColoursAsksToBeRebuilt) {
  const std::vector<Index> nodes(2 * 20000);  // all rows share a vertex: no two chunks agree
  const Connectivity cells{nodes.data(), nullptr, 2};
  BatchList list(cells, {{0, 64}}, 1);
  EXPECT_TRUE(list.append(cells, 64, 6064, 1));
  EXPECT_GT(list.colour_count(), 64u);
  EXPECT_FALSE(list.append(cells, 6064, 12064, 1));
}

}  // namespace
}  // namespace suture
