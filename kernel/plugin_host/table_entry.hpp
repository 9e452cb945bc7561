// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace suture {

/// More entries than any table has: a count above it is a damaged struct.
inline constexpr std::uint32_t most_entries = 4096;

/// Collects problems of one entry under its name.
class Entry {
 public:
  Entry(std::vector<std::string>& problems, std::string name)
      : problems_(problems), name_(std::move(name)) {}

  Entry inner(const std::string& kind, const char* name, std::uint32_t index) const {
    const bool named = name != nullptr && *name != '\0';
    return {problems_, (name_.empty() ? "" : name_ + ", ") + kind + " " +
                           (named ? "'" + std::string(name) + "'" : std::to_string(index))};
  }

  bool require(bool holds, const std::string& otherwise) const {
    if (!holds) problems_.push_back((name_.empty() ? "" : name_ + ": ") + otherwise);
    return holds;
  }

  void text(const char* value, const char* member) const {
    require(value != nullptr, std::string(member) + " is NULL");
  }

  /// Array member and its count belong together.
  bool array(const void* pointer, std::uint32_t count, const char* member) const {
    return require(count <= most_entries, std::string("the count of ") + member + " is " +
                                              std::to_string(count) + ", at most " +
                                              std::to_string(most_entries)) &&
           require(count == 0 || pointer != nullptr,
                   std::string(member) + " is NULL, but its count is " + std::to_string(count));
  }

  /// A struct of a plugin's: `least` bytes at least, and no more than `most` are known here.
  bool size(std::uint32_t bytes, std::uint32_t least, std::uint32_t most) const {
    const std::string range = least == most ? std::to_string(most)
                                            : std::to_string(least) + " to " + std::to_string(most);
    return require(bytes >= least && bytes <= most, "its member size is " + std::to_string(bytes) +
                                                        ", expected " + range +
                                                        " (first member of every struct: sizeof)");
  }

  void reserved(std::uint32_t value) const { require(value == 0, "reserved is not 0"); }

  void known(std::uint32_t value, std::uint32_t last, const char* member) const {
    require(value <= last, std::string(member) + " is " + std::to_string(value) +
                               ", the last known value is " + std::to_string(last));
  }

  void known_bits(std::uint32_t value, std::uint32_t known, const char* member) const {
    require((value & ~known) == 0, std::string(member) + " has unknown bits");
  }

 private:
  std::vector<std::string>& problems_;
  std::string name_;
};

}  // namespace suture
