// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cctype>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace suture {

/// More entries than any table has: a larger count means a damaged struct.
inline constexpr std::uint32_t max_entries = 4096;

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

  std::size_t count() const { return problems_.size(); }  ///< of the whole list

  bool require(bool holds, const std::string& otherwise) const {
    if (!holds) problems_.push_back((name_.empty() ? "" : name_ + ": ") + otherwise);
    return holds;
  }

  void text(const char* value, const char* member) const {
    require(value != nullptr, std::string(member) + " is NULL");
  }

  /// Checks that an array member and its count are consistent.
  bool array(const void* pointer, std::uint32_t count, const char* member) const {
    return require(count <= max_entries, std::string("the count of ") + member + " is " +
                                             std::to_string(count) + ", at most " +
                                             std::to_string(max_entries)) &&
           require(count == 0 || pointer != nullptr,
                   std::string(member) + " is NULL, but its count is " + std::to_string(count));
  }

  /// Checks the size of a plugin's struct: `least` bytes to `most`, the size known to this host.
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

/// A letter or '_', followed by letters, digits and '_'.
inline bool is_name(std::string_view text) {
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) != 0) return false;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') return false;
  return true;
}

/// The names in one list of a table, each of which must be unique.
class Names {
 public:
  void check(const Entry& entry, const char* name) {
    if (!entry.require(name != nullptr && is_name(name),
                       "its name is not a letter followed by letters, digits and '_'"))
      return;
    unique(entry, name, "name");
  }
  void unique(const Entry& entry, const char* name, const char* what) {
    entry.require(seen_.insert(name).second, std::string("the ") + what + " occurs twice");
  }

 private:
  std::set<std::string> seen_;
};

/// Copies a struct of `bytes` bytes, at most sizeof(T); the remaining bytes are 0.
template <class T>
T copy_of(const char* place, std::uint32_t bytes) {
  T copy{};
  std::memcpy(&copy, place, bytes);
  copy.size = sizeof(T);
  return copy;
}

/// Copies an array of a plugin, whose entries are as far apart as the size, at least `least`, that
/// the plugin's compiler gave them. Ends before the first unusable entry. `theirs` is set to the
/// copy.
template <class T>
std::vector<T> copy_entries(const Entry& entry, const T*& theirs, std::uint32_t count,
                            std::uint32_t least, const char* kind) {
  std::vector<T> copies;
  if (!entry.array(theirs, count, (std::string(kind) + "s").c_str()) || count == 0) return copies;
  const auto size_at = [](const char* place) {
    std::uint32_t size = 0;
    std::memcpy(&size, place, sizeof size);
    return size;
  };
  const char* place = reinterpret_cast<const char*>(theirs);
  const std::uint32_t size = size_at(place);
  for (std::uint32_t i = 0; i < count; ++i, place += size) {
    const Entry inner = entry.inner(kind, nullptr, i);
    if (!inner.size(size_at(place), i == 0 ? least : size, i == 0 ? sizeof(T) : size)) break;
    copies.push_back(copy_of<T>(place, size));
  }
  theirs = copies.data();
  return copies;
}

}  // namespace suture
