// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace suture::testing {

/// What the program wrote to standard error in one test, compared with the section of that test in
/// messages.txt. The file shows all messages about mistakes together, so that a change of one is
/// seen in review. To write it after a change:
///   SUTURE_MESSAGES=write build/tests/test_apps --gtest_filter='Bad*:FailedRuns*:Mistakes*'
class Messages {
 public:
  /// Adds the lines that are new, with paths under `folder` and the build folder made relative and
  /// fractions and long numbers replaced by '#', since their last digits depend on the instruction
  /// set.
  void add(std::string text, const std::filesystem::path& folder);
  /// Fails the present test if its section differs. Does nothing for tests of other suites. Under a
  /// sanitizer, which handles crashes itself, the section may have more lines. The element that is
  /// found unstable is compared in release builds only.
  void compare() const;

 private:
  std::vector<std::string> lines_;
};

}  // namespace suture::testing
