// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace suture {

/// Throws IoError "path: cannot be <done>: <text of errno>", with a hint for a
/// full disk, a quota, a missing permission or a read-only file system.
[[noreturn]] void fail_io(const std::filesystem::path& path, const std::string& done, int error);

/// A file that is written in full or not to: works under another name in the same
/// folder and is removed again unless it was committed. What stood under the name
/// before stays until then. Survives the end of the program at any point (there
/// is no fsync: after a power failure the file system decides).
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// The name that it will have.
  const std::filesystem::path& path() const { return path_; }
  /// Gives the file its name. Throws IoError.
  void commit();

 private:
  std::filesystem::path path_, temporary_;
};

/// A file opened for writing, that reports every error with its name.
class OutputFile {
 public:
  /// Creates or empties the file. Throws IoError, as do all members but the destructor.
  explicit OutputFile(std::filesystem::path path);
  /// The same for the temporary name; errors give the other one.
  explicit OutputFile(const AtomicFile& file);
  /// Opens a file that exists and goes on behind its first `kept` bytes; what follows is cut off.
  OutputFile(std::filesystem::path path, std::uint64_t kept);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  /// Returns when the disk has what was written.
  void sync();
  /// Some file systems report a full disk only here.
  void close();

 private:
  std::filesystem::path path_;
  int fd_ = -1;
};

/// Returns when the disk has the names of the files in it. File systems that cannot are left alone.
void sync_folder(const std::filesystem::path& folder);

/// AtomicFile + OutputFile for a text that is in memory.
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace suture
