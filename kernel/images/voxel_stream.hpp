// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>

#include "kernel/base/input_file.hpp"

namespace suture {

/// The bytes of a file, inflated on the way where they are packed (gzip or zlib), so that no more
/// than a buffer of them is in memory.
class VoxelStream {
 public:
  /// Throws InputError for a file that is missing or cannot be read.
  explicit VoxelStream(const std::filesystem::path& path);
  ~VoxelStream();

  bool is_gzip() const { return is_gzip_; }  ///< by the first bytes of the file
  std::uint64_t file_size() const { return file_.size(); }
  void seek(std::uint64_t offset) { file_.seek(offset); }
  /// From here on, the bytes of the file are packed.
  void inflate();

  /// Reads up to the end of the data; returns the number of bytes. Throws InputError for damaged
  /// packed data.
  std::size_t read_some(std::span<char> bytes);
  /// Skips up to the end of the data; returns the number of bytes.
  std::uint64_t skip(std::uint64_t bytes);

 private:
  struct Inflater;
  std::size_t inflate_some(std::span<char> bytes);

  std::string name_;
  InputFile file_;
  bool is_gzip_ = false;
  std::unique_ptr<Inflater> inflater_;
};

}  // namespace suture
