// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// Tasks in a fixed order of which only a part matters: a task waits for those
/// before it that it names, and runs beside all others.
///
///   order   0   1   2   3   4   5      3 names 0 and 1, 4 names 1, 5 names 2 and 3
///   thread  A   B   A   B   A   A      B takes 3 when 0 and 1 are done
///
/// What tasks that wait for each other write is the same for every number of threads.
struct TaskOrder {
  std::vector<std::vector<Index>> before;  ///< by task: lower numbers, in any order
  /// By task: where its data lie among those of all, 0 .. count-1. A thread takes
  /// those of its own part first, the same in every round, so that its cache holds them.
  std::vector<Index> place;
};

/// One round over all tasks, which any number of threads may join.
class TaskRound {
 public:
  /// `order`: null if no task waits, and their places are their numbers.
  TaskRound(std::size_t count, const TaskOrder* order, unsigned threads);

  using Call = void (*)(void* context, std::size_t task, unsigned worker);
  /// Thread `worker` takes tasks until all are taken. Whoever comes late, or never, is
  /// not waited for: what a task waits for is done at once if nobody has taken it.
  /// All are done when all threads that joined have returned.
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
