// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/json_document.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "kernel/base/escape.hpp"
#include "kernel/scene/scene_error.hpp"

namespace suture {
namespace {

using Json = nlohmann::json;

constexpr std::size_t max_depth = 64;  // a scene needs 6; deeper ones exhaust the stack

/// Turns offsets that only grow into lines and columns.
class LineCounter {
 public:
  explicit LineCounter(std::string_view text) : text_(text) {}
  JsonPosition at(std::size_t offset) {
    for (; scanned_ < std::min(offset, text_.size()); ++scanned_) {
      if (text_[scanned_] != '\n') continue;
      ++line_;
      line_start_ = scanned_ + 1;
    }
    return {line_, static_cast<std::uint32_t>(offset - std::min(offset, line_start_) + 1), 0};
  }

 private:
  std::string_view text_;
  std::size_t scanned_ = 0, line_start_ = 0;
  std::uint32_t line_ = 1;
};

/// Follows nlohmann's parser through the text. Its events carry no positions,
/// but they come in the order of the tokens: between two of them there are only
/// blanks, comments, commas and colons.
class TokenFollower {
 public:
  explicit TokenFollower(std::string_view text) : text_(text), lines_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) end_ = 3;
  }

  /// Start of the token whose event has just come; moves behind the token.
  JsonPosition next() {
    skip_blanks();
    while (is_one_of(",:", end_)) {
      ++end_;
      skip_blanks();
    }
    const std::size_t start = end_;
    skip_token();
    return lines_.at(start);
  }

  /// Start of the token in which the parser gave up after `read` bytes, none of
  /// whose events has come.
  std::size_t fault(std::size_t read) {
    std::size_t start = std::min(end_, read == 0 ? 0 : read - 1);
    for (skip_blanks(); end_ < read; skip_blanks()) {
      start = end_;
      skip_token();
    }
    return start;
  }

 private:
  bool is_one_of(std::string_view characters, std::size_t at) const {
    return at < text_.size() && characters.find(text_[at]) != std::string_view::npos;
  }
  bool is_letter(std::size_t at) const {
    return at < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at])) != 0;
  }
  void skip_token() {
    if (text_.substr(end_, 2) == "/*") {
      end_ = text_.size();
    } else if (is_one_of("\"", end_)) {
      skip_string();
    } else if (is_one_of("-0123456789", end_)) {
      while (is_one_of("+-.eE0123456789", end_)) ++end_;
    } else if (is_letter(end_)) {
      while (is_letter(end_)) ++end_;
    } else {
      ++end_;
    }
    end_ = std::min(end_, text_.size());
  }
  void skip_string() {
    for (++end_; end_ < text_.size() && text_[end_] != '"'; ++end_) {
      if (text_[end_] == '\\') ++end_;
    }
    ++end_;
  }
  // Blanks and comments; a comment that does not end is a fault, not a blank.
  void skip_blanks() {
    while (end_ < text_.size()) {
      if (is_one_of(" \t\r\n", end_)) {
        ++end_;
      } else if (text_.substr(end_, 2) == "//") {
        end_ = std::min(text_.find('\n', end_), text_.size());
      } else if (text_.substr(end_, 2) == "/*") {
        const std::size_t close = text_.find("*/", end_ + 2);
        if (close == std::string_view::npos) return;
        end_ = close + 2;
      } else {
        return;
      }
    }
  }

  std::string_view text_;
  LineCounter lines_;
  std::size_t end_ = 0;
};

// What to do about the usual slips, by what nlohmann says and the token it found.
std::string hint(const std::string& reason, std::string_view token) {
  const auto says = [&](std::string_view words) { return reason.find(words) != std::string::npos; };
  const auto starts = [&](std::string_view words) { return token.starts_with(words); };
  if (says("unexpected end of input")) return "; an earlier bracket or brace is not closed";
  if (says("number overflow")) return "; the largest number is about 1.8e308";
  if (starts("'")) return "; strings must be in double quotes";
  if (starts("#")) return "; comments begin with // or are enclosed in /* and */";
  if (starts("N") || starts("I") || starts("-I") || starts("nan") || starts("inf")) {
    return "; JSON has no NaN or infinity";
  }
  if (starts("}") || starts("]")) return "; is there an extra comma before it?";
  if (says("expected '}'") || says("expected ']'")) return "; is a comma missing before it?";
  return "";
}

// "[json.exception.parse_error.101] parse error at line 1, column 5: syntax
// error while parsing value - invalid literal; last read: '..'" -> the middle.
std::string reason_of(const std::string& what) {
  std::string reason = what.substr(std::min(what.size(), what.find("] ") + 2));
  if (reason.starts_with("parse error")) reason = reason.substr(reason.find(": ") + 2);
  const std::size_t last_read = reason.find("; last read: ");
  if (last_read != std::string::npos) {
    const std::size_t expected = reason.find("; expected", last_read);
    reason.erase(last_read, expected == std::string::npos ? expected : expected - last_read);
  }
  return reason;
}

/// Builds the tree of JsonValue from the events of nlohmann's parser.
class TreeBuilder final : public nlohmann::json_sax<Json> {
 public:
  TreeBuilder(std::string_view text, const std::string& name)
      : text_(text), name_(name), tokens_(text) {}

  JsonValue root;

  bool null() override {
    place(JsonValue::Kind::null);
    return true;
  }
  bool boolean(bool value) override {
    place(JsonValue::Kind::boolean).boolean = value;
    return true;
  }
  bool number_integer(number_integer_t value) override {
    place(JsonValue::Kind::number).number = static_cast<double>(value);
    return true;
  }
  bool number_unsigned(number_unsigned_t value) override {
    JsonValue& placed = place(JsonValue::Kind::number);
    placed.number = static_cast<double>(value);
    placed.natural = value;
    return true;
  }
  bool number_float(number_float_t value, const string_t&) override {
    JsonValue& placed = place(JsonValue::Kind::number);
    placed.number = value;
    // 1e6 is a whole number too; above 2^53 a double does not say which.
    if (value >= 0 && value <= 9007199254740992.0 && std::floor(value) == value) {
      placed.natural = static_cast<std::uint64_t>(value);
    }
    return true;
  }
  bool string(string_t& value) override {
    place(JsonValue::Kind::string).text = std::move(value);
    return true;
  }
  bool binary(binary_t&) override { return false; }  // does not occur in JSON text
  bool start_object(std::size_t) override { return open(JsonValue::Kind::object); }
  bool start_array(std::size_t) override { return open(JsonValue::Kind::array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    open_.back()->members.push_back({std::move(name), tokens_.next(), {}});
    return true;
  }
  bool parse_error(std::size_t read, const std::string&,
                   const nlohmann::detail::exception& error) override {
    fail(std::min(read, text_.size()), reason_of(error.what()));
  }

 private:
  JsonValue& slot() {
    if (open_.empty()) return root;
    JsonValue& parent = *open_.back();
    if (parent.kind == JsonValue::Kind::object) return parent.members.back().value;
    return parent.items.emplace_back();
  }
  JsonValue& place(JsonValue::Kind kind) {
    JsonValue& value = slot();
    value.kind = kind;
    value.at = tokens_.next();
    return value;
  }
  bool open(JsonValue::Kind kind) {
    JsonValue& value = place(kind);
    if (open_.size() == max_depth) {
      fail_at(value.at, "nested more than " + std::to_string(max_depth) + " deep");
    }
    open_.push_back(&value);
    return true;
  }
  bool close() {
    tokens_.next();
    open_.pop_back();
    return true;
  }

  [[noreturn]] void fail_at(JsonPosition at, const std::string& reason) const {
    throw SceneError(
        name_ + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " + reason,
        {{"", at.line, "", reason}});
  }
  /// `read`: bytes consumed, the token at fault included.
  [[noreturn]] void fail(std::size_t read, const std::string& reason) {
    const bool at_end = reason.find("unexpected end of input") != std::string::npos;
    const std::size_t start = at_end ? text_.size() : tokens_.fault(read);
    const std::size_t line_start = start == 0 ? 0 : text_.rfind('\n', start - 1) + 1;
    std::string_view line = text_.substr(line_start, text_.find('\n', start) - line_start);
    if (line.ends_with('\r')) line.remove_suffix(1);
    fail_at(LineCounter(text_).at(start), reason + hint(reason, text_.substr(start, 20)) +
                                              "\n    " + std::string(line.substr(0, 100)));
  }

  std::string_view text_;
  const std::string& name_;
  TokenFollower tokens_;
  std::vector<JsonValue*> open_;  // innermost last; a parent does not grow while a child is open
};

void append_canonical(const JsonValue& value, std::string& out);

void append_quoted(const std::string& text, std::string& out) { out += Json(text).dump(); }

void append_number(const JsonValue& value, std::string& out) {
  if (value.number == 0 && std::signbit(value.number)) {
    out += "-0.0";
    return;
  }
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value.number).ptr;
  out += value.natural ? std::to_string(*value.natural) : std::string(digits, end);
}

void append_object(const JsonValue& value, std::string& out) {
  std::vector<const JsonMember*> sorted;
  for (const JsonMember& member : value.members) sorted.push_back(&member);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto* a, const auto* b) { return a->key < b->key; });
  out += '{';
  for (const JsonMember* member : sorted) {
    if (out.back() != '{') out += ',';
    append_quoted(member->key, out);
    out += ':';
    append_canonical(member->value, out);
  }
  out += '}';
}

void append_array(const JsonValue& value, std::string& out) {
  out += '[';
  for (const JsonValue& item : value.items) {
    if (&item != value.items.data()) out += ',';
    append_canonical(item, out);
  }
  out += ']';
}

void append_canonical(const JsonValue& value, std::string& out) {
  switch (value.kind) {
    case JsonValue::Kind::null:
      out += "null";
      break;
    case JsonValue::Kind::boolean:
      out += value.boolean ? "true" : "false";
      break;
    case JsonValue::Kind::number:
      append_number(value, out);
      break;
    case JsonValue::Kind::string:
      append_quoted(value.text, out);
      break;
    case JsonValue::Kind::array:
      append_array(value, out);
      break;
    case JsonValue::Kind::object:
      append_object(value, out);
      break;
  }
}

}  // namespace

const JsonValue* JsonValue::find(std::string_view key) const {
  for (const JsonMember& member : members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

std::string describe(const JsonValue& value) {
  switch (value.kind) {
    case JsonValue::Kind::null:
      return "null";
    case JsonValue::Kind::boolean:
      return value.boolean ? "true" : "false";
    case JsonValue::Kind::number:
      return "the number " + canonical_json(value);
    case JsonValue::Kind::string:
      return "the string " + quote(value.text);
    case JsonValue::Kind::array:
      return "an array of " + std::to_string(value.items.size());
    case JsonValue::Kind::object:
      return "an object";
  }
  return "";
}

JsonValue parse_json(std::string_view text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    const std::string reason = "the file is empty; a scene is one JSON object { ... }";
    throw SceneError(name + ":1:1: " + reason, {{"", 1, "", reason}});
  }
  TreeBuilder builder(text, name);
  Json::sax_parse(text.begin(), text.end(), &builder, Json::input_format_t::json, true, true);
  return std::move(builder.root);
}

std::string canonical_json(const JsonValue& value) {
  std::string out;
  append_canonical(value, out);
  return out;
}

}  // namespace suture
