// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace suture {

/// The note of a plugin file (suture/note.h), read without loading the file.
struct PluginNote {
  std::string plugin;
  std::vector<std::string> models;
  std::string isa;  ///< "avx512", "avx2" or "base"
  std::uint32_t abi_major = 0, abi_minor = 0, lanes = 0;
  /// Why the file cannot be used as a plugin by this host on this processor, and
  /// what to do; empty if it can be used. The members above hold what could be
  /// read (nothing if the file is not an ELF object or has no note).
  std::string problem;
};

/// Reads the ELF64 headers and notes of `file`: a few hundred bytes, whatever its
/// size. No byte of the file is trusted; a random, truncated or foreign file gives
/// a `problem`. Never throws because of the contents of the file.
PluginNote read_note(const std::filesystem::path& file);

}  // namespace suture
