// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace suture {

/// Throws IoError "path: cannot be <done>: <text of errno>", with advice for a full disk, an
/// exceeded quota, a missing permission or a read-only file system.
[[noreturn]] void fail_io(const std::filesystem::path& path, const std::string& done, int error);

/// A file that is written completely or not at all: it is written under a temporary name in the
/// same folder, and removed again unless it is committed. An existing file of the final name is
/// kept until then. This holds even if the program ends at any point (there is no fsync: after a
/// power failure the result depends on the file system).
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// The final name.
  const std::filesystem::path& path() const { return path_; }
  /// Gives the file its name. Throws IoError.
  void commit();

 private:
  std::filesystem::path path_, temporary_;
};

/// A file opened for writing; every error is reported with its name.
class OutputFile {
 public:
  /// Creates or truncates the file. Throws IoError, as do all members except the destructor.
  explicit OutputFile(std::filesystem::path path);
  /// The same for the temporary name; errors report the final name.
  explicit OutputFile(const AtomicFile& file);
  /// Opens an existing file, truncates it to its first `kept` bytes, and continues after them.
  OutputFile(std::filesystem::path path, std::uint64_t kept);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  /// Returns once the written data are on disk.
  void sync();
  /// Some file systems report a full disk only here.
  void close();

 private:
  std::filesystem::path path_;
  int fd_ = -1;
};

/// Returns once the directory entries of the folder are on disk. Does nothing on file systems
/// without this feature.
void sync_folder(const std::filesystem::path& folder);

/// AtomicFile and OutputFile combined, for text in memory.
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace suture
