// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_end.hpp"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "kernel/base/error.hpp"
#include "kernel/plugin_host/plugin_faults.hpp"

namespace suture {
namespace {

int copies[2] = {-1, -1};  // a pipe
std::atomic<void (*)()> before_end = nullptr;

/// Copies memory that may not be readable: the kernel, which reads it for a pipe, says so.
bool copy(const void* from, void* to, std::size_t size) {
  const long written = syscall(SYS_write, copies[1], from, size);
  if (written <= 0) return false;
  return read(copies[0], to, static_cast<std::size_t>(written)) == static_cast<ssize_t>(size);
}

void put(const char* text) {
  std::size_t left = std::strlen(text);
  while (left > 0) {
    const ssize_t written = write(STDERR_FILENO, text, left);
    if (written <= 0) return;
    text += written;
    left -= static_cast<std::size_t>(written);
  }
}

}  // namespace

void prepare_snapshots() {
  if (pipe2(copies, O_CLOEXEC) != 0)
    throw IoError(std::string("no pipe can be made: ") + std::strerror(errno));
}

CallSnapshot::CallSnapshot(const PluginCall* call) {
  if (copy(call, &call_, sizeof call_)) copy_batch();
}

void CallSnapshot::copy_batch() {
  const suture_batch* batch = std::exchange(call_.batch, nullptr);
  if (batch == nullptr || !copy(batch, &batch_, sizeof batch_)) return;
  if (batch_.valid == 0 || batch_.valid > SUTURE_LANES || batch_.cell_ids == nullptr) return;
  if (!copy(batch_.cell_ids, ids_.data(), sizeof ids_)) return;
  batch_.cell_ids = ids_.data();
  call_.batch = &batch_;
}

void end_program(const PluginCall* call, const char* what, const char* cure, int code) {
  static std::atomic<pid_t> speaker = 0;
  pid_t nobody = 0;
  if (!speaker.compare_exchange_strong(nobody, gettid())) {
    if (nobody == gettid()) leave_process(code);  // the description itself has crashed
    while (true) pause();                         // another thread is about to end the program
  }
  const CallSnapshot snapshot(call);
  char text[2048];
  describe(snapshot.call(), text, sizeof text);
  if (isatty(STDERR_FILENO) == 1) put("\r\x1b[K");  // a line of progress
  const char* const parts[] = {"suture: error: ", text, ": ", what, "; ", cure, "\n"};
  for (const char* part : parts) put(part);
  if (const auto leave = before_end.load()) leave();
  leave_process(code);
}

void at_plugin_fault(void (*leave)()) { before_end = leave; }

void leave_process(int code) {
  while (true) syscall(SYS_exit_group, code);
}

}  // namespace suture
