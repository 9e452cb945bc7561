// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_faults.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/plugin_host/guarded_array.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/plugin_host/plugin_end.hpp"
#include "kernel/plugin_host/plugin_watch.hpp"

extern "C" void* __libc_stack_end;  // NOLINT: glibc's name of the main thread's first frame

namespace suture {
namespace {

std::terminate_handler outer_terminate = nullptr;
pid_t own_process = 0;

using Address = std::uintptr_t;

/// The memory for the stack of a thread; empty if it is not known.
struct StackRange {
  Address begin = 0, end = 0;
};
constinit thread_local StackRange stack_of_thread;

/// pthread_getattr_np would read /proc/self/maps for the main thread, which takes longer than a
/// small scene.
StackRange find_stack() {
  if (gettid() == getpid()) {
    rlimit size{};
    const auto end = reinterpret_cast<Address>(__libc_stack_end);
    if (getrlimit(RLIMIT_STACK, &size) != 0 || size.rlim_cur >= end) return {};
    return {end - size.rlim_cur, end};
  }
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return {};
  void* begin = nullptr;
  std::size_t size = 0;
  pthread_attr_getstack(&attributes, &begin, &size);
  pthread_attr_destroy(&attributes);
  return {reinterpret_cast<Address>(begin), reinterpret_cast<Address>(begin) + size};
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

struct Machine {
  Address stack_pointer;
  const char* access;  ///< "wrote"
};

Machine machine_of(const void* context) {
  const auto& state = static_cast<const ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
  const bool is_write = (state.gregs[REG_ERR] & 2) != 0;
  return {static_cast<Address>(state.gregs[REG_RSP]), is_write ? "wrote" : "read"};
#elif defined(__aarch64__)
  return {state.sp, "read or wrote"};
#else
#error "name the stack pointer of this architecture here"
#endif
}

/// Whether both lie in the last quarter of the stack, at most 1 MB, or below it. Writes past the
/// end of an array in the stack go to addresses above.
bool is_overflow(Address at, Address stack_pointer) {
  const auto [begin, end] = stack_of_thread;
  const Address last = begin + std::min<Address>((end - begin) / 4, Address{1} << 20);
  return begin != end && at < last && stack_pointer < last;
}

[[noreturn]] void end_outside_array(const GuardHit& hit, const char* access) {
  if (hit.distance == 0)
    end_program(present_call(),
                "the plugin crashed (SIGSEGV: the memory for results is not accessible any more)",
                "a plugin of this run has changed the protection of memory that it does not own "
                "(mprotect)");
  char what[512];
  std::snprintf(what, sizeof what, "it %s %zu %s %s of %s", access, hit.distance,
                hit.distance == 1 ? "double" : "doubles",
                hit.is_past_end ? "past the end" : "before the beginning", hit.name);
  end_program(present_call(), what, hit.advice);
}

/// A crash by a memory access whose address is known.
void end_at_address(Address at, const Machine& machine) {
  if (is_overflow(at, machine.stack_pointer)) end_program(present_call(), overflow, overflow_cure);
  const GuardHit hit = find_guarded(reinterpret_cast<const void*>(at));  // NOLINT: only compared
  if (hit.name != nullptr) end_outside_array(hit, machine.access);
  const auto [begin, end] = stack_of_thread;
  const bool is_of_stack = at >= begin && at < end + (Address{1} << 20);
  char what[256];
  std::snprintf(what, sizeof what,
                "the plugin crashed (SIGSEGV: it %s memory that is not its own, at address %#zx%s)",
                machine.access, static_cast<std::size_t>(at),
                is_of_stack ? ", in or behind the stack: probably past the end of an array" : "");
  end_program(present_call(), what, crash_cure);
}

void on_crash(int number, siginfo_t* info, void* context) {
  if (present_call() == nullptr) {
    std::signal(number, SIG_DFL);
    raise(number);  // comes when this handler returns
    return;
  }
  if (number == SIGSEGV && info->si_code > 0 && info->si_code != SI_KERNEL)
    end_at_address(reinterpret_cast<Address>(info->si_addr), machine_of(context));
  for (const Crash& crash : crashes)
    if (crash.signal == number) end_program(present_call(), crash.text, crash_cure);
}

/// A crash while a message is written ends the program at once (end_program).
void catch_crashes() {
  struct sigaction action {};
  action.sa_sigaction = &on_crash;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_ONSTACK | SA_NODEFER);
  for (const Crash& crash : crashes) {
    struct sigaction old {};
    sigaction(crash.signal, nullptr, &old);
    const bool is_default = (old.sa_flags & SA_SIGINFO) == 0 && old.sa_handler == SIG_DFL;
    if (is_default) sigaction(crash.signal, &action, nullptr);
  }
}

/// An exception that met `noexcept`, or was thrown while another was under way.
[[noreturn]] void on_terminate() {
  if (present_call() == nullptr || std::current_exception() == nullptr) outer_terminate();
  const std::string thrown = "the plugin threw " + text_of_exception();
  end_program(present_call(), thrown.c_str(), exception_cure);
}

void on_exit() {
  if (present_call() != nullptr) refuse_in_plugin("exit()");
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

/// A stack for handlers, which a stack overflow needs, and the watch on a thread.
class Guard {
 public:
  Guard() : stack_(std::size_t{64} << 10) {
    stack_of_thread = find_stack();
    stack_t stack{};
    stack.ss_sp = stack_.data();
    stack.ss_size = stack_.size();
    sigaltstack(&stack, &old_);
  }
  ~Guard() { sigaltstack(&old_, nullptr); }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  std::vector<std::byte> stack_;
  stack_t old_{};
  WatchedThread watched_;
};

void enter_thread() {
  plugin_thread.guarded = true;
  thread_local Guard guard;
  (void)guard;
}

}  // namespace

void guard_plugin_calls() {
  limit_plugin_calls(read_limit());
  own_process = getpid();
  prepare_snapshots();
  pthread_atfork(nullptr, nullptr, [] {
    if (present_call() == nullptr) own_process = getpid();  // forked by the program itself
  });
  catch_crashes();
  outer_terminate = std::set_terminate(&on_terminate);
  std::atexit(&on_exit);
  std::at_quick_exit(&on_exit);
  enter_plugin_thread = &enter_thread;
}

void refuse_in_plugin(const char* function) {
  const bool is_own_thread = plugin_thread.guarded || gettid() == own_process;
  if (own_process == 0 || (present_call() == nullptr && is_own_thread)) return;
  if (getpid() != own_process) return;
  char what[64];
  std::snprintf(what, sizeof what, "the plugin called %s", function);
  constexpr PluginCall unknown{.function = "a thread that a plugin has started"};
  end_program(present_call() != nullptr ? present_call() : &unknown, what,
              "a plugin must not end the program: return SUTURE_STOP with a text");
}

}  // namespace suture
