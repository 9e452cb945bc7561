// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/signals.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

#include "kernel/output/output_folder.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/plugin_host/plugin_faults.hpp"
#include "kernel/plugin_host/plugin_watch.hpp"

namespace suture {
namespace {

volatile std::sig_atomic_t caught = 0;
std::atomic<bool> started = false;
std::atomic<const OutputFolder*> opened = nullptr;
static_assert(std::atomic<const OutputFolder*>::is_always_lock_free);

void put(const char* text) {
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0)
    return;  // there is nowhere to report the failure
}

void abandon_folder() {
  if (const OutputFolder* folder = opened) folder->abandon();
}

// Only what is safe in a signal handler. Building takes minutes where a mesh is large, and has
// nothing to save.
void on_signal(int number) {
  if (started) {
    caught = number;
    interrupt_plugin_calls();
    return;
  }
  put("suture: stopped; nothing was written\n");
  if (const PluginCall* call = call_in_progress()) {
    char text[2048];
    describe(*call, text, sizeof text);
    put("suture: this call was under way: ");
    put(text);
    put("\n");
  }
  abandon_folder();
  leave_process(128 + number);
}

bool is_ignored(int number) {
  struct sigaction now {};
  return sigaction(number, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

void report_failed_writes() {
  for (const int number : {SIGPIPE, SIGXFSZ}) std::signal(number, SIG_IGN);
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (number != SIGHUP || !is_ignored(number)) sigaction(number, &action, nullptr);
}

void has_opened(const OutputFolder& folder) {
  opened = &folder;
  at_plugin_fault(&abandon_folder);
}

void has_started() {
  started = true;
  opened = nullptr;
}

int caught_signal() { return caught; }

}  // namespace suture
