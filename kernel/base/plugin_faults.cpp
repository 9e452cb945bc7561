// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/plugin_faults.hpp"

#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <string_view>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/base/plugin_call.hpp"

// glibc has the kernel's name for the member since 2.35.
#ifndef sigev_notify_thread_id
#define sigev_notify_thread_id _sigev_un._tid
#endif

namespace suture {
namespace {

constexpr int exit_plugin = 4, exit_interrupted = 130;
constexpr double ticks_per_limit = 40;

double tick_seconds = 0;  // 0: no limit
std::atomic<bool> interrupted{false};
std::terminate_handler outer_terminate = nullptr;

// -------------------------------------------------- the end of the program --

void put(const char* text) {
  std::size_t left = std::strlen(text);
  while (left > 0) {
    const ssize_t written = write(STDERR_FILENO, text, left);
    if (written <= 0) return;
    text += written;
    left -= static_cast<std::size_t>(written);
  }
}

/// Says what happened in the present call, and ends the program. Of several threads the
/// first speaks.
std::atomic<void (*)()> before_end = nullptr;

[[noreturn]] void end_program(const char* what, const char* cure, int code = exit_plugin) {
  static std::atomic<pid_t> speaker = 0;
  pid_t nobody = 0;
  if (!speaker.compare_exchange_strong(nobody, gettid())) {
    if (nobody == gettid()) _exit(code);  // the description itself has crashed
    while (true) pause();                 // another thread is about to end the program
  }
  char call[2048];
  describe(*plugin_thread.present, call, sizeof call);
  if (isatty(STDERR_FILENO) == 1) put("\r\x1b[K");  // a line of progress
  const char* const parts[] = {"suture: error: ", call, ": ", what, "; ", cure, "\n"};
  for (const char* part : parts) put(part);
  if (const auto leave = before_end.load()) leave();
  _exit(code);
}

// ----------------------------------------------------------------- crashes --

struct Crash {
  int signal;
  const char* text;
};
constexpr Crash crashes[] = {
    {SIGSEGV, "the plugin crashed (SIGSEGV: it read or wrote memory that is not its own)"},
    {SIGBUS, "the plugin crashed (SIGBUS: it read or wrote memory that is not there)"},
    {SIGFPE, "the plugin crashed (SIGFPE: an integer division by zero, or a floating-point trap)"},
    {SIGILL, "the plugin crashed (SIGILL: an instruction that this processor does not have)"},
    {SIGABRT, "the plugin aborted the program (SIGABRT)"}};
constexpr const char* crash_cure =
    "the fault is in the plugin: find the place with `gdb --args suture ...`, or let "
    "`suture run --check-plugins` look for writes outside its arrays";
constexpr const char* overflow =
    "the plugin's stack overflowed (endless recursion, or arrays that are too large for it)";
constexpr const char* overflow_cure =
    "end the recursion, or keep large arrays in the memory that prepare fills";

std::uintptr_t stack_pointer(const void* context) {
  const auto& machine = static_cast<const ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
  return static_cast<std::uintptr_t>(machine.gregs[REG_RSP]);
#elif defined(__aarch64__)
  return machine.sp;
#else
#error "name the stack pointer of this architecture here"
#endif
}

bool is_overflow(const siginfo_t* info, const void* context) {
  if (info->si_signo != SIGSEGV || info->si_code <= 0) return false;
  const auto at = reinterpret_cast<std::uintptr_t>(info->si_addr);
  const std::uintptr_t top = stack_pointer(context);
  constexpr std::uintptr_t near = std::uintptr_t{1} << 16;
  return at < top + near && top < at + near;
}

void on_crash(int number, siginfo_t* info, void* context) {
  if (plugin_thread.present == nullptr) {
    std::signal(number, SIG_DFL);
    raise(number);  // comes when this handler returns
    return;
  }
  const char* text = "";
  for (const Crash& crash : crashes)
    if (crash.signal == number) text = crash.text;
  if (is_overflow(info, context)) end_program(overflow, overflow_cure);
  end_program(text, crash_cure);
}

void catch_crashes() {
  struct sigaction action {};
  action.sa_sigaction = &on_crash;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (const Crash& crash : crashes) {
    struct sigaction old {};
    sigaction(crash.signal, nullptr, &old);
    const bool is_default = (old.sa_flags & SA_SIGINFO) == 0 && old.sa_handler == SIG_DFL;
    if (is_default) sigaction(crash.signal, &action, nullptr);
  }
}

/// An exception that met `noexcept`, or was thrown while another was under way.
[[noreturn]] void on_terminate() {
  if (plugin_thread.present == nullptr || std::current_exception() == nullptr) outer_terminate();
  const std::string thrown = "the plugin threw " + text_of_exception();
  end_program(thrown.c_str(), exception_cure);
}

void on_exit() {
  if (plugin_thread.present == nullptr) return;
  end_program("the plugin called exit()",
              "a plugin must not end the program: return SUTURE_STOP with a text");
}

// ------------------------------------------------------------ endless calls --

/// A batch is visited once in a scope, so its first cell says whether a call is the same.
struct Sighting {
  std::uint64_t calls = 0;
  std::uint32_t first_cell = 0;
  bool operator==(const Sighting&) const = default;
};

Sighting look() {
  const suture_batch* batch = plugin_thread.present->batch;
  const bool has_cells = batch != nullptr && batch->valid != 0 && batch->cell_ids != nullptr;
  return {plugin_thread.calls, has_cells ? batch->cell_ids[0] : UINT32_MAX};
}

/// Every tick_seconds of the thread's processor time.
void on_tick(int) {
  thread_local constinit Sighting last;
  thread_local constinit double ticks = 0;
  if (plugin_thread.present == nullptr) return;
  const Sighting now = look();
  ticks = now == last ? ticks + 1 : 0;
  last = now;
  if (ticks >= 1 && interrupted)
    end_program("interrupted, and the plugin's call does not return",
                "look for an endless loop in the plugin", exit_interrupted);
  if (ticks >= ticks_per_limit)
    end_program(
        "the call does not return: it has used all the processor time that one call may "
        "use (20 s, or what SUTURE_PLUGIN_TIMEOUT says)",
        "look for an endless loop in the plugin; a call that is merely slow needs a "
        "larger SUTURE_PLUGIN_TIMEOUT (seconds; 0: no limit)");
}

void catch_ticks() {
  struct sigaction action {};
  action.sa_handler = &on_tick;
  action.sa_flags = static_cast<int>(SA_ONSTACK | SA_RESTART);
  // Debuggers pass SIGVTALRM on without a word; SIGPROF belongs to profilers.
  sigaction(SIGVTALRM, &action, nullptr);
}

double read_limit() {
  const char* text = std::getenv("SUTURE_PLUGIN_TIMEOUT");
  if (text == nullptr || *text == '\0') return 20;
  const std::string_view all(text);
  double seconds = -1;
  const auto [end, error] = std::from_chars(all.data(), all.data() + all.size(), seconds);
  if (error == std::errc() && end == all.data() + all.size() && seconds >= 0 &&
      std::isfinite(seconds))
    return seconds;
  throw UsageError("SUTURE_PLUGIN_TIMEOUT is '" + std::string(all) +
                   "': expected a number of seconds, or 0 for no limit");
}

// ------------------------------------------------------------------ threads --

/// A stack for handlers, which a stack overflow needs, and the timer of a thread.
class Guard {
 public:
  Guard() : stack_(std::size_t{64} << 10) {
    stack_t stack{};
    stack.ss_sp = stack_.data();
    stack.ss_size = stack_.size();
    sigaltstack(&stack, &old_);
    if (tick_seconds > 0) start_timer();
  }
  ~Guard() {
    if (has_timer_) timer_delete(timer_);
    sigaltstack(&old_, nullptr);
  }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  void start_timer() {
    sigevent event{};
    event.sigev_notify = SIGEV_THREAD_ID;
    event.sigev_signo = SIGVTALRM;
    event.sigev_notify_thread_id = static_cast<pid_t>(syscall(SYS_gettid));
    has_timer_ = timer_create(CLOCK_THREAD_CPUTIME_ID, &event, &timer_) == 0;
    if (!has_timer_) return;
    itimerspec tick{};
    tick.it_value.tv_sec = static_cast<std::time_t>(tick_seconds);
    tick.it_value.tv_nsec =
        static_cast<long>((tick_seconds - std::floor(tick_seconds)) * 999'999'999) + 1;
    tick.it_interval = tick.it_value;
    timer_settime(timer_, 0, &tick, nullptr);
  }

  std::vector<std::byte> stack_;
  stack_t old_{};
  timer_t timer_{};
  bool has_timer_ = false;
};

void enter_thread() {
  plugin_thread.guarded = true;
  thread_local Guard guard;
  (void)guard;
}

}  // namespace

void guard_plugin_calls() {
  tick_seconds = read_limit() / ticks_per_limit;
  catch_crashes();
  if (tick_seconds > 0) catch_ticks();
  outer_terminate = std::set_terminate(&on_terminate);
  std::atexit(&on_exit);
  std::at_quick_exit(&on_exit);
  enter_plugin_thread = &enter_thread;
}

void at_plugin_fault(void (*leave)()) { before_end = leave; }

void interrupt_plugin_calls() { interrupted = true; }

}  // namespace suture
