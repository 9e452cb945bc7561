// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <charconv>
#include <string>
#include <string_view>

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/mesh.hpp"

// The writers behind write_mesh: each returns the whole text of a file.

namespace suture {

std::string medit_text(const Mesh& mesh, Diagnostics& diagnostics);
std::string gmsh_text(const Mesh& mesh, Diagnostics& diagnostics);
std::string vtk_legacy_text(const Mesh& mesh);

/// The numbers of points or elements in a file: those of the source if they are positive and
/// unique, otherwise 1, 2, ...
std::vector<std::uint64_t> tags_of(const std::vector<std::uint64_t>& ids, std::size_t count);

/// A text that is appended to word by word; doubles are written with the fewest digits that read
/// back exactly.
class TextWriter {
 public:
  TextWriter& operator<<(std::string_view word) {
    text_ += word;
    return *this;
  }
  TextWriter& operator<<(char c) {
    text_ += c;
    return *this;
  }
  template <class Number>
  requires std::is_arithmetic_v<Number> TextWriter& operator<<(Number value) {
    char digits[32];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    return *this;
  }
  /// Appends the bytes of a number, most significant first.
  template <class Number>
  void big_endian(Number value) {
    static_assert(std::endian::native == std::endian::little);
    const char* bytes = reinterpret_cast<const char*>(&value);
    for (std::size_t i = sizeof value; i > 0; --i) text_ += bytes[i - 1];
  }
  void reserve(std::size_t bytes) { text_.reserve(bytes); }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace suture
