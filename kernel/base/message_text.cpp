// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/message_text.hpp"

#include <array>
#include <charconv>

namespace suture {

std::string time_text(double time) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), time,
                                 std::chars_format::general, 6)
                       .ptr;
  return "t = " + std::string(digits.data(), end) + " s";
}

std::string timed(double time, const std::string& text) {
  return text.starts_with("t = ") ? text : time_text(time) + ": " + text;
}

std::string count_text(std::uint64_t number, const char* one) {
  return std::to_string(number) + ' ' + one + (number == 1 ? "" : "s");
}

}  // namespace suture
