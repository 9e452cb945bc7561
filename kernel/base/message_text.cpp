// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/message_text.hpp"

#include <sstream>

namespace suture {

std::string time_text(double time) {
  std::ostringstream text;
  text << "t = " << time << " s";
  return text.str();
}

std::string timed(double time, const std::string& text) {
  return text.starts_with("t = ") ? text : time_text(time) + ": " + text;
}

std::string count_text(std::uint64_t number, const char* one) {
  return std::to_string(number) + ' ' + one + (number == 1 ? "" : "s");
}

}  // namespace suture
