// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace suture {

/// The position of a value or key in the text.
struct JsonPosition {
  std::uint32_t line = 0;    ///< 1-based
  std::uint32_t column = 0;  ///< 1-based, in bytes
  std::uint32_t set = 0;     ///< 0: in the file; n: in the n-th --set
};

struct JsonMember;

/// A JSON value with its position in the text. Numbers are finite.
struct JsonValue {
  enum class Kind { null, boolean, number, string, array, object };
  Kind kind = Kind::null;
  JsonPosition at;
  bool boolean = false;
  double number = 0;
  std::optional<std::uint64_t> natural;  ///< the exact number, if it is a whole number >= 0
  std::string text;                      ///< of a string
  std::vector<JsonValue> items;          ///< of an array
  std::vector<JsonMember> members;       ///< of an object, in written order, including duplicates

  /// The first member with that name, or nullptr.
  const JsonValue* find(std::string_view key) const;
};

struct JsonMember {
  std::string key;
  JsonPosition at;
  JsonValue value;
};

/// "an object", "the string 'abc'", "the number 3": for messages.
std::string describe(const JsonValue& value);

/// Reads one JSON text (RFC 8259, UTF-8, a byte order mark and comments // and /* */ allowed).
/// Throws SceneError at the first syntax error: "NAME:LINE:COLUMN: ..." with what was found, what
/// was expected and, for common mistakes, what to do. Linear in the length of the text.
JsonValue parse_json(std::string_view text, const std::string& name);

/// The canonical text of a value: the same content always gives the same text, and reading it gives
/// that content. Keys are sorted, there is no white space, and numbers have the fewest digits that
/// read back exactly.
std::string canonical_json(const JsonValue& value);

}  // namespace suture
