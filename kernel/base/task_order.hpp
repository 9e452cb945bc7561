// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// Tasks in a partial order: a task waits for the earlier tasks that it names, and runs in parallel
/// with all others.
///
///   order   0   1   2   3   4   5      3 names 0 and 1, 4 names 1, 5 names 2 and 3
///   thread  A   B   A   B   A   A      B takes 3 when 0 and 1 are done
///
/// Tasks that wait for each other write the same results for every number of threads.
struct TaskOrder {
  std::vector<std::vector<Index>> before;  ///< by task: lower numbers, in any order
  /// By task: the position of its data among those of all tasks, 0 .. count-1. A thread first takes
  /// the tasks of its part, which is the same in every round, so that their data stay in its cache.
  std::vector<Index> place;
};

/// One round over all tasks, which any number of threads may join.
class TaskRound {
 public:
  /// `order`: null if no task waits for another; the place of a task is then its number.
  TaskRound(std::size_t count, const TaskOrder* order, unsigned threads);

  using Call = void (*)(void* context, std::size_t task, unsigned worker);
  /// Thread `worker` takes tasks until all are taken. Threads that arrive late, or never, are not
  /// waited for: if a task has to wait for one that nobody has taken, the waiting thread runs it.
  /// All tasks are done when all threads that joined have returned.
  void join(unsigned worker, void* context, Call call);

 private:
  struct Job {
    void* context;
    Call call;
    unsigned worker;
  };
  void take(std::size_t task, const Job& job);
  bool is_ready(std::size_t task) const;
  void wait_for(std::size_t task) const;
  unsigned home(std::size_t task) const;

  std::size_t count_;
  const TaskOrder* order_;
  unsigned threads_;
  struct State {
    std::atomic<bool> taken{false}, done{false};
  };
  std::vector<State> states_;
};

}  // namespace suture
