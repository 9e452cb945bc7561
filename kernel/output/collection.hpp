// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"

namespace suture {

/// The pieces of which a file of the list consists; none of a `.vtu`. Those of one that cannot be
/// read are none, too.
std::vector<std::string> pieces_of(const std::filesystem::path& folder, const std::string& file);

/// The list of a run's frames with their times, ParaView's `.pvd`. Its file is replaced with
/// each frame, so that a valid one exists at any time.
class Collection {
 public:
  void add(double time, const std::string& file);
  /// The content of the file.
  std::string text() const;

  /// The frames so far.
  void state(Archive& archive);
  /// Removes the frames whose files or pieces are not in the folder from the list; returns their
  /// number.
  std::size_t leave_out_missing(const std::filesystem::path& folder);
  const std::vector<std::string>& files() const { return files_; }

 private:
  std::vector<double> times_;
  std::vector<std::string> files_;
};

}  // namespace suture
