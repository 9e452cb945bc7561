// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/nearest.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include "kernel/base/escape.hpp"

namespace suture {
namespace {

// Optimal string alignment distance, case-insensitive. O(|a| |b|).
std::size_t distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + replace});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1])) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

/// Letters and digits only, in lower case.
std::string core_of(std::string_view word) {
  std::string core;
  for (const unsigned char c : word)
    if (std::isalnum(c) != 0) core += static_cast<char>(std::tolower(c));
  return core;
}

/// The only candidate that contains the word; otherwise "".
std::string only_longer(std::string_view word, std::span<const std::string> candidates) {
  const std::string core = core_of(word);
  std::string found;
  if (core.size() < 3) return found;
  for (const std::string& candidate : candidates) {
    if (core_of(candidate).find(core) == std::string::npos) continue;
    if (!found.empty()) return "";
    found = candidate;
  }
  return found;
}

}  // namespace

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance =
      std::min<std::size_t>(3, std::max<std::size_t>(1, word.size() / 3)) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t d = distance(word, candidate);
    if (d < best_distance) {
      best = candidate;
      best_distance = d;
    }
  }
  return best.empty() ? only_longer(word, candidates) : best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
  const std::string found = nearest(word, candidates);
  return found.empty() ? "" : " (did you mean " + quote(found) + "?)";
}

}  // namespace suture
