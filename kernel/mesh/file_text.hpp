// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace suture {

/// A whole file in memory, with functions that report errors in it.
class FileText {
 public:
  /// Throws InputError for a file that is missing (names the nearest file in the folder), not a
  /// regular file, not readable or empty.
  explicit FileText(const std::filesystem::path& path);

  const std::string& name() const { return name_; }
  const char* begin() const { return text_.data(); }
  const char* end() const { return text_.data() + text_.size(); }
  std::string_view view() const { return text_; }

  /// Throws InputError "file:line: what". Lines are counted only here.
  [[noreturn]] void fail_at_line(const char* at, const std::string& what) const;
  /// Throws InputError "file, byte n: what".
  [[noreturn]] void fail_at_byte(const char* at, const std::string& what) const;

 private:
  std::string name_;
  std::string text_;
};

/// A word of a file in printable form, truncated to 40 characters; the same in quotes.
std::string printable(std::string_view word);
std::string in_quotes(std::string_view word);

/// "1,234,567".
std::string grouped(std::uint64_t value);
/// Throws InputError "`cells` exceed the 67,108,863 that the map can number" if they are more.
void require_numbers(double count, const std::string& cells);

/// Reads words and numbers separated by white space. Numbers are read by std::from_chars: about 10
/// ns per integer, 30 ns per double.
class TextCursor {
 public:
  enum class Comments { absent, hash };  ///< hash: from '#' to the end of the line
  explicit TextCursor(const FileText& file, Comments comments = Comments::absent)
      : file_(&file), p_(file.begin()), end_(file.end()), comments_(comments) {}

  /// A part of the file.
  TextCursor(const FileText& file, const char* begin, const char* end)
      : file_(&file), p_(begin), end_(end), comments_(Comments::absent) {}

  const char* position() const { return p_; }
  void seek(const char* p) { p_ = p; }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - p_); }

  /// Moves to the next word; false at the end of the file.
  bool skip_space() {
    while (p_ != end_) {
      if (static_cast<unsigned char>(*p_) <= ' ') {
        ++p_;
      } else if (*p_ == '#' && comments_ == Comments::hash) {
        skip_line();
      } else {
        return true;
      }
    }
    return false;
  }
  /// Moves past the next line feed and returns the rest of the line.
  std::string_view skip_line();
  /// The next word; empty at the end of the file.
  std::string_view peek_word();
  /// The next word; fails at the end of the file. `what` names it in the message.
  std::string_view word(const char* what);
  /// The next word must be `expected`.
  void expect(std::string_view expected);

  template <class Integer>
  Integer integer(const char* what) {
    if (!skip_space()) fail_end(what);
    if (*p_ == '+') ++p_;
    Integer value{};
    const auto [stop, error] = std::from_chars(p_, end_, value);
    if (error != std::errc{} || !ends_word(stop)) fail_number(what, error, "an integer");
    p_ = stop;
    return value;
  }
  /// A finite number.
  double real(const char* what) {
    if (!skip_space()) fail_end(what);
    if (*p_ == '+') ++p_;
    double value = 0;
    const auto [stop, error] = std::from_chars(p_, end_, value);
    // x - x is 0 for finite numbers only.
    if (error != std::errc{} || !ends_word(stop) || value - value != 0) {
      return unusual_real(what, stop, error, value);
    }
    p_ = stop;
    return value;
  }
  /// The same, but it need not be finite.
  double any_real(const char* what);
  /// Fails unless `count` entries of `values` words each can follow; called before memory is
  /// allocated for a count that may be wrong.
  void require_room(std::uint64_t count, std::uint64_t values, const char* what) const;

  [[noreturn]] void fail(const std::string& what) const { file_->fail_at_line(p_, what); }

 private:
  bool ends_word(const char* p) const { return p == end_ || static_cast<unsigned char>(*p) <= ' '; }
  double unusual_real(const char* what, const char* stop, std::errc error, double value);
  [[noreturn]] void fail_end(const char* what) const;
  [[noreturn]] void fail_number(const char* what, std::errc error, const char* expected);

  const FileText* file_;
  const char* p_;
  const char* end_;
  Comments comments_;
};

}  // namespace suture
