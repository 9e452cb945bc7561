// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace suture {

/// A folder that is kept open: files are written to it even if its path changes meanwhile. All
/// members but the destructor throw IoError.
class Folder {
 public:
  /// Opens the folder at this path, which may contain links; "" is the working folder.
  static Folder open(const std::filesystem::path& path);
  /// The same, but creates the folder and its parents if they are missing. If the path begins
  /// with `root`, no component after it may be a link.
  static Folder make(const std::filesystem::path& path, const std::filesystem::path& root);

  ~Folder();
  Folder(Folder&& other) noexcept;
  Folder& operator=(Folder&& other) noexcept;

  int descriptor() const { return fd_; }
  const std::filesystem::path& path() const { return path_; }
  /// Whether the path still leads to this folder.
  bool is_in_place() const;
  /// Removes the file with this name if there is one. Safe in a signal handler.
  void remove(const char* name) const noexcept;
  /// Returns when the names of the files in the folder are on disk. Does nothing on file systems
  /// that do not support this.
  void sync() const;
  /// Removes the folders that make() created, as far as they are empty. Safe in a signal handler.
  void unmake() const noexcept;

 private:
  Folder(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}
  void enter(const std::filesystem::path& name, bool follows);

  std::filesystem::path path_;
  int fd_ = -1;
  std::vector<std::filesystem::path> made_;  ///< outermost first
};

/// Whether both paths lead to the same folder; "" is the working folder.
bool same_folder(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace suture
