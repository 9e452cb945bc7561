// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"

namespace suture {

/// The list of a run's frames with their times, ParaView's `.pvd`. Written anew
/// and renamed with each frame, so that there is a valid file at any time.
class PvdFile {
 public:
  explicit PvdFile(std::filesystem::path path) : path_(std::move(path)) {}

  /// Appends a frame and replaces the file. Throws IoError.
  void add(double time, const std::string& file);
  void write() const;

  /// The frames so far. Loading writes nothing.
  void state(Archive& archive);
  /// Leaves out the frames whose files are not there; how many those are.
  std::size_t leave_out_missing();
  const std::vector<std::string>& files() const { return files_; }

  /// The files that the collection under this path names; none if there is none.
  static std::vector<std::string> files_of(const std::filesystem::path& path);

 private:
  std::filesystem::path path_;
  std::vector<double> times_;
  std::vector<std::string> files_;
};

}  // namespace suture
