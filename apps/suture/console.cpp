// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/console.hpp"

#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "kernel/base/escape.hpp"

namespace suture {
namespace {

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

// Whatever is displayed may quote a file: all of it goes through here.
void put(std::FILE* stream, const std::string& text) {
  std::fputs(escaped_lines(text).c_str(), stream);
}

}  // namespace

Console::Console(bool quiet, bool verbose)
    : quiet_(quiet), verbose_(verbose), terminal_(isatty(STDERR_FILENO) == 1) {
  diagnostics_.on_warning = [this](const std::string& text) {
    if (muted_) return;
    clear_status();
    put(stderr, "suture: warning: " + text + "\n");
  };
  diagnostics_.on_note = [this](const std::string& text) { note(text); };
}

void Console::speak_as(const std::string& name) {
  muted_ = false;
  if (!kept_error_.empty()) error(name + ": " + kept_error_);
}

void Console::print(const std::string& line) {
  if (muted_) return;
  clear_status();
  put(stdout, line + "\n");
}

void Console::note(const std::string& line) {
  if (quiet_ || muted_) return;
  clear_status();
  put(stderr, line + "\n");
}

void Console::status(const std::string& line) {
  if (quiet_ || muted_) return;
  clear_status();
  put(stderr, line + (terminal_ ? "" : "\n"));
  std::fflush(stderr);
  status_shown_ = terminal_;
}

void Console::error(const std::string& text) {
  if (muted_) {
    kept_error_ = text;
    return;
  }
  clear_status();
  std::fflush(stdout);
  put(stderr, "suture: error: " + text + "\n");
}

void Console::count_warnings() {
  clear_status();
  const std::size_t warnings = diagnostics_.warnings().size();
  if (warnings > 0 && !muted_)
    std::fprintf(stderr, "suture: %s\n", count(warnings, "warning").c_str());
}

int Console::finish() {
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    // The reason is lost if an earlier write failed.
    error(std::string("cannot write all results to standard output") +
          (errno != 0 ? std::string(": ") + std::strerror(errno) : "") +
          "; check where it is redirected to");
    return 6;
  }
  return std::ferror(stderr) != 0 ? 6 : 0;
}

void Console::clear_status() {
  if (status_shown_) std::fputs("\r\x1b[K", stderr);
  status_shown_ = false;
}

std::string count(unsigned long long n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

std::string short_number(double value) {
  if (!(std::fabs(value) >= 1000)) return format("%.3g", value);
  for (const char* unit : {"k", "M"}) {
    value /= 1000;
    // 999.5 would be shown as 1e+03.
    if (std::fabs(value) < 999.5) return format("%.3g ", value) + unit;
  }
  return format("%.3g G", value / 1000);
}

std::string duration(double seconds) {
  if (seconds < 1e-3) return format("%.3g us", seconds * 1e6);
  if (seconds < 1) return format("%.3g ms", seconds * 1000);
  if (seconds < 60) return format("%.1f s", seconds);
  const double minutes = std::floor(seconds / 60);
  if (minutes < 60)
    return format("%.0f min ", minutes) + format("%02.0f s", std::floor(seconds - 60 * minutes));
  return format("%.0f h ", std::floor(minutes / 60)) + format("%02.0f min", std::fmod(minutes, 60));
}

std::string memory(double bytes) { return short_number(bytes) + (bytes < 1000 ? " B" : "B"); }

}  // namespace suture
