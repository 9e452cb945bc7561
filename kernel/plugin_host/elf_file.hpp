// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <elf.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace suture {

/// Why an ELF file is refused.
struct ElfRefusal {
  std::string why;
};

/// A shared library in ELF64, read in pieces without trusting a byte of it. Members throw
/// ElfRefusal.
class ElfFile {
 public:
  /// Reads and checks all headers: the file is a shared library for this machine, the loader can
  /// map its segments, and segments and sections lie within the file, so that it is not truncated.
  /// Some kilobytes, whatever the size of the file.
  explicit ElfFile(const std::filesystem::path& file);
  ~ElfFile();
  ElfFile(const ElfFile&) = delete;
  ElfFile& operator=(const ElfFile&) = delete;

  const std::vector<Elf64_Phdr>& segments() const { return segments_; }

  template <class T>
  std::vector<T> read(std::uint64_t offset, std::uint64_t count) {
    require(offset, count, sizeof(T));
    std::vector<T> out(count);
    read_bytes(offset, out.data(), count * sizeof(T));
    return out;
  }

 private:
  bool contains(std::uint64_t offset, std::uint64_t bytes) const {
    return offset <= length_ && bytes <= length_ - offset;
  }
  void require(std::uint64_t offset, std::uint64_t count, std::uint64_t size) const;
  void read_bytes(std::uint64_t offset, void* out, std::uint64_t bytes) const;
  Elf64_Ehdr read_header();
  void read_segments(const Elf64_Ehdr& header);
  void check_sections(const Elf64_Ehdr& header);

  int descriptor_ = -1;
  std::uint64_t length_ = 0;
  std::vector<Elf64_Phdr> segments_;
};

}  // namespace suture
