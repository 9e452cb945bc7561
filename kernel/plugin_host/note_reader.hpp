// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace suture {

/// What a plugin file says about itself (suture/note.h), read without loading it.
struct PluginNote {
  std::string plugin;
  std::vector<std::string> models;
  std::string isa;  ///< "avx512", "avx2" or "base"
  std::uint32_t abi_major = 0, abi_minor = 0, lanes = 0;
  /// Why the file cannot be a plugin of this host on this processor, with what
  /// to do; empty if nothing speaks against it. The members above hold what
  /// could be read (nothing, if the file is no ELF object or has no note).
  std::string problem;
};

/// Reads the ELF64 headers and notes of `file`: some hundred bytes of it,
/// whatever its size. No byte of the file is trusted; a random, truncated or
/// foreign file gives a `problem`. Never throws for what the file holds.
PluginNote read_note(const std::filesystem::path& file);

}  // namespace suture
