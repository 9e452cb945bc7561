// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/escape.hpp"

#include <bit>
#include <cstdint>
#include <cstdio>

namespace suture {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0: not UTF-8
};

/// The first character of a text (RFC 3629).
Character first_of(std::string_view text) {
  constexpr std::uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return {lead, 1};
  const auto bytes = static_cast<std::size_t>(std::countl_one(lead));
  if (bytes < 2 || bytes > 4 || bytes > text.size()) return {};
  std::uint32_t code = lead & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if (next >> 6 != 2) return {};
    code = code << 6 | (next & 0x3fu);
  }
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (code < smallest[bytes] || code > 0x10ffff || surrogate) return {};
  return {code, bytes};
}

bool is_control(std::uint32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

/// Line and paragraph separators, marks, embeddings, overrides and isolates.
bool changes_order(std::uint32_t code) {
  return code == 0x61c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

std::string hexadecimal(const char* pattern, std::uint32_t code) {
  char text[16];
  std::snprintf(text, sizeof text, pattern, code);
  return text;
}

std::string escaped(std::string_view text, bool one_line) {
  std::string result;
  while (!text.empty()) {
    const auto [code, bytes] = first_of(text);
    if (!one_line && (text.front() == '\n' || text.front() == '\t'))
      result += text.front();
    else if (text.front() == '\n')
      result += "\\n";
    else if (text.front() == '\t')
      result += "\\t";
    else if (bytes == 0)
      result += hexadecimal("\\x%02x", static_cast<unsigned char>(text.front()));
    else if (is_control(code))
      result += hexadecimal("\\x%02x", code);
    else if (changes_order(code))
      result += hexadecimal("\\u%04x", code);
    else
      result += text.substr(0, bytes);
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return result;
}

}  // namespace

std::string escaped(std::string_view text) { return escaped(text, true); }
std::string escaped_lines(std::string_view text) { return escaped(text, false); }
std::string quote(std::string_view name) { return "'" + escaped(name) + "'"; }

}  // namespace suture
