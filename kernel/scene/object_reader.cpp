// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/object_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>

#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/safe_range.hpp"

namespace suture {
namespace {

std::string shortest(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string with_unit(double value, const std::string& unit) {
  return shortest(value) + (unit.empty() || unit == "1" ? "" : " " + unit);
}

std::string quoted_list(std::span<const std::string> words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + quote(word);
  return list;
}

/// What is wrong with a number that the program cannot compute with, or "".
std::string outside_safe_range(double value, const Limits& limits) {
  if (limits.unit != "m") return "";
  if (!is_safe_coordinate(value))
    return "must be at most " + with_unit(longest_length, "m") + " in magnitude";
  if (limits.minimum_excluded && limits.minimum == 0 && !is_safe_length(value))
    return "must be at least " + with_unit(shortest_length, "m");
  return "";
}

}  // namespace

bool Limits::admits(double value) const {
  if (minimum_excluded ? !(value > minimum) : !(value >= minimum)) return false;
  return maximum_excluded ? value < maximum : value <= maximum;
}

std::string Limits::requirement() const {
  std::string text;
  if (minimum > -std::numeric_limits<double>::infinity()) {
    text = (minimum_excluded ? "must be > " : "must be >= ") + with_unit(minimum, unit);
  }
  if (maximum < std::numeric_limits<double>::infinity()) {
    text += (text.empty() ? "must be " : " and ") + std::string(maximum_excluded ? "< " : "<= ");
    text += with_unit(maximum, unit);
  }
  return text;
}

std::optional<double> read_number(const JsonValue& value, const std::string& path,
                                  const Limits& limits, Mistakes& mistakes) {
  if (value.kind != JsonValue::Kind::number) {
    const std::string unit =
        limits.unit.empty() || limits.unit == "1" ? "" : " (" + limits.unit + ")";
    mistakes.add(value.at, path, "must be a number" + unit + ", is " + describe(value));
    return {};
  }
  if (!limits.admits(value.number)) {
    mistakes.add(value.at, path,
                 limits.requirement() + ", is " + with_unit(value.number, limits.unit));
    return {};
  }
  if (const std::string fault = outside_safe_range(value.number, limits); !fault.empty()) {
    mistakes.add(value.at, path, fault + ", is " + with_unit(value.number, limits.unit));
    return {};
  }
  return value.number;
}

std::optional<std::uint64_t> read_natural(const JsonValue& value, const std::string& path,
                                          std::uint64_t minimum, std::uint64_t maximum,
                                          Mistakes& mistakes) {
  if (value.natural && *value.natural >= minimum && *value.natural <= maximum) return value.natural;
  std::string text = "must be a whole number >= " + std::to_string(minimum);
  if (maximum != std::numeric_limits<std::uint64_t>::max()) {
    text += " and <= " + std::to_string(maximum);
  }
  mistakes.add(value.at, path, text + ", is " + describe(value));
  return {};
}

std::optional<bool> read_boolean(const JsonValue& value, const std::string& path,
                                 Mistakes& mistakes) {
  if (value.kind == JsonValue::Kind::boolean) return value.boolean;
  mistakes.add(value.at, path, "must be true or false, is " + describe(value));
  return {};
}

std::optional<std::string> read_string(const JsonValue& value, const std::string& path,
                                       Mistakes& mistakes) {
  if (value.kind == JsonValue::Kind::string) return value.text;
  mistakes.add(value.at, path, "must be a string, is " + describe(value));
  return {};
}

std::optional<std::size_t> read_choice(const JsonValue& value, const std::string& path,
                                       std::span<const std::string> choices, Mistakes& mistakes) {
  const auto found = std::find(choices.begin(), choices.end(), value.text);
  if (value.kind == JsonValue::Kind::string && found != choices.end()) {
    return static_cast<std::size_t>(found - choices.begin());
  }
  mistakes.add(value.at, path,
               "must be one of " + quoted_list(choices) + ", is " + describe(value) +
                   did_you_mean(value.text, choices));
  return {};
}

std::optional<Vec3> read_vector(const JsonValue& value, const std::string& path,
                                const Limits& limits, Mistakes& mistakes) {
  if (value.kind != JsonValue::Kind::array || value.items.size() != 3) {
    mistakes.add(value.at, path,
                 "must be three numbers [x, y, z]" +
                     (limits.unit.empty() || limits.unit == "1" ? "" : " in " + limits.unit) +
                     ", is " + describe(value));
    return {};
  }
  Vec3 vector;
  bool good = true;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto number = read_number(value.items[a], child_path(path, a), limits, mistakes);
    vector[a] = number.value_or(0);
    good = good && number.has_value();
  }
  return good ? std::optional(vector) : std::nullopt;
}

const std::vector<JsonValue>* read_array(const JsonValue& value, const std::string& path,
                                         const std::string& of_what, Mistakes& mistakes) {
  if (value.kind == JsonValue::Kind::array) return &value.items;
  mistakes.add(value.at, path, "must be an array of " + of_what + ", is " + describe(value));
  return nullptr;
}

ObjectReader::ObjectReader(const JsonValue& value, std::string path, Mistakes& mistakes)
    : value_(value), path_(std::move(path)), mistakes_(mistakes) {
  if (!is_object()) {
    complain("must be an object { ... }, is " + describe(value));
    return;
  }
  std::map<std::string_view, const JsonMember*> first;
  for (const JsonMember& member : value.members) {
    const auto [entry, is_new] = first.emplace(member.key, &member);
    if (is_new) continue;
    mistakes_.add(member.at, path_of(member.key),
                  "duplicate key; first given at " + mistakes_.place(entry->second->at));
  }
}

const JsonValue* ObjectReader::find(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  return value_.find(key);
}

const JsonValue* ObjectReader::require(const std::string& key, const std::string& what) {
  const JsonValue* found = find(key);
  if (found == nullptr && is_object()) complain("'" + key + "' is missing: " + what);
  return found;
}

std::optional<std::size_t> ObjectReader::one_of(std::span<const std::string> keys) {
  std::vector<std::string> present;
  std::size_t index = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (find(keys[i]) == nullptr) continue;
    present.push_back(keys[i]);
    index = i;
  }
  if (present.size() == 1) return index;
  if (is_object()) {
    complain("must have exactly one of " + quoted_list(keys) + ", has " +
             (present.empty() ? "none" : quoted_list(present)));
  }
  return {};
}

std::optional<double> ObjectReader::number(const std::string& key, const Limits& limits) {
  const JsonValue* value = find(key);
  return value ? read_number(*value, path_of(key), limits, mistakes_) : std::nullopt;
}

std::optional<std::uint64_t> ObjectReader::natural(const std::string& key, std::uint64_t minimum,
                                                   std::uint64_t maximum) {
  const JsonValue* value = find(key);
  return value ? read_natural(*value, path_of(key), minimum, maximum, mistakes_) : std::nullopt;
}

std::optional<bool> ObjectReader::boolean(const std::string& key) {
  const JsonValue* value = find(key);
  return value ? read_boolean(*value, path_of(key), mistakes_) : std::nullopt;
}

std::optional<std::string> ObjectReader::string(const std::string& key) {
  const JsonValue* value = find(key);
  return value ? read_string(*value, path_of(key), mistakes_) : std::nullopt;
}

std::optional<std::size_t> ObjectReader::choice(const std::string& key,
                                                std::span<const std::string> choices) {
  const JsonValue* value = find(key);
  return value ? read_choice(*value, path_of(key), choices, mistakes_) : std::nullopt;
}

std::optional<Vec3> ObjectReader::vector(const std::string& key, const Limits& limits) {
  const JsonValue* value = find(key);
  return value ? read_vector(*value, path_of(key), limits, mistakes_) : std::nullopt;
}

void ObjectReader::finish() {
  for (const JsonMember& member : value_.members) {
    if (std::find(known_.begin(), known_.end(), member.key) != known_.end()) continue;
    std::string text = "unknown key" + did_you_mean(member.key, known_);
    if (nearest(member.key, known_).empty()) text += "; valid keys: " + quoted_list(known_);
    mistakes_.add(member.at, path_of(member.key), text);
  }
}

void ObjectReader::complain(const std::string& key, const std::string& text) {
  const JsonValue* value = value_.find(key);
  if (value == nullptr) return complain(text);
  mistakes_.add(value->at, path_of(key), text);
}

}  // namespace suture
