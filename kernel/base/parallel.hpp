// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include "kernel/base/task_order.hpp"

namespace suture {

/// The threads of one run: the only place that knows TBB. With one thread
/// nothing is started and every call is a plain loop.
class Workers {
 public:
  /// At most `threads` threads at once, the calling one included; 0: one per core.
  explicit Workers(unsigned threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  unsigned threads() const { return threads_; }

  /// body(i) for each i in 0 .. count-1, in any order and on any thread; returns
  /// when all are done. `body` must not throw, nor call this again. Costs some
  /// microseconds: make i a chunk of work, and let nothing that is written depend on
  /// who does it. A body(i, worker) is told which of its threads runs it,
  /// 0 .. threads()-1, so that each can have scratch memory of its own.
  template <class Body>
  void parallel_for(std::size_t count, Body&& body) const {
    run(count, nullptr, body);
  }

  /// body(i) for all tasks of an order, each after those it waits for, whose writes it sees.
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

}  // namespace suture
