// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/parallel.hpp"

#include <gtest/gtest.h>

#include <set>
#include <thread>
#include <vector>

namespace suture {
namespace {

class WorkersOf : public testing::TestWithParam<unsigned> {};

TEST_P(WorkersOf, CallEachIndexOnceAndSeeWhatWasWrittenBefore) {
  const Workers workers(GetParam());
  std::vector<int> calls(1000, 0);
  for (int round = 1; round <= 20; ++round) {
    std::vector<int> before(calls);
    workers.parallel_for(calls.size(), [&](std::size_t i) { calls[i] = before[i] + 1; });
    EXPECT_EQ(calls, std::vector<int>(1000, round));
  }
}

TEST_P(WorkersOf, NeverUseMoreThreadsThanAsked) {
  const Workers workers(GetParam());
  std::vector<std::thread::id> ids(200);
  workers.parallel_for(ids.size(), [&](std::size_t i) { ids[i] = std::this_thread::get_id(); });
  EXPECT_LE(std::set<std::thread::id>(ids.begin(), ids.end()).size(), GetParam());
  EXPECT_EQ(workers.threads(), GetParam());
}

TEST_P(WorkersOf, DoNothingForNothing) {
  Workers(GetParam()).parallel_for(0, [](std::size_t) { FAIL(); });
}

INSTANTIATE_TEST_SUITE_P(Threads, WorkersOf, testing::Values(1u, 2u, 4u));

TEST(Workers, CountTheCoresWhenNotTold) { EXPECT_GE(Workers(0).threads(), 1u); }

}  // namespace
}  // namespace suture
