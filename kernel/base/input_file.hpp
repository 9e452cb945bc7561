// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace suture {

/// A regular file that is opened for reading. Nothing else is opened: reading a FIFO would block,
/// and a device may have no end.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Why the file cannot be read, as the end of a sentence: "is a device, not a regular file";
  /// empty if it can.
  const std::string& problem() const { return problem_; }
  bool is_missing() const;
  bool is_folder() const { return is_folder_; }

  std::uint64_t size() const { return size_; }
  void seek(std::uint64_t offset);
  /// Reads at most `bytes`, up to the end of the file; returns their number. Throws IoError.
  std::size_t read(std::span<char> bytes);
  /// The rest of the file.
  std::string read_all();
  /// The whole file as UTF-8 text, without a byte order mark at its start. Throws InputError for
  /// text in UTF-16. Every text file is opened by this function.
  std::string read_text();

 private:
  void refuse(int error);

  std::filesystem::path path_;
  std::string problem_;
  int error_ = 0;  ///< the system's error number
  bool is_folder_ = false;
  std::uint64_t size_ = 0;
  int fd_ = -1;
};

/// The length of a UTF-8 byte order mark at the start of `text`: 3, or 0 without a mark.
std::size_t byte_order_mark(std::string_view text);

}  // namespace suture
