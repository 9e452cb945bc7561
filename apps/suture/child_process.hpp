// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>

namespace suture {

/// fork(), after all that is buffered has been written. Throws IoError.
pid_t new_process();
/// Waits for the end of a child; returns its status, as of waitpid().
int status_at_end(pid_t child);

/// How a function ended that ran in a process of its own.
struct ChildResult {
  enum class End { returned, exited, killed, timed_out } end = End::returned;
  int code = 0;         ///< of an exit, or the signal
  std::string output;   ///< what the function returned
  std::string message;  ///< what the process wrote to standard error
};

/// Runs `work` in a child process of its own and returns what it returns. Whatever the child does,
/// such as crash, exit, run out of memory or never return, does not affect this process. A child
/// that takes longer than `seconds` is killed. An exception of `work` ends it with its text as the
/// message; one of kernel/base/error.hpp with its exit code. Call it while the program has one
/// thread only. Throws IoError if no process can be made.
ChildResult run_in_child(const std::function<std::string()>& work, double seconds);

}  // namespace suture
