// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "kernel/base/folder.hpp"

namespace suture {

/// Throws IoError "path: cannot be <done>: <text of errno>", with advice for a full disk, an
/// exceeded quota, a missing permission or a read-only file system.
[[noreturn]] void fail_io(const std::filesystem::path& path, const std::string& done, int error);

/// A file opened for writing, that reports every error with its name. No link is followed.
class OutputFile {
 public:
  /// Creates the file; one of that name is removed before. Throws IoError, as do all members but
  /// the destructor.
  OutputFile(const Folder& folder, const std::string& name) : OutputFile(folder, name, name) {}
  /// Opens an existing file to append to its first `kept` bytes; whatever follows them is cut off.
  OutputFile(const Folder& folder, const std::string& name, std::uint64_t kept);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// For libraries that write by themselves; stays open.
  int descriptor() const { return fd_; }
  void write(std::string_view bytes);
  /// True if the file has no name any more.
  bool was_removed() const;
  /// Returns once the written data are on disk.
  void sync();
  /// Some file systems report a full disk only here.
  void close();

 protected:
  /// Errors speak of another name.
  OutputFile(const Folder& folder, const std::string& name, const std::string& shown);

 private:
  std::filesystem::path path_;
  int fd_ = -1;
};

/// A file that is written completely or not at all: it is written under a temporary name in the
/// same folder, and removed again unless it is committed. An existing file of the final name is
/// kept until then, and a link of that name is replaced, not followed. This holds even if the
/// program ends at any point (there is no fsync: after a power failure the result depends on the
/// file system).
class AtomicFile : public OutputFile {
 public:
  /// The folder must live longer.
  AtomicFile(const Folder& folder, const std::string& name);
  ~AtomicFile();
  /// Closes the file and renames it to its final name. Throws IoError.
  void commit();

 private:
  const Folder& folder_;
  std::string name_, temporary_;
};

/// The name of an AtomicFile until it is committed.
std::string temporary_name(const std::string& name);

/// AtomicFile for text in memory.
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace suture
