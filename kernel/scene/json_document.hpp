// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace suture {

/// Where a value or a key was written.
struct JsonPosition {
  std::uint32_t line = 0;    ///< 1-based
  std::uint32_t column = 0;  ///< 1-based, in bytes
  std::uint32_t set = 0;     ///< 0: in the file; n: in the n-th --set
};

struct JsonMember;

/// A JSON value that knows where it was written. Numbers are finite.
struct JsonValue {
  enum class Kind { null, boolean, number, string, array, object };
  Kind kind = Kind::null;
  JsonPosition at;
  bool boolean = false;
  double number = 0;
  std::optional<std::uint64_t> natural;  ///< the number, exactly, if it is a whole one >= 0
  std::string text;                      ///< of a string
  std::vector<JsonValue> items;          ///< of an array
  std::vector<JsonMember> members;       ///< of an object, duplicates kept, in written order

  /// The first member of that name, or nullptr.
  const JsonValue* find(std::string_view key) const;
};

struct JsonMember {
  std::string key;
  JsonPosition at;
  JsonValue value;
};

/// "an object", "the string 'abc'", "the number 3": for messages.
std::string describe(const JsonValue& value);

/// Reads one JSON text (RFC 8259, UTF-8, a byte order mark and comments
/// // and /* */ allowed). Throws InputError at the first error of syntax:
/// "NAME:LINE:COLUMN: ..." with what was found, what was expected and, for
/// the usual slips, what to do. Linear in the length of the text.
JsonValue parse_json(std::string_view text, const std::string& name);

/// The same content always gives the same text, which reads as that content: keys sorted, no
/// blanks, the shortest digits that give a number back.
std::string canonical_json(const JsonValue& value);

/// FNV-1a, 64 bits, as 16 hexadecimal digits (Fowler, Noll, Vo; RFC 9923):
/// tells scenes apart in the provenance of results; not for security.
std::string fnv1a_hex(std::string_view text);

}  // namespace suture
