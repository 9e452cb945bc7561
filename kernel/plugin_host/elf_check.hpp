// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace suture {

/// Why the dynamic loader must not be given this file: it trusts the tables of a library, and
/// crashes where they are damaged. Returns "" if the headers and tables are consistent: every table
/// lies in a segment that is loaded, relocations change writable memory and name existing symbols,
/// and names, hash chains and functions lie where they may. Damage to code and data is not found.
/// Reads the tables: 0.1 ms for a plugin.
std::string elf_problem(const std::filesystem::path& file);

}  // namespace suture
