// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/file_text.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/input_file.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/types.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_missing(const fs::path& path) {
  std::vector<std::string> names;
  std::error_code ignored;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    names.push_back(entry.path().filename().string());
  }
  throw InputError(path.string() + ": no such file" +
                   did_you_mean(path.filename().string(), names));
}

std::string read_whole(const fs::path& path) {
  InputFile file(path);
  if (file.is_missing()) fail_missing(path);
  if (!file.problem().empty()) throw InputError(path.string() + ": " + file.problem());
  std::string text = file.read_text();
  if (text.empty()) throw InputError(path.string() + ": the file is empty");
  return text;
}

}  // namespace

FileText::FileText(const fs::path& path) : name_(escaped(path.string())), text_(read_whole(path)) {}

void FileText::fail_at_line(const char* at, const std::string& what) const {
  const auto line = 1 + std::count(begin(), at, '\n');
  throw InputError(name_ + ":" + std::to_string(line) + ": " + what);
}

void FileText::fail_at_byte(const char* at, const std::string& what) const {
  throw InputError(name_ + ", byte " + std::to_string(at - begin()) + ": " + what);
}

std::string printable(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, 40)) text.push_back(c >= ' ' && c < 127 ? c : '?');
  return word.size() > 40 ? text + "..." : text;
}

std::string in_quotes(std::string_view word) { return "'" + printable(word) + "'"; }

std::string grouped(std::uint64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text.push_back(',');
    text.push_back(digits[i]);
  }
  return text;
}

void require_numbers(double count, const std::string& cells) {
  if (count > max_elements)
    throw InputError(cells + " exceed the " + grouped(max_elements) + " that the map can number");
}

std::string_view TextCursor::skip_line() {
  const char* begin = p_;
  const char* stop = std::find(p_, end_, '\n');
  p_ = stop == end_ ? end_ : stop + 1;
  if (stop != begin && stop[-1] == '\r') --stop;
  return {begin, static_cast<std::size_t>(stop - begin)};
}

std::string_view TextCursor::peek_word() {
  if (!skip_space()) return {};
  const char* stop = p_;
  while (!ends_word(stop)) ++stop;
  return {p_, static_cast<std::size_t>(stop - p_)};
}

std::string_view TextCursor::word(const char* what) {
  const std::string_view found = peek_word();
  if (found.empty()) fail_end(what);
  p_ += found.size();
  return found;
}

void TextCursor::expect(std::string_view expected) {
  const std::string_view found = peek_word();
  if (found != expected) {
    fail("expected " + std::string(expected) + ", found " +
         (found.empty() ? "the end of the file" : in_quotes(found)));
  }
  p_ += found.size();
}

void TextCursor::require_room(std::uint64_t count, std::uint64_t values, const char* what) const {
  // A value takes a character and a separator at least; the last one no separator.
  const std::uint64_t room = (bytes_left() + 1) / (2 * values);
  if (count > room) {
    fail(grouped(count) + " " + what + " are declared, but the remaining " + grouped(bytes_left()) +
         " bytes hold at most " + grouped(room) + ": the file is truncated or the count is wrong");
  }
}

double TextCursor::any_real(const char* what) {
  if (!skip_space()) fail_end(what);
  if (*p_ == '+') ++p_;
  double value = 0;
  const auto [stop, error] = std::from_chars(p_, end_, value);
  if (error != std::errc{} || !ends_word(stop)) return unusual_real(what, stop, error, value);
  p_ = stop;
  return value;
}

double TextCursor::unusual_real(const char* what, const char* stop, std::errc error, double value) {
  if (error == std::errc::result_out_of_range && ends_word(stop)) {
    // Too small is 0 to every program; too large is not a number to compute with.
    value = std::strtod(std::string(p_, stop).c_str(), nullptr);
    if (std::isfinite(value)) {
      p_ = stop;
      return value;
    }
  }
  if (ends_word(stop) && stop != p_) {
    fail(std::string(what) + " is " + in_quotes(peek_word()) + ", which is not finite");
  }
  fail_number(what, error, "a number");
}

void TextCursor::fail_end(const char* what) const {
  fail(std::string("the file ends where ") + what + " is expected: it is truncated");
}

void TextCursor::fail_number(const char* what, std::errc error, const char* expected) {
  const std::string found = in_quotes(peek_word());
  if (error == std::errc::result_out_of_range) {
    fail(std::string(what) + " " + found + " is out of range");
  }
  fail(std::string("expected ") + expected + " (" + what + "), found " + found);
}

}  // namespace suture
