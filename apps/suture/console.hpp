// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/diagnostics.hpp"

namespace suture {

/// What the user sees: control characters that come from files are escaped. Results go to standard
/// output; warnings, errors and progress to standard error, where a terminal shows one line that is
/// rewritten.
class Console {
 public:
  Console(bool quiet, bool verbose);
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  bool quiet() const { return quiet_; }
  bool verbose() const { return verbose_; }
  bool is_terminal() const { return terminal_; }

  /// From now on nothing is shown, but an error is kept: another process of the same run shows it.
  void mute() { muted_ = true; }
  /// Shows what is kept, and what follows; `name` stands before it.
  void speak_as(const std::string& name);

  /// Prints a result; `line` without a line feed.
  void print(const std::string& line);
  /// Reports something that happened, unless quiet.
  void note(const std::string& line);
  /// Replaces the progress line on a terminal; adds a line to a log.
  void status(const std::string& line);
  void error(const std::string& text);
  /// Prints the number of warnings, if there were any. Call it last.
  void count_warnings();
  /// Returns the exit code: results that could not be written (a full disk behind a redirection, a
  /// closed pipe) are an error.
  int finish();

  Diagnostics& diagnostics() { return diagnostics_; }

 private:
  void clear_status();

  bool quiet_, verbose_, terminal_, muted_ = false;
  std::string kept_error_;
  bool status_shown_ = false;
  Diagnostics diagnostics_;
};

/// "1 face", "2 faces".
std::string count(unsigned long long n, const std::string& what);
/// Three significant digits with a factor: "12.3 M", "4.56 k", "789".
std::string short_number(double value);
/// "12.3 us", "340 ms", "12.3 s", "4 min 05 s", "3 h 07 min".
std::string duration(double seconds);
/// "12.3 MB".
std::string memory(double bytes);

}  // namespace suture
