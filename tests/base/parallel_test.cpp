// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/parallel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
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

/// Tasks on a few cells each, which wait for the last task before at each of them.
struct CellTasks {
  std::vector<std::vector<Index>> cells;
  TaskOrder order;
};

CellTasks random_tasks(Index count, Index cells, std::mt19937& random) {
  CellTasks tasks;
  std::vector<Index> last(cells, none);
  for (Index task = 0; task < count; ++task) {
    auto& mine = tasks.cells.emplace_back();
    auto& before = tasks.order.before.emplace_back();
    const Index near = random() % cells;
    for (Index i = 0; i < 3; ++i) {
      const Index cell = (near + random() % 4) % cells;
      if (last[cell] != none && last[cell] != task) before.push_back(last[cell]);
      last[cell] = task;
      mine.push_back(cell);
    }
    tasks.order.place.push_back(task);
  }
  std::shuffle(tasks.order.place.begin(), tasks.order.place.end(), random);
  return tasks;
}

/// What a cell holds depends on the order of the tasks at it.
TEST_P(WorkersOf, KeepTheOrderOfTasksThatWait) {
  const unsigned seed = 20261121;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Workers workers(GetParam());
  for (int round = 0; round < 50; ++round) {
    const Index cells = 5 + random() % 60;
    const CellTasks tasks = random_tasks(random() % 300, cells, random);
    const auto run = [&](std::vector<std::uint64_t>& values, std::size_t task) {
      for (const Index cell : tasks.cells[task]) values[cell] = values[cell] * 31 + task;
    };
    std::vector<std::uint64_t> serial(cells, 1), parallel(cells, 1);
    for (std::size_t task = 0; task < tasks.cells.size(); ++task) run(serial, task);
    workers.in_order(tasks.order, [&](std::size_t task) { run(parallel, task); });
    ASSERT_EQ(serial, parallel);
  }
}

/// A thread that never comes is not waited for, whatever it was to do.
TEST(TaskRound, IsDoneByOneThreadOfMany) {
  std::mt19937 random(7);
  const CellTasks tasks = random_tasks(200, 20, random);
  for (const unsigned worker : {0u, 2u}) {
    TaskRound round(200, &tasks.order, 3);
    std::vector<Index> done;
    round.join(worker, &done, [](void* list, std::size_t task, unsigned) {
      static_cast<std::vector<Index>*>(list)->push_back(static_cast<Index>(task));
    });
    ASSERT_EQ(done.size(), 200u);
    std::vector<std::size_t> when(200);
    for (std::size_t i = 0; i < done.size(); ++i) when[done[i]] = i;
    for (std::size_t task = 0; task < 200; ++task)
      for (const Index earlier : tasks.order.before[task]) EXPECT_LT(when[earlier], when[task]);
  }
}

/// A thread keeps to its part of the data while others keep to theirs.
TEST(TaskRound, GivesEachThreadTheTasksOfItsPlaceFirst) {
  TaskOrder order;
  order.before.resize(12);
  for (Index task = 0; task < 12; ++task) order.place.push_back(11 - task);
  TaskRound round(12, &order, 3);
  std::vector<std::size_t> done;
  round.join(1, &done, [](void* list, std::size_t task, unsigned) {
    static_cast<std::vector<std::size_t>*>(list)->push_back(task);
  });
  done.resize(4);
  EXPECT_EQ(done, (std::vector<std::size_t>{4, 5, 6, 7}));
}

/// Workers of others inside a task.
TEST_P(WorkersOf, MayBeUsedBesideOthers) {
  const Workers outer(GetParam()), inner(GetParam());
  std::vector<int> sums(8);
  outer.parallel_for(sums.size(), [&](std::size_t i) {
    std::vector<int> parts(50);
    inner.parallel_for(parts.size(), [&](std::size_t k) { parts[k] = static_cast<int>(k); });
    for (const int part : parts) sums[i] += part;
  });
  EXPECT_EQ(sums, std::vector<int>(8, 1225));
}

INSTANTIATE_TEST_SUITE_P(Threads, WorkersOf, testing::Values(1u, 2u, 3u, 8u));

TEST(Workers, CountTheCoresWhenNoneAreGiven) { EXPECT_GE(Workers(0).threads(), 1u); }

}  // namespace
}  // namespace suture
