// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/resume/cases.hpp"

namespace suture::test {

/// How a run is made.
struct Way {
  unsigned threads = 1;
  bool checkpoints = false;
  std::uint64_t every_steps = 0;           ///< 0: only where it is stopped
  std::optional<std::uint64_t> stop{};     ///< at so many questions whether to stop: a step each
  std::optional<std::uint64_t> give_up{};  ///< at so many questions within steps, and stop then
  std::filesystem::path resume{};          ///< a checkpoint
};

/// The result of a run.
struct Ran {
  std::string end;  ///< the whole summary, or the error
  int code = 0;     ///< that the program ends with
  bool was_stopped = false;
  std::vector<std::string> messages;       ///< and warnings, from the first step on
  std::vector<std::uint64_t> reported_at;  ///< questions before each
  std::uint64_t questions = 0, questions_within = 0, steps = 0;
  double seconds = 0;
};

/// In this process, with the output in `out`. `folder` has the case.
Ran run_here(const Case& what, const std::filesystem::path& folder,
             const std::filesystem::path& out, const Way& way);

/// The program in a folder, which the words of a launcher may start; standard output and error go
/// to .out and .err there.
class Child {
 public:
  Child(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
        const std::vector<std::string>& launcher = {});
  bool has_ended() const;
  /// After some seconds, unless it has ended before.
  void send(int signal, double after) const;
  int wait() const;  ///< exit code, or 128 + the signal that ended it

 private:
  pid_t pid_;
};

/// "" if both folders have the same files, byte by byte, checkpoints left aside.
std::string difference(const std::filesystem::path& expected, const std::filesystem::path& found);

/// The newest checkpoint of a folder, or empty.
std::filesystem::path newest_checkpoint(const std::filesystem::path& folder);

}  // namespace suture::test
