// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace suture {

/// A folder that is held open: what is written to it stays in it, whatever becomes of its path
/// meanwhile. All members but the destructor throw IoError.
class Folder {
 public:
  /// The folder of this path, which may lead through links; "" is the working folder.
  static Folder open(const std::filesystem::path& path);
  /// The same, made if it is missing, with its parents. No component behind `root` may be a
  /// link where the path begins with it.
  static Folder make(const std::filesystem::path& path, const std::filesystem::path& root);

  ~Folder();
  Folder(Folder&& other) noexcept;
  Folder& operator=(Folder&& other) noexcept;

  int descriptor() const { return fd_; }
  const std::filesystem::path& path() const { return path_; }
  /// The path still leads to this folder.
  bool is_in_place() const;
  /// Removes a file of this name, if there is one.
  void remove(const std::string& name) const noexcept;
  /// Returns when the disk has the names of the files in it. File systems that cannot are left
  /// alone.
  void sync() const;
  /// Removes again what make() has made, as far as it is empty. Safe in a signal handler.
  void unmake() const noexcept;

 private:
  Folder(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}
  void enter(const std::filesystem::path& name, bool follows);

  std::filesystem::path path_;
  int fd_ = -1;
  std::vector<std::filesystem::path> made_;  ///< outermost first
};

}  // namespace suture
