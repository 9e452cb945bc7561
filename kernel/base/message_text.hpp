// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

/// Parts that many messages have.
namespace suture {

/// "t = 0.5 s"
std::string time_text(double time);
/// "t = 0.5 s: TEXT"; the text alone if it begins with a time.
std::string timed(double time, const std::string& text);
/// "1 step", "2 steps"
std::string count_text(std::uint64_t number, const char* one);

}  // namespace suture
