// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace suture::bench {

/// A temporary folder that is removed at the end.
class WorkingFolder {
 public:
  WorkingFolder();
  ~WorkingFolder();
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What a process took from its start to its end.
struct ProcessUse {
  double cpu = 0, wall = 0;  ///< s; cpu: user and system
  int code = 0;              ///< exit code; 128 + n if signal n ended it
};

/// Runs a program, found on the PATH unless its name contains a slash, silently in a folder.
/// Throws IoError if it cannot be started.
ProcessUse run_process(std::vector<std::string> words, const std::filesystem::path& folder);

/// The program `suture` beside this one.
std::filesystem::path suture_program();

}  // namespace suture::bench
