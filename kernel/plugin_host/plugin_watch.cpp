// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_watch.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <mutex>
#include <vector>

#include "kernel/plugin_host/plugin_end.hpp"
#include "kernel/plugin_host/plugin_faults.hpp"

namespace suture {
namespace {

constexpr double longest_tick = 0.1, after_interruption = 0.8;
constexpr double ticks_per_limit = 40;

double limit = 0, tick = longest_tick;
std::atomic<bool> interrupted = false;

/// A batch is visited once in a scope, so its first cell says whether a call is the same.
struct Sighting {
  std::uint64_t calls = 0;
  std::uint32_t first_cell = 0;
  bool operator==(const Sighting&) const = default;
};

double seconds_of(clockid_t clock) {
  timespec time{};
  if (clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

struct WatchedThread::Record {
  PluginThread* plugin = &plugin_thread;
  pid_t id = gettid();
  clockid_t clock = 0;
  Sighting last;
  double begin = 0, now = 0;         ///< CPU time, s
  double waited = 0, unwelcome = 0;  ///< s, by looks: without CPU time, after an interruption
};

namespace {

using Record = WatchedThread::Record;

/// Never destroyed: plugins may be called until the program ends.
struct Watch {
  std::mutex mutex;
  std::vector<Record*> threads;
  bool is_running = false;
};
Watch& the_watch() {
  static auto& watch = *new Watch;
  return watch;
}

/// The same threads for signal handlers, which take no lock. Calls of more are not named.
constinit std::array<std::atomic<const PluginThread*>, 64> watched{};

void replace_watched(const PluginThread* one, const PluginThread* other) {
  for (auto& place : watched) {
    const PluginThread* expected = one;
    if (place.compare_exchange_strong(expected, other)) return;
  }
}

/// Whether the thread sleeps, and is not merely kept from running by others or by a debugger.
bool is_waiting(pid_t thread) {
  char name[64], text[512] = {};
  std::snprintf(name, sizeof name, "/proc/self/task/%d/stat", static_cast<int>(thread));
  const int file = open(name, O_RDONLY | O_CLOEXEC);
  if (file < 0) return true;
  const ssize_t size = read(file, text, sizeof text - 1);
  close(file);
  const char* after_name = size > 0 ? std::strrchr(text, ')') : nullptr;
  return after_name == nullptr || after_name[1] == 0 || after_name[2] == 'S' ||
         after_name[2] == 'D';
}

void count(Record& thread, const Sighting& seen) {
  const double cpu = seconds_of(thread.clock);
  if (seen != thread.last) {
    thread.last = seen;
    thread.begin = cpu;
    thread.waited = thread.unwelcome = 0;
  } else {
    thread.waited = cpu - thread.now < 0.01 * tick ? thread.waited + tick : 0;
    thread.unwelcome += interrupted ? tick : 0;
  }
  thread.now = cpu;
}

void require_return(const Record& thread, const PluginCall* call) {
  constexpr const char* larger = "needs a larger SUTURE_PLUGIN_TIMEOUT (seconds; 0: no limit)";
  if (thread.unwelcome >= after_interruption)
    end_program(call, "interrupted, and the plugin's call does not return",
                "look for an endless loop in the plugin, or for something that it waits for",
                exit_interrupted);
  if (limit == 0) return;
  char cure[256];
  if (thread.now - thread.begin >= limit) {
    std::snprintf(cure, sizeof cure,
                  "look for an endless loop in the plugin; a call that is merely slow %s", larger);
    end_program(call,
                "the call does not return: it has used all the processor time that one call may "
                "use (20 s, or what SUTURE_PLUGIN_TIMEOUT says)",
                cure);
  }
  if (thread.waited >= limit && is_waiting(thread.id)) {
    std::snprintf(cure, sizeof cure,
                  "look for a lock that is never released, or for input that never comes; a call "
                  "that has to wait for longer %s",
                  larger);
    end_program(call,
                "the call does not return: it waits, and has used no processor time for as long "
                "as one call may take (20 s, or what SUTURE_PLUGIN_TIMEOUT says)",
                cure);
  }
}

void look_at(Record& thread) {
  const PluginCall* call = thread.plugin->present.load(std::memory_order_acquire);
  if (call == nullptr) {
    thread.last = {};
    return;
  }
  const CallSnapshot snapshot(call);
  count(thread, {thread.plugin->calls.load(std::memory_order_relaxed), snapshot.first_cell()});
  require_return(thread, call);
}

void* watch(void*) {
  Watch& watch = the_watch();
  timespec pause{};
  pause.tv_sec = static_cast<std::time_t>(tick);
  pause.tv_nsec = static_cast<long>((tick - static_cast<double>(pause.tv_sec)) * 1e9);
  while (true) {
    nanosleep(&pause, nullptr);
    const std::lock_guard lock(watch.mutex);
    for (Record* thread : watch.threads) look_at(*thread);
  }
}

/// Without it, a plugin that does not return ends with a second signal only.
void start_watch() {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&attributes, std::size_t{256} << 10);
  pthread_t thread{};
  pthread_create(&thread, &attributes, &watch, nullptr);
  pthread_attr_destroy(&attributes);
}

}  // namespace

void limit_plugin_calls(double seconds) {
  limit = seconds;
  tick = seconds > 0 ? std::clamp(seconds / ticks_per_limit, 1e-3, longest_tick) : longest_tick;
}

WatchedThread::WatchedThread() : record_(new Record) {
  pthread_getcpuclockid(pthread_self(), &record_->clock);
  Watch& watch = the_watch();
  const std::lock_guard lock(watch.mutex);
  watch.threads.push_back(record_);
  replace_watched(nullptr, record_->plugin);
  if (!std::exchange(watch.is_running, true)) start_watch();
}

WatchedThread::~WatchedThread() {
  {
    Watch& watch = the_watch();
    const std::lock_guard lock(watch.mutex);
    std::erase(watch.threads, record_);
    replace_watched(record_->plugin, nullptr);
  }
  delete record_;
}

void interrupt_plugin_calls() { interrupted = true; }

const PluginCall* call_in_progress() {
  if (present_call() != nullptr) return present_call();
  for (const auto& place : watched)
    if (const PluginThread* thread = place; thread != nullptr)
      if (const PluginCall* call = thread->present) return call;
  return nullptr;
}

}  // namespace suture
