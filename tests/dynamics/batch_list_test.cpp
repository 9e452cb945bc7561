// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/batch_list.hpp"

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
      for (const loops::Range& range : list.ranges(c))
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

TEST(BatchList, RowsThatCutsAppendKeepTheColoursApart) {
  const unsigned seed = 20260307;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Index first_rows = 4000, vertices = 3000;
  std::vector<Index> nodes = random_rows(first_rows, vertices, random);
  BatchList list({nodes.data(), nullptr, 2}, {{0, first_rows}}, vertices);
  expect_lawful(list, {nodes.data(), nullptr, 2}, first_rows);
  const Index colours = list.colour_count();
  Index rows = first_rows;
  for (const Index added : {3u, 400u, 1u, 2500u, 5u, 900u, 700u}) {
    const std::vector<Index> more = random_rows(added, vertices, random);
    nodes.insert(nodes.end(), more.begin(), more.end());
    ASSERT_TRUE(list.append({nodes.data(), nullptr, 2}, rows, rows + added, vertices));
    rows += added;
    expect_lawful(list, {nodes.data(), nullptr, 2}, rows);
  }
  EXPECT_GT(list.chunk_count(), 64u + 20u);  // the tails have been divided
  EXPECT_GT(list.colour_count(), colours);
}

TEST(BatchList, WithTooManyColoursAsksToBeMadeAnew) {
  const std::vector<Index> nodes(2 * 20000);  // all rows share a vertex: no two chunks agree
  const Connectivity cells{nodes.data(), nullptr, 2};
  BatchList list(cells, {{0, 64}}, 1);
  EXPECT_TRUE(list.append(cells, 64, 6064, 1));
  EXPECT_GT(list.colour_count(), 64u);
  EXPECT_FALSE(list.append(cells, 6064, 12064, 1));
}

}  // namespace
}  // namespace suture
