// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace suture {

/// The candidate with the smallest edit distance (insert, delete, replace, transpose) to `word`, if
/// the distance is at most 3 and at most a third of the length of the word. Otherwise the only
/// candidate that contains the word ("faure" in "tm-faure"), or "".
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// " (did you mean 'E'?)" or "".
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

}  // namespace suture
