// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

namespace suture::test {

/// Why a trial (of seed 1) is known to fail, or null. They are counted by themselves.
inline const char* known_limit(const std::string& name) {
  constexpr const char* soon_after_event =
      "the local bound after an event is too long there, and for 8 steps no state is kept";
  static const std::map<std::string, const char*> reasons{
      {"cut-031", soon_after_event},  {"cut-070", soon_after_event},
      {"tear-023", soon_after_event}, {"tear-027", soon_after_event},
      {"tear-029", soon_after_event}, {"tear-036", soon_after_event},
      {"tear-047", soon_after_event}, {"tear-049", soon_after_event},
      {"tear-059", soon_after_event}};
  const auto found = reasons.find(name);
  return found == reasons.end() ? nullptr : found->second;
}

}  // namespace suture::test
