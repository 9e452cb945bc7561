// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/scene/json_document.hpp"
#include "kernel/scene/mistakes.hpp"

namespace suture {

/// The allowed range of a number; the unit is used in messages only.
struct Limits {
  std::string unit{};  ///< "s"; "" or "1" if it has none
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool minimum_excluded = false;
  bool maximum_excluded = false;

  bool admits(double value) const;
  /// "must be > 0 s and <= 1 s".
  std::string requirement() const;

  static Limits any(std::string unit) { return {std::move(unit)}; }
  static Limits positive(std::string unit) {
    return {std::move(unit), 0, std::numeric_limits<double>::infinity(), true, false};
  }
  static Limits not_negative(std::string unit) { return {std::move(unit), 0}; }
};

/// Readers of single values: if the value has the wrong type or is out of range, they add a mistake
/// and return nothing.
std::optional<double> read_number(const JsonValue& value, const std::string& path,
                                  const Limits& limits, Mistakes& mistakes);
std::optional<std::uint64_t> read_natural(const JsonValue& value, const std::string& path,
                                          std::uint64_t minimum, std::uint64_t maximum,
                                          Mistakes& mistakes);
std::optional<bool> read_boolean(const JsonValue& value, const std::string& path,
                                 Mistakes& mistakes);
std::optional<std::string> read_string(const JsonValue& value, const std::string& path,
                                       Mistakes& mistakes);
/// Index into `choices`.
std::optional<std::size_t> read_choice(const JsonValue& value, const std::string& path,
                                       std::span<const std::string> choices, Mistakes& mistakes);
std::optional<Vec3> read_vector(const JsonValue& value, const std::string& path,
                                const Limits& limits, Mistakes& mistakes);
/// The items of an array; nullptr and a mistake if the value is not an array.
const std::vector<JsonValue>* read_array(const JsonValue& value, const std::string& path,
                                         const std::string& of_what, Mistakes& mistakes);

/// Reads one object of the scene key by key, and reports keys that were not read. The constructor
/// reports duplicate keys and values that are not objects; finish() reports unknown keys.
class ObjectReader {
 public:
  ObjectReader(const JsonValue& value, std::string path, Mistakes& mistakes);

  /// The value of an optional key, or nullptr. Marks the key as known.
  const JsonValue* find(const std::string& key);
  /// The same for a required key; `what` completes the message: "'mesh' is missing: the elements".
  const JsonValue* require(const std::string& key, const std::string& what);
  /// Exactly one of the keys must be present: returns its index, otherwise nothing and a mistake.
  std::optional<std::size_t> one_of(std::span<const std::string> keys);

  // Optional keys: return nothing if absent or invalid, so that the default stays.
  std::optional<double> number(const std::string& key, const Limits& limits);
  std::optional<std::uint64_t> natural(
      const std::string& key, std::uint64_t minimum = 0,
      std::uint64_t maximum = std::numeric_limits<std::uint64_t>::max());
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> string(const std::string& key);
  std::optional<std::size_t> choice(const std::string& key, std::span<const std::string> choices);
  std::optional<Vec3> vector(const std::string& key, const Limits& limits);

  void finish();

  void complain(const std::string& text) { mistakes_.add(value_.at, path_, text); }
  /// Reports the value of `key`, or the object if the key is absent.
  void complain(const std::string& key, const std::string& text);

  bool is_object() const { return value_.kind == JsonValue::Kind::object; }
  std::string path_of(const std::string& key) const { return child_path(path_, key); }
  const std::string& path() const { return path_; }
  const JsonPosition& at() const { return value_.at; }
  Mistakes& mistakes() { return mistakes_; }

 private:
  const JsonValue& value_;
  std::string path_;
  Mistakes& mistakes_;
  std::vector<std::string> known_;
};

}  // namespace suture
