// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/option_values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"

namespace suture {
namespace {

/// False unless all of the text is a number of this type.
template <class Number>
bool read_whole(const char* begin, const char* end, Number& number) {
  const auto [stop, error] = std::from_chars(begin, end, number);
  return error == std::errc() && stop == end;
}

}  // namespace

unsigned whole_number(const std::string& option, const std::string& text, unsigned least,
                      unsigned most, const std::string& meaning) {
  unsigned n = 0;
  if (!read_whole(text.data(), text.data() + text.size(), n) || n < least || n > most)
    throw BadValue(option + " must be a whole number from " + std::to_string(least) + meaning +
                   " to " + std::to_string(most) + ", is " + quote(text));
  return n;
}

std::string thread_count(const std::string& text) {
  return std::to_string(whole_number("--threads", text, 0, 1024, " (as many as pay)"));
}

bool is_equilibrium(const std::string& text) {
  const std::vector<std::string> states{"rest", "equilibrium"};
  if (text != states[0] && text != states[1])
    throw BadValue("--at must be rest or equilibrium, is " + quote(text) +
                   did_you_mean(text, states));
  return text == states[1];
}

std::pair<std::string, std::string> named_value(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == text.npos)
    throw BadValue("--set must be NAME=VALUE, is " + quote(text));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::pair<std::int64_t, std::string> named_label(const std::string& text) {
  const std::size_t equals = text.find('=');
  std::int64_t label = 0;
  if (!read_whole(text.data(), text.data() + std::min(equals, text.size()), label) ||
      equals == text.npos || equals + 1 == text.size())
    throw BadValue("--label must be N=NAME with a whole number, is " + quote(text));
  return {label, text.substr(equals + 1)};
}

std::string why_no_number(const std::string& text, bool positive) {
  double x = 0;
  const bool is_number = read_whole(text.data(), text.data() + text.size(), x) && std::isfinite(x);
  if (is_number && (positive ? x > 0 : x >= 0)) return "";
  return std::string("must be a number ") + (positive ? "> 0" : ">= 0") + ", is " + quote(text);
}

}  // namespace suture
