// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>

// ThreadSanitizer does not see the hand-over inside libtbb (Debian's is not
// instrumented) and would report every write before a loop against the reads in
// it. So this file alone is compiled without it (CMakeLists.txt), and says what
// TBB guarantees, no more: what was written before the loop is seen by each
// body, what a body wrote is seen after the loop. Two bodies stay unordered, so
// a race between them is reported (tests/house/planted_race.cpp).
#ifdef SUTURE_TSAN
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
static void acquire(void* address) { __tsan_acquire(address); }
static void release(void* address) { __tsan_release(address); }
#else
static void acquire(void*) {}
static void release(void*) {}
#endif

namespace suture {

struct Workers::Arena {
  // Without the limit TBB warns of more threads than cores, and ignores the wish.
  explicit Arena(unsigned threads)
      : limit(tbb::global_control::max_allowed_parallelism, threads),
        tbb(static_cast<int>(threads)) {}
  tbb::global_control limit;
  tbb::task_arena tbb;
};

Workers::Workers(unsigned threads)
    : threads_(threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency())) {
  if (threads_ > 1) arena_ = std::make_unique<Arena>(threads_);
}

Workers::~Workers() = default;

void Workers::run(std::size_t count, const TaskOrder* order, void* context,
                  TaskRound::Call call) const {
  if (!arena_ || count < 2) {
    for (std::size_t i = 0; i < count; ++i) call(context, i, 0);
    return;
  }
  TaskRound round(count, order, threads_);
  char fork = 0;
  char join = 0;
  arena_->tbb.execute([&] {
    release(&fork);
    tbb::parallel_for(
        0u, threads_,
        [&](unsigned) {
          acquire(&fork);
          // What a task itself gives to TBB must not bring its thread back here.
          tbb::this_task_arena::isolate([&] {
            const int worker = tbb::this_task_arena::current_thread_index();
            round.join(static_cast<unsigned>(worker), context, call);
          });
          release(&join);
        },
        tbb::simple_partitioner{});
    acquire(&join);
  });
}

}  // namespace suture
