// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/task_order.hpp"

#include <algorithm>
#include <thread>

namespace suture {
namespace {

/// Turns, each some tens of cycles, before a thread that waits lets others run: as long as a
/// task takes, unless the thread that has it lost its core.
constexpr int patience = 2000;

inline void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

TaskRound::TaskRound(std::size_t count, const TaskOrder* order, unsigned threads)
    : count_(count), order_(order), threads_(threads), states_(count) {}

unsigned TaskRound::home(std::size_t task) const {
  const std::size_t place = order_ ? order_->place[task] : task;
  return static_cast<unsigned>(place * threads_ / count_);
}

void TaskRound::join(unsigned worker, void* context, Call call) {
  const Job job{context, call, worker};
  for (std::size_t task = 0; task < count_; ++task)
    if (home(task) == worker && is_ready(task)) take(task, job);
  for (std::size_t task = 0; task < count_; ++task)
    if (home(task) == worker) take(task, job);
  for (std::size_t task = 0; task < count_; ++task) take(task, job);
}

bool TaskRound::is_ready(std::size_t task) const {
  if (!order_) return true;
  return std::ranges::all_of(order_->before[task], [&](Index earlier) {
    return states_[earlier].done.load(std::memory_order_relaxed);
  });
}

/// No thread waits for ever: what is waited for has been taken, and the lowest task
/// that is taken but not done waits for none.
void TaskRound::take(std::size_t task, const Job& job) {
  State& state = states_[task];
  if (state.taken.load(std::memory_order_relaxed)) return;
  if (state.taken.exchange(true, std::memory_order_relaxed)) return;
  if (order_) {
    for (const Index earlier : order_->before[task]) {
      take(earlier, job);
      wait_for(earlier);
    }
  }
  job.call(job.context, task, job.worker);
  state.done.store(true, std::memory_order_release);
}

void TaskRound::wait_for(std::size_t task) const {
  for (int turn = 0; !states_[task].done.load(std::memory_order_acquire); ++turn) {
    if (turn < patience)
      pause();
    else
      std::this_thread::yield();
  }
}

}  // namespace suture
