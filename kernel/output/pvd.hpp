// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace suture {

/// The list of a run's frames with their times, ParaView's `.pvd`. Written anew
/// and renamed with each frame, so that there is a valid file at any time.
class PvdFile {
 public:
  explicit PvdFile(std::filesystem::path path) : path_(std::move(path)) {}

  /// Appends a frame and replaces the file. Throws IoError.
  void add(double time, const std::string& file);

  /// The files that the collection under this path names; none if there is none.
  static std::vector<std::string> files_of(const std::filesystem::path& path);

 private:
  std::filesystem::path path_;
  std::string entries_;
};

}  // namespace suture
