// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace suture {

/// The text of an option has no valid value. The message begins with the option.
class BadValue : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

// These read the texts of options; all throw BadValue.

/// A whole number from `least` to `most`; `meaning` explains the smallest one in the message.
unsigned whole_number(const std::string& option, const std::string& text, unsigned least,
                      unsigned most, const std::string& meaning = "");
/// The value of --threads, as text.
std::string thread_count(const std::string& text);
/// The value of --at: false for rest.
bool is_equilibrium(const std::string& text);
/// NAME=VALUE of a parameter.
std::pair<std::string, std::string> named_value(const std::string& text);
/// N=NAME of a label.
std::pair<std::int64_t, std::string> named_label(const std::string& text);

/// Why a text is not a finite number > 0, or >= 0; "" if it is one.
std::string why_no_number(const std::string& text, bool positive);

}  // namespace suture
