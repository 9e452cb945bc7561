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

/// What a number may be; the unit is for the message only.
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

/// The readers of single values: nothing, and a mistake noted, if the value is
/// of another type or out of range.
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
/// The items of an array, nullptr (and a mistake) if it is none.
const std::vector<JsonValue>* read_array(const JsonValue& value, const std::string& path,
                                         const std::string& of_what, Mistakes& mistakes);

/// Reads one object of the scene, key by key, and complains of the keys that
/// nobody asked for. Duplicate keys and values that are no objects are noted
/// when it is made; finish() notes the unknown keys.
class ObjectReader {
 public:
  ObjectReader(const JsonValue& value, std::string path, Mistakes& mistakes);

  /// The value of an optional key, or nullptr. Makes the key a known one.
  const JsonValue* find(const std::string& key);
  /// The same for a key that must be there; `what` completes the message:
  /// "'mesh' is missing: the elements".
  const JsonValue* require(const std::string& key, const std::string& what);
  /// Exactly one of the keys must be there: its index, else nothing and a mistake.
  std::optional<std::size_t> one_of(std::span<const std::string> keys);

  // Optional keys: nothing if absent or wrong; then the default stays.
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
  /// About the value of `key`, or about the object if the key is absent.
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
