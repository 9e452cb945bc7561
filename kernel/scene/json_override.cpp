// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/json_override.hpp"

#include <string>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"

namespace suture {
namespace {

// Everything in the value stands where the --set stands.
void mark(JsonValue& value, std::uint32_t number) {
  value.at = {0, 0, number};
  for (JsonValue& item : value.items) mark(item, number);
  for (JsonMember& member : value.members) {
    member.at = value.at;
    mark(member.value, number);
  }
}

// What starts like JSON must be JSON; anything else may be a bare string.
JsonValue parse_value(const std::string& text, const std::string& option) {
  try {
    return parse_json(text, option);
  } catch (const InputError&) {
    if (!text.empty() && std::string_view("{[\"").find(text[0]) != std::string_view::npos) throw;
  }
  JsonValue value;
  value.kind = JsonValue::Kind::string;
  value.text = text;
  return value;
}

std::string unescape(std::string_view token) {
  std::string key;
  for (std::size_t i = 0; i < token.size(); ++i) {
    const bool escape = token[i] == '~' && i + 1 < token.size();
    if (escape && token[i + 1] == '0') {
      key += '~', ++i;
    } else if (escape && token[i + 1] == '1') {
      key += '/', ++i;
    } else {
      key += token[i];
    }
  }
  return key;
}

/// What is missing on the way: an array where the next step appends, else an object.
JsonValue made_for(const std::string& next_key, std::uint32_t number) {
  JsonValue made;
  made.kind = next_key == "-" ? JsonValue::Kind::array : JsonValue::Kind::object;
  made.at = {0, 0, number};
  return made;
}

JsonValue& array_child(JsonValue& array, const std::string& key, const JsonValue& missing,
                       const std::string& option) {
  if (key == "-") return array.items.emplace_back(missing);
  const bool digits =
      !key.empty() && key.size() < 10 && key.find_first_not_of("0123456789") == std::string::npos;
  const std::size_t index = digits ? std::stoul(key) : array.items.size();
  if (index < array.items.size()) return array.items[index];
  throw UsageError(option + ": the array has " + std::to_string(array.items.size()) +
                   " items, numbered from 0; there is no " + quote(key) + " ('-' appends one)");
}

JsonValue& child(JsonValue& parent, const std::string& key, const JsonValue& missing,
                 const std::string& option) {
  if (parent.kind == JsonValue::Kind::array) return array_child(parent, key, missing, option);
  if (parent.kind != JsonValue::Kind::object) {
    throw UsageError(option + ": " + quote(key) + " would be inside " + describe(parent) +
                     ", which is neither an object nor an array");
  }
  // If keys are repeated (the reader refuses them), the first is set.
  for (JsonMember& member : parent.members) {
    if (member.key == key) return member.value;
  }
  return parent.members.emplace_back(JsonMember{key, missing.at, missing}).value;
}

}  // namespace

void apply_override(JsonValue& root, const std::string& text, std::uint32_t number) {
  const std::string option = "--set " + quote(text);
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || text[0] != '/') {
    throw UsageError(option + ": expected /PATH/TO/KEY=VALUE, for example --set /solver/dt=1e-4");
  }
  JsonValue* target = &root;
  const std::string pointer = text.substr(0, equals);
  std::vector<std::string> keys;
  for (std::size_t start = 1; start <= pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', start), pointer.size());
    keys.push_back(unescape(pointer.substr(start, end - start)));
    start = end + 1;
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const JsonValue missing = made_for(i + 1 < keys.size() ? keys[i + 1] : "", number);
    target = &child(*target, keys[i], missing, option);
  }
  *target = parse_value(text.substr(equals + 1), option);
  mark(*target, number);
}

}  // namespace suture
