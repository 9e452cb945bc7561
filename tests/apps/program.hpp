// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/apps/messages.hpp"

namespace suture::testing {

/// What the program said and how it ended.
struct Outcome {
  int code = -1;  ///< exit code; 128 + n if signal n ended it
  std::string out, err;

  bool says(const std::string& words) const { return (out + err).find(words) != std::string::npos; }
};
std::ostream& operator<<(std::ostream& stream, const Outcome& outcome);

/// The built program in a fresh working folder, which is removed in the end.
class Program : public ::testing::Test {
 public:
  Program();
  ~Program() override;
  void TearDown() override { messages_.compare(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  Outcome suture(const std::vector<std::string>& arguments) const;
  /// Starts it, waits until `file` exists (or it ends), sends the signal.
  Outcome interrupted(const std::vector<std::string>& arguments, int signal,
                      const std::filesystem::path& file) const;

  /// Starts it; finish() waits for its end. What it says goes to `name`.out and `name`.err.
  pid_t start(const std::vector<std::string>& arguments, const std::string& name = "") const;
  Outcome finish(pid_t child, const std::string& name = "") const;
  /// Until the file is there, or the program has ended.
  void wait_for(const std::filesystem::path& file, pid_t child) const;

  /// Writes a file of the working folder.
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  const std::filesystem::path& folder() const { return folder_; }

  /// The smallest sound scene (8 elements, 10 steps) with further members, as
  /// s.json; then `command` on it with `sets`.
  Outcome scene(const std::string& command, const std::string& more,
                const std::vector<std::string>& sets = {}) const;

 private:
  std::filesystem::path folder_;
  mutable Messages messages_;  ///< of all calls
};

}  // namespace suture::testing
