// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/child_process.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

using Clock = std::chrono::steady_clock;

/// Both ends of a pipe.
class Pipe {
 public:
  Pipe() {
    if (pipe(ends_) != 0)
      throw IoError(std::string("no pipe to another process: ") + std::strerror(errno));
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int reading() const { return ends_[0]; }
  int writing() const { return ends_[1]; }
  void close_end(int which) {
    if (ends_[which] >= 0) close(ends_[which]);
    ends_[which] = -1;
  }
  /// Appends what is there; false at the end.
  bool read_some(std::string& text) const {
    char bytes[4096];
    const ssize_t count = read(ends_[0], bytes, sizeof bytes);
    if (count > 0) text.append(bytes, static_cast<std::size_t>(count));
    return count > 0 || (count < 0 && errno == EINTR);
  }

 private:
  int ends_[2] = {-1, -1};
};

void write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(descriptor, text.data(), text.size());
    if (written <= 0) return;  // the parent has gone
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

[[noreturn]] void be_child(const std::function<std::string()>& work, Pipe& output, Pipe& message) {
  dup2(message.writing(), STDERR_FILENO);
  dup2(message.writing(), STDOUT_FILENO);  // of plugins that print
  try {
    write_all(output.writing(), work());
  } catch (const Error& error) {
    write_all(STDERR_FILENO, error.what());
    _exit(error.exit_code());
  } catch (const std::exception& error) {
    write_all(STDERR_FILENO, error.what());
    _exit(1);
  }
  std::fflush(nullptr);
  _exit(0);
}

/// Reads until the child has closed both pipes; false if that takes too long.
bool collect(Pipe& output, Pipe& message, Clock::time_point deadline, ChildResult& result) {
  bool open[2] = {true, true};
  while (open[0] || open[1]) {
    pollfd watched[2] = {{open[0] ? output.reading() : -1, POLLIN, 0},
                         {open[1] ? message.reading() : -1, POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    const int ready = poll(watched, 2, static_cast<int>(std::max<long>(left.count(), 0)));
    if (ready == 0) return false;
    if (watched[0].revents != 0) open[0] = output.read_some(result.output);
    if (watched[1].revents != 0) open[1] = message.read_some(result.message);
  }
  return true;
}

void wait_for(pid_t child, ChildResult& result) {
  using enum ChildResult::End;
  const int status = status_at_end(child);
  if (result.end == timed_out) return;
  result.end = WIFSIGNALED(status) ? killed : WEXITSTATUS(status) != 0 ? exited : returned;
  result.code = WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

pid_t new_process() {
  std::fflush(nullptr);  // or both processes would write it
  const pid_t child = fork();
  if (child < 0) throw IoError(std::string("no new process: ") + std::strerror(errno));
  return child;
}

int status_at_end(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

ChildResult run_in_child(const std::function<std::string()>& work, double seconds) {
  Pipe output, message;
  const pid_t child = new_process();
  if (child == 0) be_child(work, output, message);
  output.close_end(1);
  message.close_end(1);
  ChildResult result;
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(seconds));
  if (!collect(output, message, deadline, result)) {
    result.end = ChildResult::End::timed_out;
    kill(child, SIGKILL);
  }
  wait_for(child, result);
  return result;
}

}  // namespace suture
