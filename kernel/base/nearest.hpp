// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace suture {

/// The candidate with the smallest edit distance (insert, delete, replace,
/// transpose) to `word`, if at most a third of the word (and 3) differs; else "".
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// " (did you mean 'E'?)" or "".
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

}  // namespace suture
