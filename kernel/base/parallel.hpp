// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "kernel/base/task_order.hpp"

namespace suture {

/// The threads of one run. This is the only class that uses TBB. With one thread, nothing is
/// started and every call is a plain loop.
class Workers {
 public:
  /// At most `threads` threads at once, including the calling one; 0: one per core.
  explicit Workers(unsigned threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  unsigned threads() const { return threads_; }

  /// Calls body(i) for each i in 0 .. count-1, in any order and on any thread, and returns when all
  /// calls have returned. `body` must not throw or call this function again. A call costs some
  /// microseconds: make i a chunk of work, and let no result depend on the thread that computes it.
  /// If body takes two arguments, body(i, worker), the second is the number of the thread that runs
  /// it, 0 .. threads()-1, so that each thread can have its own scratch memory.
  template <class Body>
  void parallel_for(std::size_t count, Body&& body) const {
    run(count, nullptr, body);
  }

  /// Calls body(i) for all tasks of an order. A task runs after those that it waits for, and sees
  /// their writes.
  template <class Body>
  void in_order(const TaskOrder& order, Body&& body) const {
    run(order.before.size(), &order, body);
  }

 private:
  template <class Body>
  void run(std::size_t count, const TaskOrder* order, Body& body) const {
    auto* context = const_cast<void*>(static_cast<const void*>(&body));  // NOLINT: type erasure
    run(count, order, context, [](void* erased, std::size_t i, unsigned worker) {
      auto& call = *static_cast<Body*>(erased);
      if constexpr (std::is_invocable_v<Body&, std::size_t, unsigned>)
        call(i, worker);
      else
        call(i);
    });
  }
  void run(std::size_t count, const TaskOrder* order, void* context, TaskRound::Call call) const;

  struct Arena;
  unsigned threads_;
  std::unique_ptr<Arena> arena_;
};

/// Calls one(i) for i = 0 .. count-1, on the threads of `workers` if given.
template <class One>
void for_each_of(std::size_t count, const Workers* workers, One&& one) {
  if (workers != nullptr)
    workers->parallel_for(count, one);
  else
    for (std::size_t i = 0; i < count; ++i) one(i);
}

/// Calls visit(first, last, chunk) for chunks of 0 .. count-1, on the threads of `workers` if
/// given. Chunks have `size` entries, but for the last one.
template <class Visit>
void for_chunks(std::size_t count, std::size_t size, const Workers* workers, Visit&& visit) {
  for_each_of((count + size - 1) / size, workers, [&](std::size_t chunk) {
    visit(chunk * size, std::min(count, (chunk + 1) * size), chunk);
  });
}

}  // namespace suture
